// SPDX-License-Identifier: MIT
// How a master brings its drives from whatever they do when it begins to running: found at rest,
// reset, set up, started.
#include "hal/canopen/identity.hpp"
#include "hal/canopen/master.hpp"

namespace armsig::canopen {

void Master::step_others() {
  const auto& others = configuration_->other_nodes;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (other_needs_start_[i] && send(nmt_frame(NmtCommand::kStart, others[i]))) {
      other_needs_start_[i] = false;
    }
  }
}

void Master::take_answer(const DriveNode& drive, const hal::CanFrame& frame) {
  for (std::size_t joint = 0; joint < inquiries_.size(); ++joint) {
    if (inquiries_[joint] && nodes_[joint]->node() == drive.node()) inquiries_[joint]->take(frame);
  }
  if (transfer_ && setup_joint_ && nodes_[*setup_joint_]->node() == drive.node()) {
    transfer_->take(frame);
  }
}

bool Master::step_inquiries() {
  if (inquiries_.empty()) return false;
  bool over = true;
  for (auto& inquiry : inquiries_) {
    const auto question = inquiry->poll(now_);
    if (question && !send(*question)) {
      inquiry->begin();  // the bus takes nothing
    } else if (question && !inquiring_since_) {
      inquiring_since_ = now_;
    }
    over = over && inquiry->is_over();
  }
  const bool too_long = inquiring_since_ && now_ - *inquiring_since_ > configuration_->stop_timeout;
  if (over || too_long) inquiries_.clear();
  return !inquiries_.empty();
}

// Every drive at once, so that they boot side by side.
void Master::reset_drives() {
  for (auto& node : nodes_) {
    if (node->state().phase == Phase::kUnreset &&
        send(nmt_frame(NmtCommand::kResetCommunication, node->node()))) {
      node->enter(Phase::kBooting, now_);
    }
  }
}

void Master::step_setup() {
  if (step_inquiries()) return;
  reset_drives();
  for (auto& node : nodes_) {
    if (node->state().phase == Phase::kBooting &&
        now_ - node->state().phase_since > configuration_->boot_timeout) {
      fail_setup(*node, Error::kDriveAbsent, 0);
    }
  }
  if (setup_joint_ && nodes_[*setup_joint_]->state().phase != Phase::kConfiguring) {
    setup_joint_.reset();  // reset by the operator, or restarted, in the middle of it
    transfer_.reset();
  }
  for (std::size_t joint = 0; joint < nodes_.size() && !setup_joint_; ++joint) {
    if (nodes_[joint]->state().phase != Phase::kBooted) continue;
    setup_joint_ = joint;
    setup_ = drive_setup(configuration_, joint);
    setup_step_ = 0;
    identities_[joint] = identity_of(configuration_->axes[joint]);
    factors_ = {};
    transfer_.reset();
    nodes_[joint]->enter(Phase::kConfiguring, now_);
  }
  if (setup_joint_) step_requests(*nodes_[*setup_joint_]);
}

void Master::step_requests(DriveNode& drive) {
  if (drive.drive().state().fault) {  // does not stay up
    fail_setup(drive, *drive.drive().state().fault, 0);
    return;
  }
  if (transfer_ && transfer_->outcome()) {
    const cia402::SetupStep& step = setup_[setup_step_];
    const auto error = cia402::judge(step, *transfer_->outcome());
    const bool may_wait = step.rule == cia402::SetupRule::kWaitsEqual &&
                          error == Error::kSdoUnexpectedValue &&
                          now_ - drive.state().phase_since <= configuration_->boot_timeout;
    if (error && !may_wait) {
      const SdoOutcome& outcome = *transfer_->outcome();
      fail_setup(drive, *error, outcome ? *outcome : outcome.error().abort_code);
      return;
    }
    if (!error) {
      take_identity(step.request, *transfer_->outcome(), identities_[*setup_joint_]);
      cia402::take_factor(step.request, *transfer_->outcome(), factors_);
      ++setup_step_;
    }
    transfer_.reset();
  }
  if (setup_step_ == setup_.size()) {
    finish_setup(drive);
    return;
  }
  if (!transfer_) {
    transfer_.emplace(drive.node(), setup_[setup_step_].request, configuration_->sdo_timeout,
                      configuration_->sdo_attempts);
  }
  // A request that the bus does not take is as good as lost: it is repeated after the time-out.
  if (const auto request = transfer_->poll(now_)) (void)send(*request);
}

void Master::finish_setup(DriveNode& drive) {
  const auto object =
      cia402::contradicting_object(factors_, configuration_->axes[*setup_joint_].scaling);
  if (object) {
    fail_setup(drive, Error::kScaleInvalid, *object);
  } else if (send(nmt_frame(NmtCommand::kStart, drive.node()))) {
    drive.enter(Phase::kStarted, now_);
    setup_joint_.reset();
  }
}

void Master::fail_setup(DriveNode& drive, Error error, std::uint32_t code) {
  drive.drive().latch(error, code);
  drive.enter(Phase::kFailed, now_);
  if (setup_joint_ && &*nodes_[*setup_joint_] == &drive) {
    setup_joint_.reset();
    transfer_.reset();
  }
}

}  // namespace armsig::canopen
