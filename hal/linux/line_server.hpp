// SPDX-License-Identifier: MIT
// An instrument that tells readings in lines of text on a TCP connection (point_line.hpp,
// length_line.hpp).
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "hal/freshness.hpp"
#include "hal/linux/back_off.hpp"
#include "hal/linux/file_descriptor.hpp"
#include "hal/linux/internet_address.hpp"
#include "hal/linux/length_line.hpp"
#include "hal/linux/point_line.hpp"

namespace armsig::linux_hal {

struct LineServerConfiguration {
  std::string address = "127.0.0.1";  // at which it listens: IPv4 or IPv6, as numbers
  std::uint16_t port = 0;
  std::string client;  // who may connect, likewise; empty: everybody who can
  // How long before it arrives a reading can have been measured.
  hal::Duration age = std::chrono::milliseconds(100);
  hal::FreshnessLimits freshness{};
};

// One connection, to which it is the server. A second one is refused, unless the first has told no
// reading for as long as an instrument may be silent: a bridge whose computer lost its power must
// not keep the next one out. What is wrong with a line is told to whoever sent it. No thread: a
// reading is as old as the last call that had taken everything. Pass poll() the time of
// SteadyClock.
template <typename Line>
class LineServer final : public hal::ReadingSource<typename Line::Reading> {
 public:
  static constexpr std::size_t kLineBytes = 512;

  // Whether it can listen is told by poll(), and tried again. Precondition: canonical_address() of
  // the addresses told is not empty.
  explicit LineServer(const LineServerConfiguration& configuration);
  LineServer(const LineServer&) = delete;
  LineServer& operator=(const LineServer&) = delete;

  // At which it listens, where the configuration says 0; 0: it does not.
  [[nodiscard]] std::uint16_t port() const;

 private:
  using Reading = typename Line::Reading;

  Result<std::optional<Reading>> do_poll(hal::Instant now) override;
  [[nodiscard]] std::string_view do_words(Error error) const override;
  [[nodiscard]] std::uint32_t do_malformed() const override { return malformed_; }

  void listen(hal::Instant now);
  void accept_all(hal::Instant now);
  void take_client(FileDescriptor socket, hal::Instant now);
  [[nodiscard]] bool is_in_use(hal::Instant now) const;
  // True: everything that has arrived is taken.
  [[nodiscard]] bool receive(hal::Instant now);
  void take_bytes(std::string_view bytes, hal::Instant now);
  void end_line(hal::Instant now);
  void take_line(std::string_view line, hal::Instant now);
  void refuse_line(const LineProblem& problem);

  LineServerConfiguration configuration_;
  std::string nobody_;  // is connected, in words
  FileDescriptor listener_;
  FileDescriptor client_;
  BackOff reopen_;
  int listen_errno_ = 0;  // why it can't; 0: it does
  hal::Freshness freshness_;
  FixedVector<char, kLineBytes> line_;  // so far
  bool discarding_ = false;             // to the end of a line that was too long
  std::uint64_t lines_ = 0;             // of this client, before the one that is coming in
  std::uint32_t malformed_ = 0;         // since the start
  std::uint32_t unnumbered_ = 0;        // the number of the next reading that has none
  std::optional<Reading> newest_;       // that has not been handed out
  bool spoilt_ = false;                 // a line was refused that has not been told
  std::string malformed_words_;
  std::string reply_;
  hal::Instant drained_at_;  // everything that had arrived by then is taken
  hal::Instant read_at_;     // the last good reading, or the beginning of the connection
};

using PointServer = LineServer<PointLine>;
using LengthServer = LineServer<LengthLine>;

}  // namespace armsig::linux_hal
