// SPDX-License-Identifier: MIT
#include "hal/canopen/master.hpp"

#include <algorithm>
#include <chrono>

#include "core/base/check.hpp"
#include "hal/canopen/emergency.hpp"

namespace armsig::canopen {

using cia402::Goal;

Master::Master(const CheckedConfiguration& configuration, const NamedBuses& buses,
               FrameSink* other_frames)
    : configuration_(configuration), other_frames_(other_frames), group_(*configuration_) {
  ARMSIG_CHECK(buses.size() == bus_count());
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) {
    buses_[bus].can = buses[bus].bus;
    buses_[bus].name = buses[bus].name;
    buses_[bus].other_needs_start.fill(true);
  }
  for (std::size_t axis = 0; axis < configuration_->axes.size(); ++axis) {
    nodes_.push_back(DriveNode(configuration_->axes[axis], configuration_.scaling(axis)));
    group_.add(nodes_.back()->drive());
    inquiries_.push_back(std::nullopt);
    inquiries_.back().emplace(configuration_->axes[axis], configuration_.scaling(axis),
                              configuration_->sdo_timeout);
  }
  positions_.resize(nodes_.size());
}

Result<void> Master::do_read(hal::Instant now) {
  now_ = now;
  std::array<Cycle, kMostBuses> cycles;
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) cycles[bus] = begin_cycle(bus);
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) read_bus(bus, cycles[bus]);
  for (std::size_t joint = 0; joint < nodes_.size(); ++joint) {
    DriveNode& node = *nodes_[joint];
    [[maybe_unused]] const unsigned missed = node.state().missed;
    node.supervise(*configuration_, cycles[node.bus()].sync_sent, now);
#ifndef ARMSIG_SMALL_IMAGE
    if (node.state().missed > missed) ++buses_[node.bus()].counters.unanswered;
#endif
    positions_[joint] = nodes_[joint]->drive().state().position;
  }
  group_.supervise(now);
  release_drives();
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) {
    if (cycles[bus].state == hal::CanState::kDown) return std::unexpected(Error::kBusDown);
    if (cycles[bus].state == hal::CanState::kBusOff) return std::unexpected(Error::kBusOff);
  }
  return {};
}

Master::Cycle Master::begin_cycle(BusNumber bus) {
  Bus& own = buses_[bus];
  Cycle cycle{.state = own.can->status().state};
  bool any_started = false;
  for (const auto& node : nodes_) {
    any_started = any_started || (node->bus() == bus && node->is_started());
  }
  cycle.sync_sent = cycle.is_usable() && any_started && own.send(sync_frame()).has_value();
  if constexpr (kMostBuses > 1) own.usable = cycle.is_usable();
  return cycle;
}

void Master::read_bus(BusNumber bus, const Cycle& cycle) {
  for (unsigned taken = 0; taken < kMaxFramesPerTick; ++taken) {
    const auto received = buses_[bus].can->receive();
    if (!received) break;
    take(with_plausible_stamp(*received), bus);
  }
  if (cycle.is_usable()) return;
  latch_started(cycle.state == hal::CanState::kDown ? Error::kBusDown : Error::kBusOff, bus);
}

hal::DriveStatus Master::with_bus(const DriveNode& drive) const {
  hal::DriveStatus status = drive.status();
  if (status.fault == Error::kSecondMaster) {
    status.words = buses_[second_master_on_].name;
    return status;
  }
  const Bus& own = buses_[drive.bus()];
  const bool of_bus = status.fault
                          ? status.fault == Error::kBusDown || status.fault == Error::kBusOff ||
                                status.fault == Error::kBusBusy
                          : !own.usable;
  if (of_bus && bus_count() > 1) status.words = own.name;
  return status;
}

void Master::latch_started(Error error, BusNumber bus) {
  for (auto& node : nodes_) {
    if (node->is_started() && node->bus() == bus) node->drive().latch(error);
  }
}

void Master::latch_second_master(BusNumber bus) {
  ++buses_[bus].counters.foreign;
  if constexpr (kMostBuses > 1) {
    const bool is_first = std::ranges::none_of(nodes_, [](const auto& node) {
      return node->drive().state().fault == Error::kSecondMaster;
    });
    if (is_first) second_master_on_ = bus;
  }
  group_.latch_all(Error::kSecondMaster);
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

void Master::take(const hal::ReceivedCanFrame& received, BusNumber bus) {
  const hal::CanFrame& frame = received.frame;
  MasterCounters& counters = buses_[bus].counters;
  if (frame.extended || frame.remote) {
    ++counters.unknown;
    return;
  }
  const std::uint32_t function = frame.id & kFunctionMask;
  const auto node = static_cast<NodeId>(frame.id & kNodeMask);
  if (frame.id == kNmtId && !is_about_ours(frame, bus)) {
    ++counters.unknown;
    return;
  }
  const bool is_masters = frame.id == kNmtId || frame.id == kSyncId ||
                          (function == kHeartbeatId && node == configuration_->master_node);
  if (is_masters) {
    latch_second_master(bus);
    return;
  }
  for (auto& drive : nodes_) {
    if (!drive->is_at(bus, node)) continue;
    take_of_drive(*drive, received);
    return;
  }
  take_of_other(received, bus);
}

void Master::count_frame([[maybe_unused]] const DriveNode& drive,
                         [[maybe_unused]] const hal::CanFrame& frame) {
#ifndef ARMSIG_SMALL_IMAGE
  const std::uint32_t function = frame.id & kFunctionMask;
  if (function == kHeartbeatId && drive.is_started() &&
      now_ - drive.state().heard_at > 2 * configuration_->heartbeat) {
    ++buses_[drive.bus()].counters.late_heartbeats;
  }
  if (function != kEmergencyId) return;
  const auto emergency = decode_emergency(frame);
  if (emergency && emergency->code != 0) ++buses_[drive.bus()].counters.emergencies;
#endif
}

void Master::take_of_drive(DriveNode& drive, const hal::ReceivedCanFrame& received) {
  if constexpr (!hal::kSmallImage) count_frame(drive, received.frame);
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
  if (!well_formed) ++buses_[drive.bus()].counters.malformed;
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
      latch_second_master(drive.bus());
    }
  });
  if (!known) ++buses_[drive.bus()].counters.unknown;
  return well_formed;
}

void Master::take_of_other(const hal::ReceivedCanFrame& received, BusNumber bus) {
  const hal::CanFrame& frame = received.frame;
  const auto& others = configuration_->others[bus].nodes;
  for (std::size_t i = 0; i < others.size(); ++i) {
    // A device that says it is not operational is started (again).
    if (frame.id == kHeartbeatId + others[i] && frame.length == 1 &&
        static_cast<NmtState>(frame.data[0] & 0x7FU) != NmtState::kOperational) {
      buses_[bus].other_needs_start[i] = true;
    }
  }
  const bool is_sinks = kMostBuses == 1 || bus == configuration_->buses.sink;
  if (other_frames_ != nullptr && is_sinks) {
    other_frames_->take(received);
  } else {
    ++buses_[bus].counters.unknown;
  }
}

Result<void> Master::do_write(const JointVector& targets, hal::Instant now) {
  now_ = now;
  Result<void> result = group_.set_targets(targets, now);
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) begin_write(bus, now);
  step_setup();
  step_mode_inquiry();
  if constexpr (hal::kMayHome) step_homing();
  for (auto& node : nodes_) {
    if (node->state().phase != Phase::kRunning) continue;  // no position to hold is known yet
    const auto sent = buses_[node->bus()].send(node->command(group_.may_release()));
    if (sent) continue;
    if (result) result = sent;
    // An interface that fails between reading and writing is named by its joints.
    if constexpr (kMostBuses > 1) {
      if (sent.error() != Error::kBusBusy) latch_started(sent.error(), node->bus());
    }
  }
  for (std::uint8_t bus = 0; bus < bus_count(); ++bus) end_write(bus);
  return result;
}

void Master::begin_write(BusNumber bus, hal::Instant now) {
  Bus& own = buses_[bus];
  own.busy_now = false;
  if (!own.heartbeat_at || now - *own.heartbeat_at >= configuration_->heartbeat) {
    if (own.send(heartbeat_frame(configuration_->master_node, NmtState::kOperational))) {
      own.heartbeat_at = now;
    }
    if constexpr (cia402::kMostAxes > 1) {
      send_guarding(bus);
    } else {
      for (const auto& node : nodes_) {
        if (node->is_guarded()) (void)send_to(*node, guard_frame(node->node()));
      }
    }
  }
  step_others(bus);
}

void Master::end_write(BusNumber bus) {
  Bus& own = buses_[bus];
  own.busy_ticks = own.busy_now ? own.busy_ticks + 1 : 0;
  if (own.busy_ticks >= kBusBusyLimit) latch_started(Error::kBusBusy, bus);
}

// Once a node.
void Master::send_guarding(BusNumber bus) {
  for (auto& node : nodes_) {
    if (!node->is_guarded() || node->bus() != bus) continue;
    const DriveNode* first = nullptr;
    for_axes_of(*node, [&](DriveNode& axis) {
      if (first == nullptr && axis.is_guarded()) first = &axis;
    });
    if (first == &*node) (void)buses_[bus].send(guard_frame(node->node()));
  }
}

Result<void> Master::Bus::send(const hal::CanFrame& frame) {
  auto sent = can->send(frame);
  if (!sent) {
    ++counters.unsent;
    busy_now = busy_now || sent.error() == Error::kBusBusy;
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
