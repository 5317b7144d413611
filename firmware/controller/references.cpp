// SPDX-License-Identifier: MIT
#include "firmware/controller/references.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace armsig::controller {
namespace {

// Error of the tool by a model that does not state its own.
constexpr double kNominalError_m = 1e-3;
constexpr double kTool_m = 0.25;  // that a hand may carry
constexpr double kCounts = 3;
// No joint is faster than this many times its limit; a reading that is has lost its count.
constexpr double kFall = 10;
// An arm that was pushed about has stood still for so long before its place is kept.
constexpr hal::Duration kStill = std::chrono::seconds(1);

double error_of(const SignatureRecord* in_use) {
  if (in_use == nullptr) return kNominalError_m;
  if (in_use->accuracy.predicted) return in_use->accuracy.predicted->rms_m;
  return in_use->accuracy.validated ? in_use->accuracy.validated->rms_m : kNominalError_m;
}

constexpr std::uint8_t bit_of(std::size_t joint) { return static_cast<std::uint8_t>(1U << joint); }

}  // namespace

References::References(const Configuration& configuration, hal::NonvolatileMemory& memory,
                       std::size_t sector)
    : configuration_(configuration), keeper_(memory, sector) {}

bool References::turns(std::size_t joint) const {
  return configuration_.drawing.joints[joint].type == JointType::kRevolute;
}

void References::doubt(std::size_t joint) {
  at_rest_.unreferenced |= bit_of(joint);
  at_rest_.by_drive &= static_cast<std::uint8_t>(~bit_of(joint));
}

void References::trust(std::size_t joint) {
  at_rest_.unreferenced &= static_cast<std::uint8_t>(~bit_of(joint));
  at_rest_.by_drive &= static_cast<std::uint8_t>(~bit_of(joint));
  at_rest_.drives[joint] = drives_[joint];
  changed_ = true;
}

void References::state_tolerances(const SignatureRecord* in_use) {
  const double error_m = 3 * error_of(in_use);
  const auto& joints = configuration_.drawing.joints;
  tolerances_ = JointVector(joints.size(), error_m);
  double lever_m = kTool_m;
  for (std::size_t i = joints.size(); i-- > 0;) {
    lever_m += std::abs(joints[i].a_m) + std::abs(joints[i].d_m);
    if (turns(i)) tolerances_[i] = error_m / lever_m;
    if (!configuration_.resolution.empty()) {
      tolerances_[i] = std::max(tolerances_[i], kCounts * configuration_.resolution[i]);
    }
  }
}

// The first time since power-up: what is known of the time before is what was kept.
void References::begin(const Snapshot& now, const SignatureRecord* in_use) {
  compared_ = true;
  if (auto kept = keeper_.load(now.positions.size())) {
    at_rest_ = *kept;
    return;
  }
  due_ = true;
  at_rest_.positions = now.positions;
  at_rest_.drives = DriveMarks(now.positions.size(), 0);
  if (in_use == nullptr) return;
  for (std::size_t i = 0; i < now.positions.size(); ++i) doubt(i);
}

void References::compare(const Snapshot& now, const Machine& machine, const SignatureRecord* in_use,
                         const Announcer& announcer) {
  const std::size_t joints = now.positions.size();
  state_tolerances(in_use);
  if (!compared_) begin(now, in_use);
  drives_ = DriveMarks(joints, 0);
  for (std::size_t i = 0; i < joints; ++i) {
    if (i < machine.drives.size()) drives_[i] = mark_of(machine.drives[i]);
    const double moved = now.positions[i] - at_rest_.positions[i];
    // A drive that has homed since it was set up last has not lost its count: a reset of a fault
    // may leave it as it is.
    const bool homed = (now.homed & bit_of(i)) != 0;
    const bool counts_anew = configuration_.reference(i) != Reference::kAbsolute && !homed;
    const std::uint32_t was = at_rest_.drives[i];
    if (was == 0) at_rest_.drives[i] = drives_[i];
    const bool doubted = (at_rest_.unreferenced & bit_of(i)) != 0;
    if (std::abs(moved) > tolerances_[i]) {
      doubt(i);
      tell(i, "moved", moved, announcer);
    } else if (counts_anew) {
      doubt(i);
      tell(i, "counts_from_power_up", {}, announcer);
    } else if (was != 0 && drives_[i] != 0 && was != drives_[i]) {
      if (!doubted) at_rest_.by_drive |= bit_of(i);
      at_rest_.unreferenced |= bit_of(i);
      tell(i, "other_drive", {}, announcer);
    } else if (doubted) {
      tell(i, "not_confirmed", {}, announcer);
    }
  }
  at_rest_.positions = now.positions;
  tracked_at_ = now.now;
  just_compared_ = true;
}

void References::tell(std::size_t joint, std::string_view why, std::optional<double> moved,
                      const Announcer& announcer) const {
  Line line;
  line.text("# unreferenced joint=").integer(joint + 1).text(" why=").text(why);
  const double unit = turns(joint) ? degrees(1) : 1e3;
  if (moved) line.text(turns(joint) ? " by_deg=" : " by_mm=").number(unit * *moved, 3);
  line.reason(Error::kUnreferenced);
  if (hal::kMayHome && configuration_.reference(joint) == Reference::kHomed) {
    announcer.say(line.text(" home joint=").integer(joint + 1));
    return;
  }
  if ((at_rest_.by_drive & bit_of(joint)) != 0) line.text(" check, or");
  line.text(" look at the joint, then confirm q").integer(joint + 1);
  announcer.say(line.text(turns(joint) ? "_deg=..." : "_mm=..."));
}

// A drive has found the place where it counts zero.
void References::take_homed(const Snapshot& now, const Announcer& announcer) {
  const unsigned just_homed = now.homed & ~homed_;
  homed_ = now.homed;
  for (std::size_t i = 0; i < at_rest_.positions.size(); ++i) {
    if ((just_homed & bit_of(i)) == 0) continue;
    trust(i);
    at_rest_.positions[i] = now.positions[i];
    Line line;
    announcer.say(line.text("# homed joint=").integer(i + 1));
  }
}

// While the drives tell their positions, the arm is where they say: with torque, and pushed by hand
// without it. Only a reading that is elsewhere at once has lost its count.
void References::track(const Snapshot& now, const Announcer& announcer) {
  const std::size_t joints = at_rest_.positions.size();
  if (now.mode == Mode::kStarting || now.known != (1U << joints) - 1) return;
  // What was told then may be as old as a drive may be silent.
  const double passed_s = hal::seconds(now.now - tracked_at_ + configuration_.feedback_age);
  for (std::size_t i = 0; i < joints; ++i) {
    if (hal::kMayHome && (now.homing & bit_of(i)) != 0) {
      doubt(i);  // its reading may become another
      continue;
    }
    const double moved = now.positions[i] - at_rest_.positions[i];
    const double most = kFall * configuration_.limits.speed[i] * passed_s + tolerances_[i];
    if (!(std::abs(moved) > most)) continue;
    doubt(i);
    changed_ = true;
    tell(i, "jumped", moved, announcer);
  }
  at_rest_.positions = now.positions;
  tracked_at_ = now.now;
}

// What has changed is kept at once where the torque has just gone, and where the arm was pushed
// about once it stands still: there is a page for each time.
bool References::is_to_be_kept(const Snapshot& now) {
  for (std::size_t i = 0; i < at_rest_.positions.size(); ++i) {
    const bool still =
        i < still_.size() && std::abs(at_rest_.positions[i] - still_[i]) <= tolerances_[i] / 4;
    if (still) continue;
    still_ = at_rest_.positions;
    still_since_ = now.now;
    changed_ = true;
  }
  return due_ || (changed_ && now.now - still_since_ >= kStill);
}

bool References::step(const Snapshot& now, const Announcer& announcer) {
  if (std::exchange(just_compared_, false)) return true;
  if (!compared_) return false;
  if constexpr (hal::kMayHome) take_homed(now, announcer);
  track(now, announcer);
  due_ = due_ || kWithTorque.contains(now.mode);
  if (keeper_.is_writing()) {
    keeper_.step();
    return true;
  }
  if (now.mode == Mode::kIdle && now.all_disabled && is_to_be_kept(now)) {
    due_ = changed_ = false;
    keeper_.begin(at_rest_);
  }
  return false;
}

void References::finish(const hal::JointDrives& drives) {
  if (!compared_ || !drives.all(hal::DriveCondition::kDisabled)) return;
  at_rest_.positions = drives.positions();
  while (keeper_.is_writing()) keeper_.step();
  keeper_.begin(at_rest_);
  while (keeper_.is_writing()) keeper_.step();
}

Result<void> References::confirm(std::size_t joint, double seen) {
  const double off = std::abs(at_rest_.positions[joint] - seen);
  if (!(off <= (turns(joint) ? kSeen_rad : kSeen_m))) return std::unexpected(Error::kUnreferenced);
  trust(joint);
  return {};
}

void References::take_check(const Announcer& announcer) {
  if (at_rest_.by_drive == 0 || !may_check()) return;
  Line line;
  announcer.say(line.text("# referenced joints=").numbers(at_rest_.by_drive).text(" by=check"));
  for (std::size_t i = 0; i < at_rest_.positions.size(); ++i) {
    if ((at_rest_.by_drive & bit_of(i)) != 0) trust(i);
  }
}

}  // namespace armsig::controller
