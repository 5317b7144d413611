// SPDX-License-Identifier: MIT
#include "hal/canopen/emergency.hpp"

#include "hal/canopen/protocol.hpp"

namespace armsig::canopen {
namespace {

// A code matches the first row with (code & mask) == pattern: single codes first, then classes
// (CiA 301, table of emergency error codes; CiA 402-2, annex of error codes).
struct Row {
  std::uint16_t mask;
  std::uint16_t pattern;
  std::string_view words;
};
constexpr Row kRows[] = {
    {0xFFFF, 0x0000, "no error"},
    {0xFFFF, 0x2310, "continuous over-current"},
    {0xFFFF, 0x2320, "short circuit or earth leakage"},
    {0xFFFF, 0x2330, "earth leakage"},
    {0xFFFF, 0x2340, "short circuit"},
    {0xFFFF, 0x2350, "overload by I2t, thermal state"},
    {0xFFFF, 0x3130, "phase failure"},
    {0xFFFF, 0x3210, "DC link over-voltage"},
    {0xFFFF, 0x3220, "DC link under-voltage"},
    {0xFFFF, 0x4210, "drive over-temperature"},
    {0xFFFF, 0x4310, "drive temperature too high"},
    {0xFFFF, 0x5441, "safe torque off"},
    {0xFFFF, 0x7121, "motor blocked"},
    {0xFFFF, 0x7122, "motor error or commutation fault"},
    {0xFFFF, 0x7305, "encoder 1 fault"},
    {0xFFFF, 0x7306, "encoder 2 fault"},
    {0xFFFF, 0x8110, "CAN overrun, frames lost"},
    {0xFFFF, 0x8120, "CAN in error passive mode"},
    {0xFFFF, 0x8130, "the master's heartbeat is lost"},
    {0xFFFF, 0x8140, "recovered from bus-off"},
    {0xFFFF, 0x8150, "CAN identifier collision"},
    {0xFFFF, 0x8210, "PDO not processed, length error"},
    {0xFFFF, 0x8220, "PDO length exceeded"},
    {0xFFFF, 0x8230, "multiplex PDO not processed"},
    {0xFFFF, 0x8240, "unexpected SYNC length"},
    {0xFFFF, 0x8250, "RPDO timeout"},
    {0xFFFF, 0x8480, "speed too high"},
    {0xFFFF, 0x8611, "following error"},
    {0xFFFF, 0x8612, "position reference beyond its limit"},
    {0xFFFF, 0x8700, "SYNC lost"},
    {0xFF00, 0x1000, "generic error"},
    {0xFF00, 0x2100, "current on the input side"},
    {0xFF00, 0x2200, "current inside the device"},
    {0xFF00, 0x2300, "current on the output side"},
    {0xF000, 0x2000, "current"},
    {0xFF00, 0x3100, "mains voltage"},
    {0xFF00, 0x3200, "voltage inside the device"},
    {0xFF00, 0x3300, "output voltage"},
    {0xF000, 0x3000, "voltage"},
    {0xFF00, 0x4100, "ambient temperature"},
    {0xFF00, 0x4200, "device temperature"},
    {0xF000, 0x4000, "temperature"},
    {0xF000, 0x5000, "device hardware"},
    {0xFF00, 0x6100, "device software, internal"},
    {0xFF00, 0x6200, "device software, user program"},
    {0xFF00, 0x6300, "device software, data set"},
    {0xF000, 0x6000, "device software"},
    {0xFF00, 0x7100, "power module or motor"},
    {0xFF00, 0x7300, "sensor of the drive"},
    {0xF000, 0x7000, "additional modules"},
    {0xFF00, 0x8100, "communication"},
    {0xFF00, 0x8200, "protocol error"},
    {0xFF00, 0x8300, "torque control"},
    {0xFF00, 0x8400, "speed control"},
    {0xFF00, 0x8500, "position control"},
    {0xFF00, 0x8600, "positioning"},
    {0xF000, 0x8000, "monitoring"},
    {0xFF00, 0x9000, "external error"},
    {0xFF00, 0xF000, "additional functions"},
    {0xFF00, 0xFF00, "device specific error"},
};

}  // namespace

std::optional<Emergency> decode_emergency(const hal::CanFrame& frame) {
  if (frame.length != 8) return std::nullopt;
  Emergency emergency{load<std::uint16_t>(frame, 0), frame.data[2], {}};
  for (std::size_t i = 0; i < emergency.own.size(); ++i) emergency.own[i] = frame.data[3 + i];
  return emergency;
}

bool is_information(const Emergency& emergency) {
  constexpr std::uint16_t kRecoveredFromBusOff = 0x8140;
  return emergency.error_register == 0 || emergency.code == kRecoveredFromBusOff;
}

std::string_view describe_emergency(std::uint16_t code) {
  for (const Row& row : kRows) {
    if ((code & row.mask) == row.pattern) return row.words;
  }
  return "unknown emergency code";
}

}  // namespace armsig::canopen
