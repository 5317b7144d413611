// SPDX-License-Identifier: MIT
// Before its first reset a drive may still be moving: its former master was killed a moment ago, or
// another one runs it. A reset would take its torque in mid-ramp. So it is asked, by SDO, which
// needs no PDO and no NMT state of ours: its statusword (6041h); where it has torque, it is told to
// stop on its quick stop ramp (6040h), and its position (6064h) is asked for until it stands.
#pragma once

#include <optional>
#include <type_traits>

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
  // Whether poll() may begin a question: a device answers one at a time, of all its axes.
  void let_ask(bool may_ask) { turn_.let_take(may_ask); }
  // The drive may be reset as far as it is concerned: it does not answer, has no torque, or stands.
  [[nodiscard]] bool is_over() const { return question_ == Question::kNone; }
  // It lets `other`, about another axis of its node, ask first: that has asked less lately, or is
  // waiting for an answer.
  [[nodiscard]] bool yields_to(const RestInquiry& other) const {
    return other.is_asking() || other.turn_.asked_at() < turn_.asked_at();
  }

 private:
  enum class Question : std::uint8_t { kStatus, kStop, kPosition, kNone };

  void ask(Question question);
  void hear(const SdoOutcome& outcome, hal::Instant now);
  void hear_position(std::int32_t counts, hal::Instant now);

  // Where a node has one axis, nobody waits for a turn.
  class NoTurn {
   public:
    void let_take(bool /*may_take*/) {}
    void end() {}
    void take(hal::Instant /*now*/) {}
    [[nodiscard]] static bool is_taken() { return false; }
    [[nodiscard]] static bool is_waiting() { return false; }
    [[nodiscard]] static hal::Instant asked_at() { return {}; }
  };
  class Turn {
   public:
    void let_take(bool may_take) { may_take_ = may_take; }
    void end() { taken_ = false; }
    void take(hal::Instant now) {
      taken_ = true;
      asked_at_ = now;
    }
    [[nodiscard]] bool is_taken() const { return taken_; }
    [[nodiscard]] bool is_waiting() const { return !taken_ && !may_take_; }
    [[nodiscard]] hal::Instant asked_at() const { return asked_at_; }

   private:
    bool may_take_ = true;
    bool taken_ = false;
    hal::Instant asked_at_;  // before the first question the beginning of all time
  };

  // A question is sent and not answered.
  [[nodiscard]] bool is_asking() const {
    return turn_.is_taken() && transfer_ && !transfer_->outcome();
  }

  NodeId node_;
  [[no_unique_address]] hal::AxisNumber axis_;
  [[no_unique_address]] std::conditional_t<(cia402::kMostAxes > 1), Turn, NoTurn> turn_;
  cia402::Scaling scaling_;
  hal::Duration timeout_;
  double tolerance_;
  Question question_ = Question::kStatus;
  std::optional<SdoTransfer> transfer_;
  std::optional<double> rest_position_;
  hal::Instant moved_at_;
};

}  // namespace armsig::canopen
