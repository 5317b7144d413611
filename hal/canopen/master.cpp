// SPDX-License-Identifier: MIT
#include "hal/canopen/master.hpp"

#include <chrono>

#include "core/base/check.hpp"
#include "hal/canopen/emergency.hpp"

namespace armsig::canopen {

using cia402::Goal;

Master::Master(const CheckedConfiguration& configuration, hal::CanBus& bus, FrameSink* other_frames)
    : configuration_(configuration),
      bus_(&bus),
      other_frames_(other_frames),
      group_(*configuration_) {
  for (std::size_t axis = 0; axis < configuration_->axes.size(); ++axis) {
    nodes_.push_back(DriveNode(configuration_->axes[axis], configuration_.scaling(axis)));
    group_.add(nodes_.back()->drive());
    inquiries_.push_back(std::nullopt);
    inquiries_.back().emplace(configuration_->axes[axis], configuration_.scaling(axis),
                              configuration_->sdo_timeout);
  }
  positions_.resize(nodes_.size());
  other_needs_start_.fill(true);
}

Result<void> Master::do_read(hal::Instant now) {
  now_ = now;
  const hal::CanState bus_state = bus_->status().state;
  const bool usable = bus_state != hal::CanState::kDown && bus_state != hal::CanState::kBusOff;
  bool any_started = false;
  for (const auto& node : nodes_) any_started = any_started || node->is_started();
  const bool sync_sent = usable && any_started && send(sync_frame()).has_value();

  for (unsigned taken = 0; taken < kMaxFramesPerTick; ++taken) {
    const auto received = bus_->receive();
    if (!received) break;
    take(with_plausible_stamp(*received));
  }
  if (!usable) {
    latch_started(bus_state == hal::CanState::kDown ? Error::kBusDown : Error::kBusOff);
  }
  for (std::size_t joint = 0; joint < nodes_.size(); ++joint) {
    [[maybe_unused]] const unsigned missed = nodes_[joint]->state().missed;
    nodes_[joint]->supervise(*configuration_, sync_sent, now);
#ifndef ARMSIG_SMALL_IMAGE
    if (nodes_[joint]->state().missed > missed) ++counters_.unanswered;
#endif
    positions_[joint] = nodes_[joint]->drive().state().position;
  }
  group_.supervise(now);
  release_drives();
  if (bus_state == hal::CanState::kDown) return std::unexpected(Error::kBusDown);
  if (bus_state == hal::CanState::kBusOff) return std::unexpected(Error::kBusOff);
  return {};
}

void Master::latch_started(Error error) {
  for (auto& node : nodes_) {
    if (node->is_started()) node->drive().latch(error);
  }
}

void Master::release_drives() {
  if (!group_.may_release()) return;
  for (auto& node : nodes_) node->release(now_);
}

// The stamps of some buses follow a clock that people set. A frame was not received after now, nor
// long before the last tick.
hal::ReceivedCanFrame Master::with_plausible_stamp(hal::ReceivedCanFrame received) const {
  constexpr hal::Duration kOldest = std::chrono::milliseconds(200);
  if (received.at > now_ || now_ - received.at > kOldest) received.at = now_;
  return received;
}

void Master::take(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  if (frame.extended || frame.remote) {
    ++counters_.unknown;
    return;
  }
  const std::uint32_t function = frame.id & kFunctionMask;
  const auto node = static_cast<NodeId>(frame.id & kNodeMask);
  if (frame.id == kNmtId && !is_about_ours(frame)) {
    ++counters_.unknown;
    return;
  }
  const bool is_masters = frame.id == kNmtId || frame.id == kSyncId ||
                          (function == kHeartbeatId && node == configuration_->master_node);
  if (is_masters) {
    ++counters_.foreign;
    group_.latch_all(Error::kSecondMaster);
    return;
  }
  for (auto& drive : nodes_) {
    if (drive->node() != node) continue;
    take_of_drive(*drive, received);
    return;
  }
  take_of_other(received);
}

void Master::count([[maybe_unused]] const DriveNode& drive,
                   [[maybe_unused]] const hal::CanFrame& frame) {
#ifndef ARMSIG_SMALL_IMAGE
  const std::uint32_t function = frame.id & kFunctionMask;
  if (function == kHeartbeatId && drive.is_started() &&
      now_ - drive.state().heard_at > 2 * configuration_->heartbeat) {
    ++counters_.late_heartbeats;
  }
  if (function != kEmergencyId) return;
  const auto emergency = decode_emergency(frame);
  if (emergency && emergency->code != 0) ++counters_.emergencies;
#endif
}

void Master::take_of_drive(DriveNode& drive, const hal::ReceivedCanFrame& received) {
  if constexpr (!hal::kSmallImage) count(drive, received.frame);
  bool well_formed = true;
  switch (received.frame.id & kFunctionMask) {
    case kHeartbeatId:
      for_axes_of(
          drive, [&](DriveNode& axis) { well_formed = axis.take_heartbeat(received.frame, now_); });
      break;
    case kEmergencyId:
      for_axes_of(drive,
                  [&](DriveNode& axis) { well_formed = axis.take_emergency(received.frame); });
      break;
    case kSdoResponseId:
      take_answer(drive, received.frame);
      break;
    default:
      well_formed = take_pdo(drive, received);
  }
  if (!well_formed) ++counters_.malformed;
}

// By the axis of the node that has this identifier, if one has.
bool Master::take_pdo(DriveNode& drive, const hal::ReceivedCanFrame& received) {
  bool known = false;
  bool well_formed = true;
  for_axes_of(drive, [&](DriveNode& axis) {
    if (received.frame.id == axis.pdo_id(kTransmitPdo1Id)) {
      known = true;
      well_formed = axis.take_feedback(received);
    } else if (received.frame.id == axis.pdo_id(kReceivePdo1Id)) {
      known = true;
      ++counters_.foreign;
      group_.latch_all(Error::kSecondMaster);
    }
  });
  if (!known) ++counters_.unknown;
  return well_formed;
}

void Master::take_of_other(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  const auto& others = configuration_->other_nodes;
  for (std::size_t i = 0; i < others.size(); ++i) {
    // A device that says it is not operational is started (again).
    if (frame.id == kHeartbeatId + others[i] && frame.length == 1 &&
        static_cast<NmtState>(frame.data[0] & 0x7FU) != NmtState::kOperational) {
      other_needs_start_[i] = true;
    }
  }
  if (other_frames_ != nullptr) {
    other_frames_->take(received);
  } else {
    ++counters_.unknown;
  }
}

Result<void> Master::do_write(const JointVector& targets, hal::Instant now) {
  now_ = now;
  busy_now_ = false;
  Result<void> result = group_.set_targets(targets, now);
  if (!own_heartbeat_at_ || now - *own_heartbeat_at_ >= configuration_->heartbeat) {
    if (send(heartbeat_frame(configuration_->master_node, NmtState::kOperational))) {
      own_heartbeat_at_ = now;
    }
    if constexpr (cia402::kMostAxes > 1) {
      send_guarding();
    } else {
      for (const auto& node : nodes_) {
        if (node->is_guarded()) (void)send(guard_frame(node->node()));
      }
    }
  }
  step_others();
  step_setup();
  step_mode_inquiry();
  if constexpr (hal::kMayHome) step_homing();
  for (auto& node : nodes_) {
    if (node->state().phase != Phase::kRunning) continue;  // no position to hold is known yet
    const auto sent = send(node->command(group_.may_release()));
    if (!sent && result) result = sent;
  }
  busy_ticks_ = busy_now_ ? busy_ticks_ + 1 : 0;
  if (busy_ticks_ >= kBusBusyLimit) latch_started(Error::kBusBusy);
  return result;
}

// Once a node.
void Master::send_guarding() {
  for (auto& node : nodes_) {
    if (!node->is_guarded()) continue;
    const DriveNode* first = nullptr;
    for_axes_of(*node, [&](DriveNode& axis) {
      if (first == nullptr && axis.is_guarded()) first = &axis;
    });
    if (first == &*node) (void)send(guard_frame(node->node()));
  }
}

Result<void> Master::send(const hal::CanFrame& frame) {
  auto sent = bus_->send(frame);
  if (!sent) {
    ++counters_.unsent;
    busy_now_ = busy_now_ || sent.error() == Error::kBusBusy;
  }
  return sent;
}

Result<void> Master::do_enable() {
  for (const auto& node : nodes_) {
    if (node->drive().state().fault || node->state().phase != Phase::kRunning) {
      return std::unexpected(Error::kDrivesNotReady);
    }
  }
  for (std::size_t axis = 0; axis < nodes_.size(); ++axis) {
    if (nodes_[axis]->state().unsupervised && !configuration_->axes[axis].unsupervised_known) {
      return std::unexpected(Error::kDriveUnsupervised);
    }
  }
  group_.set_goal(Goal::kEnabled, now_);
  release_drives();
  return {};
}

void Master::do_disable() {
  group_.set_goal(Goal::kDisabled, now_);
  release_drives();
}

void Master::do_quick_stop() {
  group_.set_goal(Goal::kStopped, now_);
  release_drives();
}

Result<void> Master::do_home(std::size_t joint) {
  if constexpr (hal::kMayHome) {
    nodes_[joint]->drive().begin_homing(now_);
    homing_.emplace(*configuration_, joint);
    return {};
  }
  return std::unexpected(Error::kUnsupported);
}

void Master::do_stop_homing() {
  if constexpr (hal::kMayHome) {
    if (homing_) nodes_[homing_->joint()]->drive().leave_homing(now_);
  }
}

void Master::do_reset_faults() {
  do_disable();
  for (auto& node : nodes_) node->reset(now_);
  if constexpr (cia402::kMostAxes > 1) reset_whole_nodes();
  release_drives();
}

}  // namespace armsig::canopen
