// SPDX-License-Identifier: MIT
// The emulated range sensor's serial side: a Modbus RTU server on a pseudo-terminal.
//
// Written from the standard's server side ("MODBUS over Serial Line V1.02", "MODBUS Application
// Protocol V1.1b3") with its own CRC, apart from the masters under test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/clock.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::bench {

// What is wrong with the sensor's answers, on command.
enum class LineFault : std::uint8_t {
  kNone,
  kSilent,     // no answer
  kBadCrc,     // the last bit of each answer flipped
  kWrongUnit,  // answers as another unit
  kException,  // answers every request with exception 4, server device failure
  kShort,      // one receiver fewer than there are in the count register
  kUnplugged,  // the line is gone, with its device file
};

class ModbusServer {
 public:
  static constexpr std::uint8_t kUnit = 1;
  static constexpr std::uint8_t kServerDeviceFailure = 4;

  // Makes the pseudo-terminal and a symbolic link `path` to it. Throws std::system_error.
  explicit ModbusServer(std::string path);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  // What registers 0, 1, ... read as.
  void set_registers(std::vector<std::uint16_t> registers) { registers_ = std::move(registers); }
  void set_fault(LineFault fault);

  // Takes what has arrived and answers a request that is whole. Never blocks.
  void serve(hal::Instant now);

 private:
  void plug_in();
  void unplug();
  [[nodiscard]] std::vector<std::uint8_t> answer() const;
  void send(std::vector<std::uint8_t> body) const;

  std::string path_;
  linux_hal::FileDescriptor line_;
  // Held open, or the line would hang up whenever the other side closes it.
  linux_hal::FileDescriptor other_end_;
  std::vector<std::uint16_t> registers_;
  LineFault fault_ = LineFault::kNone;
  std::vector<std::uint8_t> request_;
  hal::Instant last_byte_at_;
};

}  // namespace armsig::bench
