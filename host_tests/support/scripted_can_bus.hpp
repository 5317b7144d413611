// SPDX-License-Identifier: MIT
// A CAN bus that expects a script: frames that must be sent, in order, each with canned replies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/can_bus.hpp"

namespace armsig::test {

// A data frame in the notation of the can-utils: frame("601#2300140101020080").
inline hal::CanFrame frame(const std::string& text) {
  const std::size_t hash = text.find('#');
  hal::CanFrame result{
      .id = static_cast<std::uint32_t>(std::stoul(text.substr(0, hash), nullptr, 16))};
  for (std::size_t at = hash + 1; at + 1 < text.size(); at += 2) {
    result.data[result.length++] =
        static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16));
  }
  return result;
}

inline std::string text(const hal::CanFrame& frame) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%03X#", static_cast<unsigned>(frame.id));
  std::string result = buffer;
  for (unsigned i = 0; i < frame.length; ++i) {
    std::snprintf(buffer, sizeof buffer, "%02X", static_cast<unsigned>(frame.data[i]));
    result += buffer;
  }
  return result;
}

class ScriptedCanBus final : public hal::CanBus {
 public:
  // The next frame sent must be `sent`; `replies` can be received after it.
  void expect(const std::string& sent, std::initializer_list<const char*> replies = {}) {
    steps_.push_back({sent, {replies.begin(), replies.end()}});
  }
  // A frame that arrives by itself.
  void bring(const std::string& received) { bring(frame(received)); }
  void bring(const hal::CanFrame& received) { waiting_.push_back(received); }

  // What has `sent` as its frame in the script is answered by `reply` instead.
  void replace(const std::string& sent, const char* reply) {
    for (Step& step : steps_) {
      if (step.sent == sent) step.replies = {reply};
    }
  }

  // What was expected last is not.
  void leave_out_last() { steps_.pop_back(); }

  // The frames sent in excess of the script, and the steps that were not sent, as a failure.
  void expect_all_consumed() {
    EXPECT_TRUE(steps_.empty()) << "not sent: " << steps_.front().sent;
    EXPECT_TRUE(waiting_.empty()) << "not received: " << text(waiting_.front());
  }
  // What sending and status() say from now on.
  void set_state(hal::CanState state) { state_ = state; }
  void set_full(bool full) { full_ = full; }
  // Stamps of frames received, and by how much they are off.
  hal::Instant now;
  hal::Duration stamp_error{};

 private:
  struct Step {
    std::string sent;
    std::vector<std::string> replies;
  };

  Result<void> do_send(const hal::CanFrame& sent) override {
    if (state_ == hal::CanState::kDown) return std::unexpected(Error::kBusDown);
    if (state_ == hal::CanState::kBusOff) return std::unexpected(Error::kBusOff);
    if (full_) return std::unexpected(Error::kBusBusy);
    if (steps_.empty()) {
      ADD_FAILURE() << "sent beyond the script: " << text(sent);
      return {};
    }
    EXPECT_EQ(text(sent), steps_.front().sent);
    for (const std::string& reply : steps_.front().replies) waiting_.push_back(frame(reply));
    steps_.pop_front();
    return {};
  }
  std::optional<hal::ReceivedCanFrame> do_receive() override {
    if (waiting_.empty()) return std::nullopt;
    const hal::CanFrame received = waiting_.front();
    waiting_.pop_front();
    return hal::ReceivedCanFrame{received, now + stamp_error};
  }
  hal::CanStatus do_status() override { return {.state = state_}; }

  std::deque<Step> steps_;
  std::deque<hal::CanFrame> waiting_;
  hal::CanState state_ = hal::CanState::kActive;
  bool full_ = false;
};

}  // namespace armsig::test
