// SPDX-License-Identifier: MIT
#include "hal/modbus/rtu.hpp"

#include "core/base/check.hpp"

namespace armsig::modbus {
namespace {

constexpr std::uint8_t kExceptionBit = 0x80;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kExceptionBody = 3;  // unit, function, code
constexpr std::size_t kBodyOverhead = 3;   // unit, function, byte count

std::uint8_t high(std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); }
std::uint8_t low(std::uint16_t word) { return static_cast<std::uint8_t>(word & 0xFF); }

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1) ^ 0xA001U : crc >> 1);
    }
  }
  return crc;
}

std::array<std::uint8_t, kReadRequestBytes> encode(const ReadRequest& request) {
  ARMSIG_CHECK(request.registers.count >= 1 && request.registers.count <= kMaxRegisters);
  std::array<std::uint8_t, kReadRequestBytes> bytes{request.unit,
                                                    request.function,
                                                    high(request.registers.first),
                                                    low(request.registers.first),
                                                    high(request.registers.count),
                                                    low(request.registers.count)};
  const std::uint16_t crc = crc16(std::span(bytes).first(kReadRequestBytes - 2));
  bytes[6] = low(crc);
  bytes[7] = high(crc);
  return bytes;
}

std::size_t answer_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2) return 0;
  if ((bytes[1] & kExceptionBit) != 0) return kExceptionBody + kCrcBytes;
  if (bytes.size() < 3) return 0;
  return kBodyOverhead + bytes[2] + kCrcBytes;
}

std::expected<Registers, Failure> decode(const ReadRequest& request,
                                         std::span<const std::uint8_t> answer) {
  if (answer.size() < kExceptionBody + kCrcBytes) {
    return std::unexpected(Failure{Error::kSensorMalformed});
  }
  const std::span body = answer.first(answer.size() - kCrcBytes);
  const std::uint16_t crc = crc16(body);
  if (answer[body.size()] != low(crc) || answer[body.size() + 1] != high(crc)) {
    return std::unexpected(Failure{Error::kSensorBadCrc});
  }
  return decode_body(request, body);
}

std::expected<Registers, Failure> decode_body(const ReadRequest& request,
                                              std::span<const std::uint8_t> body) {
  const auto fail = [](Error error, std::uint8_t exception = 0) {
    return std::unexpected(Failure{error, exception});
  };
  if (body.size() < kExceptionBody) return fail(Error::kSensorMalformed);
  if (body[0] != request.unit) return fail(Error::kSensorWrongUnit);
  if (body[1] == (request.function | kExceptionBit)) {
    if (body.size() != kExceptionBody) return fail(Error::kSensorMalformed);
    return fail(Error::kSensorException, body[2]);
  }
  if (body[1] != request.function) return fail(Error::kSensorWrongUnit);
  const std::size_t data_bytes = std::size_t{2} * request.registers.count;
  if (body[2] != data_bytes || body.size() != kBodyOverhead + data_bytes) {
    return fail(Error::kSensorMalformed);
  }
  Registers registers;
  for (std::size_t i = 0; i < request.registers.count; ++i) {
    registers.push_back(static_cast<std::uint16_t>((body[3 + 2 * i] << 8) | body[4 + 2 * i]));
  }
  return registers;
}

std::string_view describe_exception(std::uint8_t code) {
  switch (code) {
    case 1:
      return "illegal function";
    case 2:
      return "illegal data address";
    case 3:
      return "illegal data value";
    case 4:
      return "server device failure";
    case 5:
      return "acknowledge, still busy with the request";
    case 6:
      return "server device busy";
    case 8:
      return "memory parity error";
    case 10:
      return "gateway path unavailable";
    case 11:
      return "gateway target device failed to respond";
    default:
      return "unknown exception";
  }
}

}  // namespace armsig::modbus
