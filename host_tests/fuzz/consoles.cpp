// SPDX-License-Identifier: MIT
// What an operator, or whoever holds his line, may send: requests to a controller whose drives are
// ideal, bytes to the serial line of a whole cabinet, keys to the line editor of `armsig connect`.
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "firmware/host_tool/console/conversation.hpp"
#include "firmware/host_tool/console/status_words.hpp"
#include "hal/serial_console.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::fuzz {
namespace {

using hal::DriveCondition;

// Drives that are where they are told to be, at once.
class IdealDrives final : public hal::JointDrives {
 public:
  IdealDrives(const JointVector& start, const FixedVector<JointLimits, kMaxJoints>& limits)
      : positions_(start), steps_(start.size()), limits_(limits) {}

 private:
  [[nodiscard]] std::size_t do_count() const override { return positions_.size(); }
  Result<void> do_read(hal::Instant /*now*/) override { return {}; }
  [[nodiscard]] const JointVector& do_positions() const override { return positions_; }
  [[nodiscard]] hal::DriveStatus do_status(std::size_t /*joint*/) const override {
    hal::DriveStatus status;
    status.condition = condition_;
    status.has_torque = condition_ == DriveCondition::kEnabled;
    status.has_position = true;
    return status;
  }
  Result<void> do_write(const JointVector& targets, hal::Instant /*now*/) override {
    for (std::size_t i = 0; i < targets.size(); ++i) {
      FUZZ_CHECK(std::isfinite(targets[i]));
      const double step = targets[i] - positions_[i];
      const double growth = step - std::exchange(steps_[i], 0);
      if (condition_ != DriveCondition::kEnabled) continue;
      FUZZ_CHECK(targets[i] >= limits_[i].lower - 1e-9 && targets[i] <= limits_[i].upper + 1e-9);
      // 1 rad/s and 3 rad/s2 are the limits of test::puma_controller, a tick 2 ms; the inverse
      // meets a pose within 1e-10.
      FUZZ_CHECK(std::fabs(step) <= 0.002 + 1e-9);
      FUZZ_CHECK(std::fabs(growth) <= 3 * 0.002 * 0.002 + 4e-9);
      steps_[i] = step;
    }
    if (condition_ == DriveCondition::kEnabled) positions_ = targets;
    return {};
  }
  Result<void> do_enable() override {
    condition_ = DriveCondition::kEnabled;
    return {};
  }
  void do_disable() override { condition_ = DriveCondition::kDisabled; }
  void do_quick_stop() override {
    if (condition_ == DriveCondition::kEnabled) condition_ = DriveCondition::kStopped;
  }
  void do_reset_faults() override { condition_ = DriveCondition::kDisabled; }

  JointVector positions_;
  JointVector steps_;  // to them, in the last tick
  FixedVector<JointLimits, kMaxJoints> limits_;
  DriveCondition condition_ = DriveCondition::kDisabled;
};

class NoSensor final : public hal::RangeSensor {
 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant /*now*/) override {
    return std::optional<hal::RangeReading>{};
  }
};

// A reply is a line of printable ASCII that begins as the protocol says.
void check_reply(std::string_view line) {
  FUZZ_CHECK(line.starts_with("ok") || line.starts_with("error ") || line.starts_with("#"));
  FUZZ_CHECK(line.size() <= 4096);
  for (const char c : line) FUZZ_CHECK((c >= ' ' && c <= '~') || c == '\t');
}

// Lines of the input are requests; an empty one lets 50 ms pass.
void fuzz_requests(Bytes bytes) {
  static const controller::Configuration configuration = test::puma_controller();
  IdealDrives drives(test::puma_configuration(), configuration.drawing.limits);
  NoSensor sensor;
  simulated::VirtualClock clock;
  test::RamMemory memory;
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  const auto controller = std::make_unique<controller::Controller>(configuration, drives, sensor,
                                                                   clock, memory, consoles);
  hal::Instant next;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      controller->tick(clock.wait_until(next));
      controller->background();
      next += std::chrono::milliseconds(2);
    }
  };
  run(10);
  std::string_view left = text_of(bytes);
  for (int lines = 0; !left.empty() && lines < 40; ++lines) {
    const std::size_t end = std::min(left.find('\n'), left.size());
    const std::string_view line = left.substr(0, std::min(end, hal::kMaxConsoleLine));
    left.remove_prefix(std::min(end + 1, left.size()));
    if (!line.empty()) {
      std::string request;
      for (const char c : line) {
        if ((c >= ' ' && c <= '~') || c == '\t') request += c;
      }
      console.requests.push_back(request);
    }
    run(line.empty() ? 25 : 3);
  }
  run(5);
  for (const std::string& reply : console.replies) check_reply(reply);
  for (const std::string& told : console.told) check_reply(told);
}

// A line that brings the tape, some bytes at a time.
class TapeStream final : public hal::ByteStream {
 public:
  explicit TapeStream(Tape& tape) : tape_(tape) {}
  std::string written;

 private:
  Result<void> do_write(std::span<const std::uint8_t> bytes) override {
    written.append(text_of(bytes));
    return {};
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override {
    const Bytes piece = tape_.take(std::min<std::size_t>(into.size(), 16));
    std::ranges::copy(piece, into.begin());
    return piece.size();
  }

  Tape& tape_;
};

void fuzz_serial(Bytes bytes) {
  Tape tape(bytes.first(std::min<std::size_t>(bytes.size(), 1024)));
  TapeStream line(tape);
  hal::SerialConsole console(line);
  std::array<hal::Console*, 1> consoles{&console};
  test::RamMemory memory;
  cabinet::VirtualCabinet cabinet(test::puma_controller(), test::puma_bus(), test::puma_world(),
                                  memory, consoles);
  for (int ticks = 0; ticks < 600 && (ticks < 20 || !tape.empty()); ++ticks) cabinet.step();
  for (int ticks = 0; ticks < 20; ++ticks) cabinet.step();
  // Whole lines, each a reply.
  FUZZ_CHECK(line.written.empty() || line.written.ends_with("\n"));
  for (std::string_view left = line.written; !left.empty();) {
    const std::size_t end = left.find('\n');
    std::string_view reply = left.substr(0, end);
    if (reply.ends_with('\r')) reply.remove_suffix(1);
    check_reply(reply);
    left.remove_prefix(end + 1);
  }
}

// Lines that a person types, begun with an even byte, and lines of a controller.
void fuzz_conversation(Bytes bytes) {
  tool::Conversation conversation;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (line.empty()) continue;
    if (line.front() % 2 == 0) {
      const auto step = conversation.take(line.substr(1), 80);
      FUZZ_CHECK(step.send.size() <= tool::Conversation::kLongestLine);
      FUZZ_CHECK(!step.say.contains('\x1B'));
    } else {
      conversation.learn_verbs(line);
      conversation.learn_verb(line);
      conversation.learn_joints(line);
      FUZZ_CHECK(!conversation.hear(line, 80).contains('\x1B'));
      FUZZ_CHECK(!tool::status_in_words(line, 80).contains('\x1B'));
    }
    for (const std::string& word : conversation.completions(line)) FUZZ_CHECK(!word.empty());
  }
}

constexpr std::array kTargets{Target{"requests", fuzz_requests}, Target{"serial", fuzz_serial},
                              Target{"conversation", fuzz_conversation}};

}  // namespace

std::span<const Target> console_targets() { return kTargets; }

}  // namespace armsig::fuzz
