// SPDX-License-Identifier: MIT
#include "hal/canopen/rest_inquiry.hpp"

#include <cmath>

#include "hal/cia402/standstill.hpp"
#include "hal/cia402/state_machine.hpp"

namespace armsig::canopen {
namespace {

using cia402::State;

constexpr SdoRequest kStatusWord{.index = cia402::kStatusWord};
constexpr SdoRequest kQuickStop{.index = cia402::kControlWord,
                                .bytes = 2,
                                .value = cia402::control_word(cia402::Command::kQuickStop)};
constexpr SdoRequest kActualPosition{.index = cia402::kActualPosition};

SdoRequest of_axis(std::uint8_t axis, const SdoRequest& request) {
  if constexpr (cia402::kMostAxes == 1) return request;
  SdoRequest moved = request;
  moved.index = cia402::object_of_axis(axis, request.index);
  return moved;
}

}  // namespace

RestInquiry::RestInquiry(const AxisConfiguration& axis, const cia402::Scaling& scaling,
                         hal::Duration timeout)
    : node_(axis.node),
      axis_(axis.axis),
      scaling_(scaling),
      timeout_(timeout),
      tolerance_(cia402::rest_tolerance(axis.scaling.type, scaling)) {
  begin();
}

void RestInquiry::ask(Question question) {
  question_ = question;
  transfer_.reset();
  turn_.end();
  const auto begin = [&](const SdoRequest& request) {
    transfer_.emplace(node_, of_axis(axis_, request), timeout_, 1U);
  };
  if (question == Question::kStatus) begin(kStatusWord);
  if (question == Question::kStop) begin(kQuickStop);
  if (question == Question::kPosition) begin(kActualPosition);
}

void RestInquiry::take(const hal::CanFrame& frame) {
  if (transfer_) transfer_->take(frame);
}

std::optional<hal::CanFrame> RestInquiry::poll(hal::Instant now) {
  if (!transfer_) return std::nullopt;
  if (const auto& outcome = transfer_->outcome()) hear(SdoOutcome(*outcome), now);
  if (!transfer_) return std::nullopt;
  if (turn_.is_waiting()) return std::nullopt;
  const auto frame = transfer_->poll(now);
  if (frame) turn_.take(now);
  if (transfer_->outcome()) ask(Question::kNone);  // no answer
  return frame;
}

void RestInquiry::hear(const SdoOutcome& outcome, hal::Instant now) {
  // A drive that refuses to be stopped this way stops when its master's heartbeat is gone: whether
  // it stands is asked all the same.
  if (question_ == Question::kStop) {
    ask(Question::kPosition);
    return;
  }
  if (!outcome) {
    ask(Question::kNone);
    return;
  }
  if (question_ == Question::kPosition) {
    hear_position(static_cast<std::int32_t>(*outcome), now);
    return;
  }
  const State state = cia402::decode_state(static_cast<std::uint16_t>(*outcome));
  if (state == State::kOperationEnabled) {
    ask(Question::kStop);
  } else {
    ask(cia402::has_torque(state) ? Question::kPosition : Question::kNone);
  }
}

void RestInquiry::hear_position(std::int32_t counts, hal::Instant now) {
  const double position = scaling_.reading(counts);
  if (!rest_position_ || std::fabs(position - *rest_position_) > tolerance_) {
    rest_position_ = position;
    moved_at_ = now;
  }
  ask(now - moved_at_ >= cia402::kRestTime ? Question::kNone : Question::kPosition);
}

}  // namespace armsig::canopen
