// SPDX-License-Identifier: MIT
#include "firmware/controller/machine.hpp"

#include <array>

#include "core/base/crc32.hpp"
#include "firmware/controller/little_endian.hpp"

namespace armsig::controller {
namespace {

using hal::DriveIdentity;

constexpr std::array<std::string_view, hal::kDeviceNumbers> kDeviceWords{
    "drive_vendor", "drive_product", "drive_revision", "drive_serial"};

std::uint32_t crc_with(std::uint32_t crc, double value) {
  std::array<std::uint8_t, 8> bytes{};
  LittleEndianWriter(bytes).real(value);
  return crc32(std::as_bytes(std::span(bytes)), crc);
}

std::optional<MachineDifference> between_devices(const DriveIdentity& expected,
                                                 const DriveIdentity& found) {
  for (std::size_t i = 0; i < hal::kDeviceNumbers; ++i) {
    if (expected.device[i] == 0 || found.device[i] == 0) continue;
    if (expected.device[i] == found.device[i]) continue;
    return MachineDifference{kDeviceWords[i],
                             {},
                             static_cast<double>(found.device[i]),
                             static_cast<double>(expected.device[i])};
  }
  if (!hal::kSmallImage && expected.axis != found.axis) {
    return MachineDifference{
        "axis", {}, static_cast<double>(found.axis), static_cast<double>(expected.axis)};
  }
  return std::nullopt;
}

std::optional<MachineDifference> between_zeros(const DriveIdentity& expected,
                                               const DriveIdentity& found) {
  const std::array<MachineDifference, 5> counting{{
      {"counts_per_revolution", {}, found.counts_per_revolution, expected.counts_per_revolution},
      {"gear_ratio", {}, found.gear_ratio, expected.gear_ratio},
      {"lead_m", {}, found.lead_m, expected.lead_m},
      {"zero_counts",
       {},
       static_cast<double>(found.zero_counts),
       static_cast<double>(expected.zero_counts)},
      {"reversed", {}, found.reversed ? 1.0 : 0.0, expected.reversed ? 1.0 : 0.0},
  }};
  for (const MachineDifference& one : counting) {
    if (one.found != one.expected) return one;
  }
  return std::nullopt;
}

}  // namespace

void tell(const MachineDifference& difference, Line& line) {
  line.text(" what=").text(difference.what);
  if (difference.joint) line.text(" joint=").integer(*difference.joint + 1);
  line.text(" found=").number(difference.found, 3);
  line.text(" expected=").number(difference.expected, 3);
}

std::uint32_t drawing_crc(const Arm& drawing) {
  std::uint32_t crc = 0;
  for (const DhJoint& joint : drawing.joints) {
    crc = crc_with(crc, joint.type == JointType::kRevolute ? 0 : 1);
    for (const double value : {joint.theta_rad, joint.d_m, joint.a_m, joint.alpha_rad}) {
      crc = crc_with(crc, value);
    }
  }
  for (const JointCoupling& coupling : drawing.couplings) {
    crc = crc_with(crc, static_cast<double>(coupling.joint));
    crc = crc_with(crc, static_cast<double>(coupling.from));
    crc = crc_with(crc, coupling.ratio);
  }
  for (const double part : drawing.up_0) crc = crc_with(crc, part);
  return crc;
}

std::optional<Machine> machine_of(const Arm& drawing, const hal::JointDrives& drives) {
  Machine machine{.drives = {}, .drawing_crc = drawing_crc(drawing)};
  for (std::size_t joint = 0; joint < drives.count(); ++joint) {
    const auto identity = drives.identity(joint);
    if (!identity) return std::nullopt;
    machine.drives.push_back(*identity);
  }
  return machine;
}

std::uint32_t mark_of(const DriveIdentity& drive) {
  if (drive.device == DriveIdentity{}.device) return 0;
  const std::uint32_t crc = crc32(std::as_bytes(std::span(drive.device)));
  if (hal::kSmallImage || drive.axis == 1) return crc;
  return crc32(std::as_bytes(std::span(&drive.axis, 1)), crc);
}

std::optional<MachineDifference> difference(const Machine& expected, const Machine& found,
                                            Amplifiers amplifiers) {
  if (expected.drawing_crc != found.drawing_crc) {
    return MachineDifference{"nominal_model",
                             {},
                             static_cast<double>(found.drawing_crc),
                             static_cast<double>(expected.drawing_crc)};
  }
  if (expected.drives.size() != found.drives.size()) {
    return MachineDifference{"joints",
                             {},
                             static_cast<double>(found.drives.size()),
                             static_cast<double>(expected.drives.size())};
  }
  for (std::size_t joint = 0; joint < found.drives.size(); ++joint) {
    std::optional<MachineDifference> one;
    if (amplifiers == Amplifiers::kCompared) {
      one = between_devices(expected.drives[joint], found.drives[joint]);
    }
    if (!one) one = between_zeros(expected.drives[joint], found.drives[joint]);
    if (!one) continue;
    one->joint = joint;
    return one;
  }
  return std::nullopt;
}

}  // namespace armsig::controller
