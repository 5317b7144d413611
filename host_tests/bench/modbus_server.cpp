// SPDX-License-Identifier: MIT
#include "host_tests/bench/modbus_server.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>

namespace armsig::bench {
namespace {

using linux_hal::FileDescriptor;

constexpr std::uint8_t kExceptionBit = 0x80;
constexpr std::uint8_t kIllegalFunction = 1;
constexpr std::uint8_t kIllegalAddress = 2;
constexpr std::uint8_t kIllegalValue = 3;
constexpr std::size_t kMostRegisters = 125;
constexpr std::size_t kLargestFrame = 256;
// A frame ends where the line is quiet for 3.5 characters, 1.75 ms above 19200 baud; a
// pseudo-terminal has no characters' time, so a little more tells frames apart.
constexpr hal::Duration kQuiet = std::chrono::milliseconds(2);

std::uint16_t crc(const std::vector<std::uint8_t>& bytes) {
  unsigned remainder = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    remainder ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0 ? (remainder >> 1) ^ 0xA001U : remainder >> 1;
    }
  }
  return static_cast<std::uint16_t>(remainder);
}

std::uint16_t word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return static_cast<std::uint16_t>((bytes[at] << 8) | bytes[at + 1]);
}

void require(bool good, const char* what) {
  if (!good) throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

ModbusServer::ModbusServer(std::string path) : path_(std::move(path)) { plug_in(); }

ModbusServer::~ModbusServer() { unplug(); }

void ModbusServer::plug_in() {
  line_ = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  require(line_.valid() && ::grantpt(line_.get()) == 0 && ::unlockpt(line_.get()) == 0,
          "pseudo-terminal");
  std::array<char, 128> name{};
  require(::ptsname_r(line_.get(), name.data(), name.size()) == 0, "pseudo-terminal");
  other_end_ = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  require(other_end_.valid() && ::tcgetattr(other_end_.get(), &settings) == 0, name.data());
  ::cfmakeraw(&settings);
  require(::tcsetattr(other_end_.get(), TCSANOW, &settings) == 0, name.data());
  ::unlink(path_.c_str());
  require(::symlink(name.data(), path_.c_str()) == 0, path_.c_str());
}

void ModbusServer::unplug() {
  ::unlink(path_.c_str());
  other_end_.reset();
  line_.reset();
}

void ModbusServer::set_fault(LineFault fault) {
  const bool was_unplugged = fault_ == LineFault::kUnplugged;
  fault_ = fault;
  if (fault == LineFault::kUnplugged) {
    unplug();
  } else if (was_unplugged) {
    plug_in();
  }
}

void ModbusServer::serve(hal::Instant now) {
  if (!line_.valid()) return;
  std::array<std::uint8_t, kLargestFrame> buffer{};
  const ssize_t count = ::read(line_.get(), buffer.data(), buffer.size());
  if (count > 0) {
    request_.insert(request_.end(), buffer.begin(), buffer.begin() + count);
    last_byte_at_ = now;
    return;
  }
  if (request_.empty() || now - last_byte_at_ < kQuiet) return;
  const std::vector<std::uint8_t> body = answer();
  request_.clear();
  if (!body.empty() && fault_ != LineFault::kSilent) send(body);
}

// Empty where the request is for another unit or garbled: servers keep silent then.
std::vector<std::uint8_t> ModbusServer::answer() const {
  constexpr std::size_t kReadRequest = 8;  // unit, function, address, count, CRC
  // The CRC over a frame with its CRC is zero.
  if (request_.size() < 4 || request_.size() > kLargestFrame || crc(request_) != 0) return {};
  if (request_[0] != kUnit) return {};
  const std::uint8_t function = request_[1];
  const auto exception = [&](std::uint8_t code) -> std::vector<std::uint8_t> {
    return {kUnit, static_cast<std::uint8_t>(function | kExceptionBit), code};
  };
  if (function != 3 && function != 4) return exception(kIllegalFunction);
  if (fault_ == LineFault::kException) return exception(kServerDeviceFailure);
  if (request_.size() != kReadRequest) return exception(kIllegalValue);
  const std::size_t first = word(request_, 2);
  const std::size_t count = word(request_, 4);
  if (count == 0 || count > kMostRegisters) return exception(kIllegalValue);
  if (first + count > registers_.size()) return exception(kIllegalAddress);
  std::vector<std::uint8_t> body{kUnit, function, static_cast<std::uint8_t>(2 * count)};
  constexpr std::size_t kReceiverCount = 3;
  for (std::size_t i = first; i < first + count; ++i) {
    const bool fewer = fault_ == LineFault::kShort && i == kReceiverCount;
    const unsigned value = fewer ? registers_[i] - 1U : registers_[i];
    body.push_back(static_cast<std::uint8_t>(value >> 8));
    body.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  }
  return body;
}

void ModbusServer::send(std::vector<std::uint8_t> body) const {
  if (fault_ == LineFault::kWrongUnit) body[0] = kUnit + 1;
  const std::uint16_t sum = crc(body);
  body.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  body.push_back(static_cast<std::uint8_t>(sum >> 8));
  if (fault_ == LineFault::kBadCrc) body.back() ^= 1U;
  // What the line has no room for is lost, as on a wire.
  [[maybe_unused]] const ssize_t written = ::write(line_.get(), body.data(), body.size());
}

}  // namespace armsig::bench
