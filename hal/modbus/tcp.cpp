// SPDX-License-Identifier: MIT
#include "hal/modbus/tcp.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace armsig::modbus {
namespace {

constexpr std::size_t kLeastBody = 3;  // unit, function, code
constexpr std::size_t kMostBody = kMostTcpBytes - kTcpHeaderBytes;
constexpr std::size_t kRequestBody = kTcpRequestBytes - kTcpHeaderBytes;

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>((bytes[at] << 8) | bytes[at + 1]);
}

}  // namespace

std::array<std::uint8_t, kTcpRequestBytes> encode_tcp(const ReadRequest& request,
                                                      std::uint16_t transaction) {
  ARMSIG_CHECK(request.registers.count >= 1 && request.registers.count <= kMaxRegisters);
  std::array<std::uint8_t, kTcpRequestBytes> bytes{};
  const auto put = [&](std::size_t at, std::uint16_t word) {
    bytes[at] = static_cast<std::uint8_t>(word >> 8);
    bytes[at + 1] = static_cast<std::uint8_t>(word & 0xFF);
  };
  put(0, transaction);
  put(4, kRequestBody);
  bytes[6] = request.unit;
  bytes[7] = request.function;
  put(8, request.registers.first);
  put(10, request.registers.count);
  return bytes;
}

Result<std::size_t> tcp_answer_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kTcpHeaderBytes) return std::size_t{0};
  const std::size_t body = word_at(bytes, 4);
  if (word_at(bytes, 2) != 0 || body < kLeastBody || body > kMostBody) {
    return std::unexpected(Error::kSensorMalformed);
  }
  return kTcpHeaderBytes + body;
}

std::uint16_t tcp_transaction(std::span<const std::uint8_t> answer) { return word_at(answer, 0); }

std::expected<Registers, Failure> decode_tcp(const ReadRequest& request,
                                             std::span<const std::uint8_t> answer) {
  if (answer.size() < kTcpHeaderBytes) return std::unexpected(Failure{Error::kSensorMalformed});
  return decode_body(request, answer.subspan(kTcpHeaderBytes));
}

}  // namespace armsig::modbus
