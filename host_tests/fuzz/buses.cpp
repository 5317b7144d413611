// SPDX-License-Identifier: MIT
// The wires: Modbus RTU answers, CAN frames of a range sensor, and a CANopen master with its drives
// on a bus on which somebody else sends as well.
#include <array>
#include <chrono>
#include <cmath>

#include "hal/canopen/emergency.hpp"
#include "hal/canopen/range_sensor.hpp"
#include "hal/canopen/sdo_client.hpp"
#include "hal/linux/length_line.hpp"
#include "hal/linux/point_line.hpp"
#include "hal/modbus/range_sensor.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::fuzz {
namespace {

using std::chrono::milliseconds;

void check_reading(const Result<std::optional<hal::RangeReading>>& polled) {
  if (!polled || !*polled) return;
  FUZZ_CHECK(!(*polled)->receivers.empty());
  FUZZ_CHECK(std::isfinite((*polled)->air_celsius));
  for (const hal::ReceiverReading& receiver : (*polled)->receivers) {
    FUZZ_CHECK(std::isfinite(receiver.flight_s) && receiver.flight_s >= 0);
  }
}

void fuzz_rtu(Bytes bytes) {
  (void)modbus::answer_bytes(bytes);
  const modbus::ReadRequest request{.registers = *modbus::registers_of({})};
  const auto registers = modbus::decode(request, bytes);
  if (!registers) return;
  FUZZ_CHECK(registers->size() == request.registers.count);
  (void)modbus::decode(modbus::Profile{}, *registers);
}

// A point that is taken is a place, and its covariance is one.
void fuzz_points(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto point = linux_hal::PointLine::parse(text);
  if (!point) {
    FUZZ_CHECK(!point.error().key.empty() && !point.error().what.empty());
    return;
  }
  FUZZ_CHECK(point->p_S.allFinite());
  FUZZ_CHECK(point->p_S.cwiseAbs().maxCoeff() <= 1e-3 * linux_hal::kFarthest_mm);
  if (!point->covariance_m2) return;
  FUZZ_CHECK(point->covariance_m2->allFinite());
  FUZZ_CHECK(point->covariance_m2->diagonal().minCoeff() > 0);
}

// Lengths that are taken are lengths.
void fuzz_lengths(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto line = linux_hal::LengthLine::parse(text);
  if (!line) {
    FUZZ_CHECK(!line.error().key.empty() && !line.error().what.empty());
    return;
  }
  FUZZ_CHECK(!line->lengths_m.empty() && line->lengths_m.size() <= hal::kMaxLengths);
  for (const auto& length_m : line->lengths_m) {
    FUZZ_CHECK(!length_m || (*length_m > 0 && *length_m <= 1e-3 * linux_hal::kFarthest_mm));
  }
}

// What the tape brings, a piece a poll; its checksum mended now and then, or the fuzzer would never
// get beyond it.
class TapeLine final : public hal::ByteStream {
 public:
  explicit TapeLine(Tape& tape) : tape_(tape) {}

 private:
  Result<void> do_write(std::span<const std::uint8_t> /*bytes*/) override {
    left_ = 0;
    const std::uint8_t kind = tape_.byte();
    if (kind % 8 == 7) return std::unexpected(Error::kBusBusy);
    const Bytes answer = tape_.take(kind % 64);
    std::ranges::copy(answer, buffer_.begin());
    left_ = answer.size();
    if (kind >= 64) {
      const std::uint16_t crc = modbus::crc16({buffer_.data(), left_});
      buffer_[left_++] = static_cast<std::uint8_t>(crc);
      buffer_[left_++] = static_cast<std::uint8_t>(crc >> 8U);
    }
    begin_ = 0;
    return {};
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override {
    const std::size_t count = std::min({into.size(), left_, std::size_t{1} + tape_.below(16)});
    std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), count, into.begin());
    begin_ += count;
    left_ -= count;
    return count;
  }

  Tape& tape_;
  std::array<std::uint8_t, 80> buffer_{};
  std::size_t begin_ = 0;
  std::size_t left_ = 0;
};

void fuzz_modbus_sensor(Bytes bytes) {
  Tape tape(bytes.first(std::min<std::size_t>(bytes.size(), 512)));
  TapeLine line(tape);
  modbus::RangeSensor sensor({}, line);
  for (hal::Instant now; !tape.empty(); now += milliseconds(1)) check_reading(sensor.poll(now));
}

// A field anywhere in few units, so that fields meet.
modbus::Field field_of(Tape& tape) {
  return {
      .unit = static_cast<std::uint8_t>(1 + tape.below(3)),
      .function = static_cast<std::uint8_t>(3 + tape.below(2)),
      .first = static_cast<std::uint16_t>(tape.byte() < 16 ? 65'400 + tape.byte() : tape.byte()),
      .format = static_cast<modbus::Format>(tape.below(5)),
      .high_word_first = tape.below(2) == 0,
      .step = 1e-3};
}

modbus::ChannelProfile channels_of(Tape& tape) {
  modbus::ChannelProfile profile;
  const std::size_t count = tape.below(6);
  for (std::size_t j = 0; j < count; ++j) profile.channels.push_back({.field = field_of(tape)});
  const std::uint8_t what = tape.byte();
  profile.distance = what % 2 == 0;
  if (what % 3 == 0) profile.air = field_of(tape);
  if (what % 5 == 0) profile.counter = field_of(tape);
  profile.largest_gap = tape.byte();
  return profile;
}

// Every field is in one request, and none is longer than a frame has room for.
void check_requests(const modbus::ChannelProfile& profile, const modbus::Requests& requests) {
  for (const modbus::ReadRequest& request : requests) {
    FUZZ_CHECK(request.registers.count >= 1 && request.registers.count <= modbus::kMaxRegisters);
  }
  for (const modbus::Channel& channel : profile.channels) {
    FUZZ_CHECK(std::ranges::count_if(requests, [&](const modbus::ReadRequest& request) {
                 return modbus::covers(request, channel.field);
               }) == 1);
  }
}

void fuzz_modbus_channels(Bytes bytes) {
  Tape tape(bytes.first(std::min<std::size_t>(bytes.size(), 512)));
  const modbus::ChannelProfile profile = channels_of(tape);
  const auto requests = modbus::requests_of(profile);
  if (!requests) return;
  check_requests(profile, *requests);
  TapeLine line(tape);
  modbus::RangeSensor sensor({.channels = profile}, line);
  for (hal::Instant now; !tape.empty(); now += milliseconds(1)) check_reading(sensor.poll(now));
}

hal::CanFrame frame_of(Tape& tape) {
  hal::CanFrame frame;
  const std::uint8_t kind = tape.byte();
  frame.id = (static_cast<std::uint32_t>(kind % 16) << 7U) | (tape.byte() % 128U);
  frame.length = std::min<std::uint8_t>(kind >> 4U, hal::kMaxCanData);
  frame.remote = kind == 0xF0;
  frame.extended = kind == 0xE0;
  const Bytes data = tape.take(frame.length);
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

void fuzz_can_sensor(Bytes bytes) {
  Tape tape(bytes);
  canopen::RangeSensor sensor({});
  hal::Instant now;
  while (!tape.empty()) {
    hal::CanFrame frame = frame_of(tape);
    // Most are the sensor's own.
    if (frame.id % 128 >= 16) frame.id = (frame.id & 0x780U) | 32U;
    now += std::chrono::microseconds(100 * tape.byte());
    sensor.take({frame, now});
    check_reading(sensor.poll(now));
  }
}

void fuzz_sdo(Bytes bytes) {
  Tape tape(bytes);
  const hal::CanFrame frame = frame_of(tape);
  const canopen::SdoRequest request{.index = static_cast<std::uint16_t>(tape.word()),
                                    .subindex = tape.byte(),
                                    .bytes = static_cast<std::uint8_t>(tape.below(3)),
                                    .value = tape.word()};
  if (const auto outcome = canopen::decode_sdo(frame, request); outcome && !*outcome) {
    FUZZ_CHECK(!canopen::describe_sdo_abort(outcome->error().abort_code).empty());
  }
  if (const auto told = canopen::decode_emergency(frame)) {
    FUZZ_CHECK(!canopen::describe_emergency(told->code).empty());
  }
}

// One tick of an operator and a stranger.
void disturb(test::EmulatedArm& arm, simulated::VirtualCanPort& stranger, Tape& tape) {
  const std::uint8_t what = tape.byte();
  switch (what % 16) {
    case 0:
      (void)arm.master->enable();
      arm.following = true;
      break;
    case 1:
      arm.master->disable();
      arm.following = false;
      break;
    case 2:
      arm.master->quick_stop();
      arm.following = false;
      break;
    case 3:
      arm.master->reset_faults();
      break;
    case 4:
      for (double& target : arm.targets) target += 1e-3 * tape.share();
      break;
    case 5:
      arm.drives[tape.below(arm.drives.size())].inject(
          static_cast<simulated::DriveFault>(tape.below(17)),
          static_cast<std::int32_t>(tape.word()));
      break;
    case 6:
      arm.master_port.go_bus_off();
      break;
    case 7:
      arm.master_port.set_up(tape.byte() % 2 == 0);
      break;
    default:
      for (std::size_t i = 0; i < what % 4U; ++i) (void)stranger.send(frame_of(tape));
  }
}

// The promise of the master: a position is a number, and once a drive is faulted, none keeps
// following its targets.
void check_master(const test::EmulatedArm& arm) {
  for (const double position : arm.master->positions()) FUZZ_CHECK(std::isfinite(position));
  for (std::size_t joint = 0; joint < arm.drives.size(); ++joint) {
    const hal::DriveStatus status = arm.master->status(joint);
    FUZZ_CHECK((status.condition == hal::DriveCondition::kFaulted) <= status.fault.has_value());
  }
}

void fuzz_can_master(Bytes bytes) {
  Tape tape(bytes);
  test::EmulatedArm arm(test::puma_drives(2));
  simulated::VirtualCanPort stranger;
  arm.bus.connect(stranger);
  const bool ready = tape.byte() % 4 != 0;
  if (ready) FUZZ_CHECK(arm.run_until(hal::DriveCondition::kDisabled));
  for (unsigned ticks = 0; !tape.empty() && ticks < 100; ++ticks) {
    disturb(arm, stranger, tape);
    arm.run(1 + static_cast<unsigned>(tape.below(4)));
    check_master(arm);
  }
}

constexpr std::array kTargets{Target{"rtu", fuzz_rtu},
                              Target{"points", fuzz_points},
                              Target{"lengths", fuzz_lengths},
                              Target{"modbus_sensor", fuzz_modbus_sensor},
                              Target{"modbus_channels", fuzz_modbus_channels},
                              Target{"can_sensor", fuzz_can_sensor},
                              Target{"sdo", fuzz_sdo},
                              Target{"can_master", fuzz_can_master}};

}  // namespace

std::span<const Target> bus_targets() { return kTargets; }

}  // namespace armsig::fuzz
