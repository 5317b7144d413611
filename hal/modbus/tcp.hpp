// SPDX-License-Identifier: MIT
// Modbus TCP frames (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3): reading
// registers, as a client.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>

#include "hal/modbus/rtu.hpp"

namespace armsig::modbus {

// Transaction, protocol (0 is Modbus), and how many bytes follow, the unit being the first.
inline constexpr std::size_t kTcpHeaderBytes = 6;
inline constexpr std::size_t kTcpRequestBytes = 12;
inline constexpr std::size_t kMostTcpBytes = 260;  // of a frame

// `transaction` comes back with the answer. Precondition: 1 to kMaxRegisters registers.
[[nodiscard]] std::array<std::uint8_t, kTcpRequestBytes> encode_tcp(const ReadRequest& request,
                                                                    std::uint16_t transaction);

// How long a whole answer is that begins with `bytes`; 0 while that cannot be told yet.
// Errors: kSensorMalformed (no beginning of such a frame: where the next one begins is not known).
[[nodiscard]] Result<std::size_t> tcp_answer_bytes(std::span<const std::uint8_t> bytes);

// Whose answer it is. Precondition: tcp_answer_bytes() of them.
[[nodiscard]] std::uint16_t tcp_transaction(std::span<const std::uint8_t> answer);

// The registers of a complete answer. Errors: kSensorWrongUnit (also: another function),
// kSensorException, kSensorMalformed (another number of registers than asked for).
[[nodiscard]] std::expected<Registers, Failure> decode_tcp(const ReadRequest& request,
                                                           std::span<const std::uint8_t> answer);

}  // namespace armsig::modbus
