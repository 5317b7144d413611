// SPDX-License-Identifier: MIT
// Whether the joints stand where their readings say. A joint is *unreferenced* where that is not
// certain: its encoder counts from power-up, it is found elsewhere than it was left, nothing was
// kept of where it was left, its reading jumped, or another drive reads its encoder. While a joint
// is, the tool is not moved, nothing is measured and no signature is accepted. Its drive homes, or
// a person looks at the joint and confirms its reading. Where another drive is the only reason, and
// the joint is where it was left, a check that finds the arm as accepted does as well.
//
// Where the arm rests without torque is kept over a loss of power, with what is not confirmed yet.
#pragma once

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/link.hpp"
#include "firmware/controller/position_keeper.hpp"
#include "firmware/controller/signature_record.hpp"

namespace armsig::controller {

class References {
 public:
  // What a person sees of a joint may differ so much from its reading.
  static constexpr double kSeen_rad = radians(1.0);
  static constexpr double kSeen_m = 2e-3;
  // A move of an unreferenced arm is at most so long, and at most at this pace.
  static constexpr double kJog_rad = radians(10.0);
  static constexpr double kJog_m = 0.05;
  static constexpr double kJogPace = 0.1;

  // `sector` of the memory is for this alone.
  References(const Configuration& configuration, hal::NonvolatileMemory& memory,
             std::size_t sector);

  // The drives have been set up: where the joints are now is held against where they were known to
  // be last. Every joint that is unreferenced is told, with the reason. `in_use`: the signature;
  // null: the nominal model.
  void compare(const Snapshot& now, const Machine& machine, const SignatureRecord* in_use,
               const Announcer& announcer);
  // To be called in every step of the background; one erase or one page at most. True if it was
  // that, or compare() in the same step: a step of the background has time for no more.
  [[nodiscard]] bool step(const Snapshot& now, const Announcer& announcer);
  // At the end of a controller that is no longer run: keeps where `drives` are, if none has torque.
  void finish(const hal::JointDrives& drives);

  // A bit per joint.
  [[nodiscard]] std::uint8_t unreferenced() const { return at_rest_.unreferenced; }
  // A check may be measured: another drive is the only reason for what is unreferenced.
  [[nodiscard]] bool may_check() const { return at_rest_.unreferenced == at_rest_.by_drive; }
  // A check has found the arm as it was accepted.
  void take_check(const Announcer& announcer);
  // A person sees joint `joint` at reading `seen`. Error: kUnreferenced (its reading is another).
  [[nodiscard]] Result<void> confirm(std::size_t joint, double seen);

 private:
  void begin(const Snapshot& now, const SignatureRecord* in_use);
  void state_tolerances(const SignatureRecord* in_use);
  void tell(std::size_t joint, std::string_view why, std::optional<double> moved,
            const Announcer& announcer) const;
  void doubt(std::size_t joint);
  void trust(std::size_t joint);
  [[nodiscard]] bool turns(std::size_t joint) const;
  void take_homed(const Snapshot& now, const Announcer& announcer);
  void track(const Snapshot& now, const Announcer& announcer);
  [[nodiscard]] bool is_to_be_kept(const Snapshot& now);

  const Configuration& configuration_;
  PositionKeeper keeper_;
  RestRecord at_rest_;  // as it is now, and what is known of it
  JointVector still_;   // where it has stood since still_since_
  // How far each joint may be from where it was left [rad or m]: what moves the tool by three times
  // the error that the model in use has, not below three counts.
  JointVector tolerances_;
  DriveMarks drives_;  // of those that are there
  hal::Instant tracked_at_;
  hal::Instant still_since_;
  std::uint8_t homed_ = 0;  // bit per joint: had homed before
  bool compared_ = false;
  bool just_compared_ = false;
  bool due_ = false;      // to be kept as soon as it rests
  bool changed_ = false;  // to be kept once it stands still
};

}  // namespace armsig::controller
