// SPDX-License-Identifier: MIT
// How a master brings its drives from whatever they do when it begins to running: found at rest,
// reset, set up, started.
#include "hal/canopen/identity.hpp"
#include "hal/canopen/master.hpp"

namespace armsig::canopen {

void Master::step_others(BusNumber bus) {
  const auto& others = configuration_->others[bus].nodes;
  Bus& own = buses_[bus];
  for (std::size_t i = 0; i < others.size(); ++i) {
    bool& needs_start = own.other_needs_start[i];
    if (needs_start && own.send(nmt_frame(NmtCommand::kStart, others[i]))) needs_start = false;
  }
}

void Master::take_answer(const DriveNode& drive, const hal::CanFrame& frame) {
  for (std::size_t joint = 0; joint < inquiries_.size(); ++joint) {
    if (inquiries_[joint] && nodes_[joint]->shares_node(drive)) inquiries_[joint]->take(frame);
  }
  if (transfer_ && setup_joint_ && nodes_[*setup_joint_]->shares_node(drive)) {
    transfer_->take(frame);
  }
  if (mode_inquiry_ && nodes_[*mode_joint_]->shares_node(drive)) mode_inquiry_->take(frame);
  if constexpr (hal::kMayHome) {
    if (homing_ && nodes_[homing_->joint()]->shares_node(drive)) homing_->take(frame);
  }
}

bool Master::step_inquiries() {
  if (inquiries_.empty()) return false;
  bool over = true;
  for (std::size_t joint = 0; joint < inquiries_.size(); ++joint) {
    auto& inquiry = inquiries_[joint];
    if (!inquiry) continue;
    if constexpr (cia402::kMostAxes > 1) inquiry->let_ask(may_ask(joint));
    const auto question = inquiry->poll(now_);
    if (question && !send_to(*nodes_[joint], *question)) {
      inquiry->begin();  // the bus takes nothing
      if (kMostBuses > 1 && !buses_[nodes_[joint]->bus()].usable) inquiring_since_.reset();
    } else if (question && !inquiring_since_) {
      inquiring_since_ = now_;
    }
    over = over && inquiry->is_over();
  }
  const bool too_long = inquiring_since_ && now_ - *inquiring_since_ > configuration_->stop_timeout;
  if (over || too_long) inquiries_.clear();
  return !inquiries_.empty();
}

bool Master::may_ask(std::size_t joint) const {
  const RestInquiry& own = *inquiries_[joint];
  for (std::size_t other = 0; other < inquiries_.size(); ++other) {
    const auto& inquiry = inquiries_[other];
    if (!inquiry || other == joint || inquiry->is_over()) continue;
    if (!configuration_->axes[other].shares_node(configuration_->axes[joint])) continue;
    const bool in_order = other < joint && !inquiry->yields_to(own);
    if (in_order || own.yields_to(*inquiry)) return false;
  }
  return true;
}

// Every drive at once, so that they boot side by side.
void Master::reset_drives() {
  for (auto& node : nodes_) {
    if (node->state().phase == Phase::kUnreset &&
        (cia402::kMostAxes == 1 || all_await_reset(*node)) &&
        send_to(*node, nmt_frame(NmtCommand::kResetCommunication, node->node()))) {
      for_axes_of(*node, [&](DriveNode& axis) { axis.enter(Phase::kBooting, now_); });
    }
  }
}

// The reset of a node takes the torque of all its axes.
bool Master::all_await_reset(DriveNode& drive) {
  bool all = true;
  for_axes_of(drive, [&](DriveNode& axis) { all = all && axis.state().phase == Phase::kUnreset; });
  return all;
}

// An axis that is to be set up anew takes the others of its node with it.
void Master::reset_whole_nodes() {
  for (auto& node : nodes_) {
    if (!node->awaits_reset()) continue;
    for_axes_of(*node, [&](DriveNode& axis) { axis.reset_with_node(now_); });
  }
}

// A command of the network management, of another master: to all nodes, or to one of this arm.
bool Master::is_about_ours(const hal::CanFrame& nmt, BusNumber bus) const {
  const auto node = static_cast<NodeId>(nmt.data[1]);
  bool ours = nmt.length != 2 || node == 0;
  for (const auto& drive : nodes_) ours = ours || drive->is_at(bus, node);
  for (const NodeId other : configuration_->others[bus].nodes) ours = ours || other == node;
  return ours;
}

// A drive that did not answer is looked for again and again, from the question whether it stands
// on.
void Master::look_again() {
  if (!inquiries_.empty()) return;
  for (std::size_t joint = 0; joint < nodes_.size(); ++joint) {
    DriveNode& node = *nodes_[joint];
    const bool absent = node.state().phase == Phase::kFailed &&
                        node.drive().state().fault == Error::kDriveAbsent &&
                        now_ - node.state().phase_since > configuration_->boot_timeout;
    if (!absent) continue;
    node.look_again(now_);
    if (inquiries_.empty()) inquiries_.resize(nodes_.size());
    inquiries_[joint].emplace(configuration_->axes[joint], configuration_.scaling(joint),
                              configuration_->sdo_timeout);
    inquiring_since_.reset();
  }
}

void Master::step_setup() {
  if constexpr (!hal::kSmallImage) look_again();
  if (step_inquiries()) return;
  reset_drives();
  for (auto& node : nodes_) {
    if (node->state().phase == Phase::kBooting &&
        now_ - node->state().phase_since > configuration_->boot_timeout) {
      wait_for_boot_up(*node);
    }
  }
  if (setup_joint_ && nodes_[*setup_joint_]->state().phase != Phase::kConfiguring) {
    setup_joint_.reset();  // reset by the operator, or restarted, in the middle of it
    transfer_.reset();
  }
  for (std::size_t joint = 0; joint < nodes_.size() && !setup_joint_; ++joint) {
    if (nodes_[joint]->state().phase != Phase::kBooted) continue;
    setup_joint_ = joint;
    setup_.begin(drive_setup(configuration_, joint), configuration_->axes[joint]);
    identities_[joint] = identity_of(configuration_->axes[joint]);
    transfer_.reset();
    nodes_[joint]->enter(Phase::kConfiguring, now_);
  }
  if (setup_joint_) step_requests(*nodes_[*setup_joint_]);
  if constexpr (cia402::kMostAxes > 1) start_configured();
}

// Some drives tell that they booted after a reset of the whole node alone. It is without torque, or
// stands, as before the first reset.
void Master::wait_for_boot_up(DriveNode& drive) {
  if (!drive.may_be_wholly_reset()) {
    fail_setup(drive, {.error = Error::kDriveAbsent, .code = 0, .object = {}});
  } else if (send_to(drive, nmt_frame(NmtCommand::kResetNode, drive.node()))) {
    for_axes_of(drive, [&](DriveNode& axis) { axis.wait_for_whole_reset(now_); });
  }
}

void Master::step_requests(DriveNode& drive) {
  if (drive.drive().state().fault) {  // does not stay up
    fail_setup(drive, {.error = *drive.drive().state().fault, .code = 0, .object = {}});
    return;
  }
  if (transfer_ && transfer_->outcome()) {
    take_setup_answer(drive, SdoOutcome(*transfer_->outcome()));
    if (drive.state().phase != Phase::kConfiguring) return;
  }
  const auto next = setup_.request();
  if (!next) {
    finish_setup(drive);
    return;
  }
  if (!transfer_) {
    transfer_.emplace(drive.node(), *next, configuration_->sdo_timeout,
                      configuration_->sdo_attempts);
  }
  // A request that the bus does not take is as good as lost: it is repeated after the time-out.
  [[maybe_unused]] const bool repeats = transfer_->was_sent();
  const auto request = transfer_->poll(now_);
  if (!request) return;
  (void)send_to(drive, *request);
#ifndef ARMSIG_SMALL_IMAGE
  if (repeats) ++buses_[drive.bus()].counters.repeated;
#endif
}

void Master::take_setup_answer(DriveNode& drive, const SdoOutcome& outcome) {
  take_identity(*setup_.request(), outcome, identities_[*setup_joint_]);
  transfer_.reset();
  if (const auto refusal = setup_.take(outcome)) fail_setup(drive, *refusal);
}

void Master::finish_setup(DriveNode& drive) {
  constexpr bool kAlone = cia402::kMostAxes == 1;
  if (kAlone && !send_to(drive, nmt_frame(NmtCommand::kStart, drive.node()))) return;
  reports_[*setup_joint_] = setup_.report();
  drive.enter_set_up(setup_.report(), now_);
  setup_joint_.reset();
}

// Nodes of which no axis is still to be set up. An axis that was refused does not keep the others
// from telling where they are.
void Master::start_configured() {
  for (auto& node : nodes_) {
    if (node->state().phase != Phase::kConfigured) continue;
    bool ready = true;
    for_axes_of(
        *node, [&](DriveNode& axis) { ready = ready && axis.state().phase >= Phase::kConfigured; });
    if (!ready || !send_to(*node, nmt_frame(NmtCommand::kStart, node->node()))) continue;
    for_axes_of(*node, [&](DriveNode& axis) {
      if (axis.state().phase == Phase::kConfigured) axis.enter(Phase::kStarted, now_);
    });
  }
}

void Master::fail_setup(DriveNode& drive, const cia402::SetupRefusal& refusal) {
  drive.drive().latch(refusal.error, refusal.code, refusal.object);
  drive.enter(Phase::kFailed, now_);
  if (setup_joint_ && &*nodes_[*setup_joint_] == &drive) {
    setup_joint_.reset();
    transfer_.reset();
  }
}

void Master::step_mode_inquiry() {
  for (std::size_t joint = 0; joint < nodes_.size() && !mode_joint_; ++joint) {
    if (nodes_[joint]->drive().awaits_mode()) mode_joint_ = joint;
  }
  if (!mode_joint_) return;
  DriveNode& drive = *nodes_[*mode_joint_];
  if (mode_inquiry_ && mode_inquiry_->outcome()) {
    take_mode(drive, SdoOutcome(*mode_inquiry_->outcome()));
    mode_inquiry_.reset();
  }
  if (!drive.drive().awaits_mode()) {
    mode_joint_.reset();
    mode_inquiry_.reset();
    return;
  }
  if (!mode_inquiry_) {
    mode_inquiry_.emplace(drive.node(), SdoRequest{.index = drive.object(cia402::kModeDisplay)},
                          configuration_->sdo_timeout, 1U);
  }
  if (const auto request = mode_inquiry_->poll(now_)) (void)send_to(drive, *request);
}

void Master::step_homing() {
  if constexpr (hal::kMayHome) {
    if (!homing_) return;
    cia402::Drive& drive = nodes_[homing_->joint()]->drive();
    const bool forgotten = drive.state().homing == cia402::Homing::kNone;  // it is set up anew
    const auto request = forgotten ? std::nullopt : homing_->poll(drive, now_);
    if (request) (void)send_to(*nodes_[homing_->joint()], *request);
    if (forgotten || homing_->is_over()) homing_.reset();
  }
}

void Master::take_mode(DriveNode& drive, const SdoOutcome& outcome) {
  constexpr std::uint32_t kMode = 0xFF;
  const auto wanted =
      static_cast<std::uint32_t>(configuration_->axes[*mode_joint_].position_mode());
  if (outcome && (*outcome & kMode) == wanted) {
    drive.drive().show_mode();
  } else if (now_ - drive.drive().state().progress_at > configuration_->transition_timeout) {
    hal::DeviceObject object{
        .index = drive.object(cia402::kModeDisplay), .subindex = 0, .found = {}, .wanted = wanted};
    if (outcome) object.found = *outcome;
    drive.drive().latch(outcome ? Error::kSdoUnexpectedValue : outcome.error().error,
                        outcome ? *outcome : outcome.error().abort_code, object);
  }
}

}  // namespace armsig::canopen
