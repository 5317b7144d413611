// SPDX-License-Identifier: MIT
// Before its first reset a drive may still be moving: its former master was killed a moment ago, or
// another one runs it. A reset would take its torque in mid-ramp. So it is asked, by SDO, which
// needs no PDO and no NMT state of ours: its statusword (6041h); where it has torque, it is told to
// stop on its quick stop ramp (6040h), and its position (6064h) is asked for until it stands.
#pragma once

#include <optional>

#include "hal/canopen/configuration.hpp"
#include "hal/canopen/sdo_client.hpp"

namespace armsig::canopen {

class RestInquiry {
 public:
  // An answer is waited for once, for `timeout`: who does not answer is not there, or is booting.
  RestInquiry(const AxisConfiguration& axis, const cia402::Scaling& scaling, hal::Duration timeout);

  // From the first question on, as if nothing had been sent yet.
  void begin() { ask(Question::kStatus); }
  // Takes a frame with the identifier of this node's SDO responses.
  void take(const hal::CanFrame& frame);
  // The frame to send now, if there is one.
  [[nodiscard]] std::optional<hal::CanFrame> poll(hal::Instant now);
  // The drive may be reset as far as it is concerned: it does not answer, has no torque, or stands.
  [[nodiscard]] bool is_over() const { return question_ == Question::kNone; }

 private:
  enum class Question : std::uint8_t { kStatus, kStop, kPosition, kNone };

  void ask(Question question);
  void hear(const SdoOutcome& outcome, hal::Instant now);
  void hear_position(std::int32_t counts, hal::Instant now);

  NodeId node_;
  cia402::Scaling scaling_;
  hal::Duration timeout_;
  double tolerance_;
  Question question_ = Question::kStatus;
  std::optional<SdoTransfer> transfer_;
  std::optional<double> rest_position_;
  hal::Instant moved_at_;
};

}  // namespace armsig::canopen
