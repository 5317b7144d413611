// SPDX-License-Identifier: MIT
#include "hal/cia402/setup_run.hpp"

namespace armsig::cia402 {
namespace {

// Of 6007h: fault, disable voltage, quick stop.
constexpr std::uint32_t kFirstStop = 1;
constexpr std::uint32_t kLastStop = 3;

}  // namespace

void SetupRun::begin(const Setup& setup, const DriveSettings& settings) {
  setup_ = setup;
  settings_ = &settings;
  at_ = 0;
  stage_ = Stage::kRead;
  found_.reset();
  abort_ = 0;
  weighed_ = false;
  has_guard_time_ = false;
  factors_ = {};
  report_ = {};
}

bool SetupRun::reads_first() const {
  return is_option(setup_[at_].rule) || setup_[at_].rule == SetupRule::kSetting;
}

std::optional<ObjectRequest> SetupRun::request() const {
  if (at_ == setup_.size()) return std::nullopt;
  ObjectRequest request = setup_[at_].request;
  if (reads_first() && stage_ != Stage::kWrite) {
    request.bytes = 0;
    request.value = 0;
  }
  return request;
}

SetupRefusal SetupRun::refusal(Error error, std::uint32_t code) const {
  const SetupStep& step = setup_[at_];
  const bool writes = step.request.bytes != 0;
  return {.error = error,
          .code = code,
          .object = {.index = step.request.index,
                     .subindex = step.request.subindex,
                     .found = found_,
                     .wanted = writes ? step.request.value : step.expected}};
}

std::optional<SetupRefusal> SetupRun::take(const ObjectOutcome& outcome) {
  const SetupStep& step = setup_[at_];
  if (!outcome && outcome.error().error != Error::kSdoAborted) {
    return refusal(outcome.error().error, 0);
  }
  if (reads_first()) return take_setting(step, outcome);
  if (const auto error = judge(step, outcome)) {
    if (outcome) found_ = *outcome;
    return refusal(*error, outcome ? *outcome : outcome.error().abort_code);
  }
  take_factor(step.request, outcome, factors_);
  if (step.rule == SetupRule::kTold) {
    report_.hides_mode = (*outcome & step.mask) != step.expected;
  }
  return pass();
}

std::optional<SetupRefusal> SetupRun::take_setting(const SetupStep& step,
                                                   const ObjectOutcome& outcome) {
  switch (stage_) {
    case Stage::kRead:
      if (is_absent(outcome)) {
        if (!is_option(step.rule)) return refusal(Error::kSdoAborted, outcome.error().abort_code);
        report_.gaps.push_back(refusal(Error::kSdoAborted, 0).object);
        return pass();
      }
      if (outcome) found_ = *outcome;
      if (outcome && is_wanted(step, *outcome)) return settle(step);
      stage_ = Stage::kWrite;
      return std::nullopt;
    case Stage::kWrite:
      if (!outcome) {
        abort_ = outcome.error().abort_code;
        return settle(step);
      }
      found_ = step.request.value;
      if (step.rule == SetupRule::kSetting) return settle(step);
      stage_ = Stage::kVerify;
      return std::nullopt;
    case Stage::kVerify:
      if (outcome) found_ = *outcome;
      return settle(step);
  }
  return std::nullopt;
}

// Of a setting that is as the drive lets it be.
std::optional<SetupRefusal> SetupRun::settle(const SetupStep& step) {
  const std::uint32_t found = found_.value_or(0);
  if (!found_ || !is_wanted(step, found)) {
    const bool safe = found_ ? is_safe(step, found) : step.mask == kAnyValue;
    if (!safe || !is_option(step.rule)) {
      return abort_ != 0 ? refusal(Error::kSdoAborted, abort_)
                         : refusal(Error::kSdoUnexpectedValue, found);
    }
    report_.gaps.push_back(refusal(Error::kSdoAborted, 0).object);
  } else if (is_option(step.rule)) {
    note(object_of_first_axis(step.request.index));
  }
  if (object_of_first_axis(step.request.index) == kAbortConnectionOption) {
    report_.stops = found_ && found >= kFirstStop && found <= kLastStop;
  }
  return pass();
}

// An option is as wanted.
void SetupRun::note(std::uint16_t index) {
  switch (index) {
    case kHeartbeatConsumer:
    case kReceivePdoParameter:
      report_.watches = true;
      break;
    case kGuardTime:
      has_guard_time_ = true;
      break;
    case kLifeFactor:
      report_.guarded = has_guard_time_;
      report_.watches = has_guard_time_;
      break;
    default:
      break;
  }
}

std::optional<SetupRefusal> SetupRun::pass() {
  do {
    ++at_;
  } while (at_ < setup_.size() && setup_[at_].rule == SetupRule::kInstead && report_.watches);
  stage_ = Stage::kRead;
  found_.reset();
  abort_ = 0;
  return prepare();
}

// What depends on what the drive has told.
std::optional<SetupRefusal> SetupRun::prepare() {
  if (at_ == setup_.size()) return std::nullopt;
  ObjectRequest& request = setup_[at_].request;
  if (object_of_first_axis(request.index) == kQuickStopDeceleration) {
    const auto ramp = stop_ramp(factors_, settings_->stop_deceleration, settings_->scaling);
    if (!ramp) return refusal(ramp.error(), factors_.acceleration_unit);
    request.value = *ramp;
  }
  // A device that sends its heartbeat is not guarded (CiA 301, 7.2.8.2.2).
  if (request.index == kHeartbeatProducer && report_.guarded) request.value = 0;
  // Before anything is written.
  if (request.bytes != 0 && !weighed_) {
    weighed_ = true;
    if (auto object = contradicting_object(factors_, settings_->scaling)) {
      object->index = settings_->object(object->index);
      return SetupRefusal{.error = Error::kScaleInvalid, .code = object->index, .object = *object};
    }
  }
  return std::nullopt;
}

}  // namespace armsig::cia402
