// SPDX-License-Identifier: MIT
// The range sensor on the drives' bus: the servo thread receives its frames, the background's
// thread reads it.
#pragma once

#include "hal/canopen/range_sensor.hpp"
#include "hal/mailbox.hpp"

namespace armsig::daemon {

class CanSensor final : public hal::RangeSensor, public canopen::FrameSink {
 public:
  // Precondition: canopen::check(configuration).
  explicit CanSensor(const canopen::RangeNodeConfiguration& configuration)
      : sensor_(configuration) {}

 private:
  // Of the servo thread. What the background is too slow for is lost; the sensor then tells that a
  // reading is malformed, and the next one is whole again.
  void do_take(const hal::ReceivedCanFrame& received) override { (void)frames_.post(received); }

  // Of the background's thread.
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override {
    while (const auto frame = frames_.take()) sensor_.take(*frame);
    return sensor_.poll(now);
  }

  hal::Mailbox<hal::ReceivedCanFrame, 64> frames_;
  canopen::RangeSensor sensor_;
};

}  // namespace armsig::daemon
