// SPDX-License-Identifier: MIT
// The servo tick: read drives, supervise, mode step, command drives, publish.
#pragma once

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/link.hpp"
#include "hal/clock.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {

class Servo {
 public:
  Servo(const Configuration& configuration, hal::JointDrives& drives, hal::Clock& clock,
        Link& link);

  void tick(hal::Duration lateness);

 private:
  [[nodiscard]] bool has_torque() const { return kWithTorque.contains(mode_); }
  void supervise(const Result<void>& read, hal::Duration lateness);
  void supervise_drives();
  void wait_for_drives(const Result<void>& read);
  void supervise_following();
  void read_torque();
  void supervise_torque();
  void take_commands();
  void follow_positions();
  [[nodiscard]] std::optional<Error> take(const Command& command);
  void disable();
  void halt();
  [[nodiscard]] std::optional<Error> begin(const Move& move);
  void begin_sequence();
  void step_mode();
  void step_move();
  [[nodiscard]] std::optional<Error> home(std::size_t joint);
  void step_homing();
  [[nodiscard]] bool is_homing(std::size_t joint) const {
    return hal::kMayHome && homing_ == joint;
  }
  void command_drives();
  void publish(hal::Duration lateness);
  void publish_tool(Snapshot& out) const;
  void publish_torque(Snapshot& out) const;
  void publish_machine();
  void publish_gaps();
  void publish_words();
  void fail(Error error, std::optional<std::size_t> joint = {}, std::uint32_t code = 0,
            std::string_view words = {});
  void learn_the_reason();
  [[nodiscard]] bool is_settled() const;

  const Configuration& configuration_;
  hal::JointDrives& drives_;
  hal::Clock& clock_;
  Link& link_;

  Mode mode_ = Mode::kStarting;
  std::optional<Fault> fault_;
  bool enabling_ = false;
  bool in_sequence_ = false;
  std::optional<Move> move_;
  std::optional<std::size_t> homing_;  // joint
  hal::Instant now_;
  // It advances by a period a tick, so that a late tick makes the move longer and never jump.
  PathParameter path_;
  hal::Instant unsettled_at_;
  JointVector commanded_;
  calibration::LatelyTurned lately_;  // in the tick before
  std::size_t model_ = 0;
  std::uint32_t handled_ = 0;
  std::array<CommandResult, 8> results_{};
  Histogram lateness_;
  Histogram execution_;
#ifndef ARMSIG_SMALL_IMAGE
  std::array<hal::Torque, kMaxJoints> torque_{};             // of the joints that have a limit
  std::array<hal::Instant, kMaxJoints> torque_within_at_{};  // last within its limit
  std::array<double, kMaxJoints> largest_torque_{};          // in the last sequence
#endif
  bool faults_told_ = false;  // the last that was published is not empty
};

}  // namespace armsig::controller
