// SPDX-License-Identifier: MIT
// Units of Modbus RTU that share a line, by their registers. Written from the server's side of the
// standards ("MODBUS over Serial Line V1.02", "MODBUS Application Protocol V1.1b3") with a checksum
// of its own, apart from the masters under test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace armsig::test {

class RegisterServer {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Registers = std::map<std::uint16_t, std::uint16_t>;
  struct Unit {
    std::map<std::uint8_t, Registers> functions;  // 3 and 4
    std::uint8_t exception = 0;                   // with which it answers everything
    bool silent = false;
    std::uint8_t answers_as = 0;  // another unit's number; 0: its own
    bool short_of_one = false;    // a register less than were asked for
    unsigned requests = 0;        // so far
  };

  std::map<std::uint8_t, Unit> units;

  // `body` with its checksum.
  static Bytes sealed(Bytes body) {
    const std::uint16_t sum = checksum(body);
    body.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
    body.push_back(static_cast<std::uint8_t>(sum >> 8U));
    return body;
  }

  // Empty where nobody answers.
  Bytes answer(const Bytes& request) {
    if (request.size() != 8 || sealed({request.begin(), request.begin() + 6}) != request) return {};
    const auto found = units.find(request[0]);
    if (found == units.end()) return {};
    Unit& unit = found->second;
    ++unit.requests;
    if (unit.silent) return {};
    Bytes body = body_of(unit, request);
    body[0] = unit.answers_as != 0 ? unit.answers_as : request[0];
    return sealed(body);
  }

 private:
  static std::uint16_t checksum(const Bytes& bytes) {
    unsigned sum = 0xFFFFU;
    for (const unsigned byte : bytes) {
      sum ^= byte;
      for (int i = 0; i < 8; ++i) sum = (sum % 2 != 0) ? (sum / 2) ^ 0xA001U : sum / 2;
    }
    return static_cast<std::uint16_t>(sum);
  }

  static Bytes body_of(const Unit& unit, const Bytes& request) {
    const auto refuse = [&](std::uint8_t code) {
      return Bytes{0, static_cast<std::uint8_t>(request[1] | 0x80U), code};
    };
    constexpr std::uint8_t kIllegalFunction = 1;
    constexpr std::uint8_t kIllegalAddress = 2;
    if (unit.exception != 0) return refuse(unit.exception);
    const auto function = unit.functions.find(request[1]);
    if (function == unit.functions.end()) return refuse(kIllegalFunction);
    const std::size_t first = request[2] * 256U + request[3];
    const std::size_t count = request[4] * 256U + request[5] - (unit.short_of_one ? 1U : 0U);
    Bytes body{0, request[1], static_cast<std::uint8_t>(2 * count)};
    for (std::size_t i = first; i < first + count; ++i) {
      const auto value = function->second.find(static_cast<std::uint16_t>(i));
      if (value == function->second.end()) return refuse(kIllegalAddress);
      body.push_back(static_cast<std::uint8_t>(value->second / 256));
      body.push_back(static_cast<std::uint8_t>(value->second % 256));
    }
    return body;
  }
};

}  // namespace armsig::test
