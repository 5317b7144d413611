// SPDX-License-Identifier: MIT
// Instrument description, instrument/1: what the tool touches or is tied to where no tracker
// measures it, and which lengths are known (docs/formats.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

inline constexpr std::string_view kInstrumentTag = "instrument/1";

enum class InstrumentKind : std::uint8_t {
  kSocket,  // a ball on the tool sits in a socket: three numbers a touch
  kPlane,   // the tool touches a plane, or a dial is read as zero: one number
  kWire,    // a draw-wire or a ball bar from an anchor to the tool: a length
};

struct Instrument {
  std::string name;
  InstrumentKind kind = InstrumentKind::kSocket;
  // Of a wire: a length read is (true - zero) / (1 + gain). 1 sigma of the gain beforehand, and the
  // zero as stated, with its sigma.
  double gain_sigma = 0;
  double zero_m = 0;
  double zero_sigma_m = 0;
};

struct KnownLength {
  std::string from, to;  // places, sockets both
  double length_m = 0;
  double sigma_m = 0;
  int line = 0;  // of the file
};

struct InstrumentDescription {
  std::string name;
  Vector3 tool_F = Vector3::Zero();  // the ball's centre or the wire's end, by the nominal flange
  std::vector<Instrument> instruments;  // one at least
  // The instrument of a place, by its index; of places not listed it is the first.
  std::map<std::string, std::size_t, std::less<>> place_instruments;
  std::vector<KnownLength> lengths;

  [[nodiscard]] std::size_t instrument_of(std::string_view place) const;
};

[[nodiscard]] Read<InstrumentDescription> read_instrument_file(const std::string& path);
[[nodiscard]] Read<InstrumentDescription> parse_instrument(std::string_view text,
                                                           std::string_view file);

}  // namespace armsig::tool
