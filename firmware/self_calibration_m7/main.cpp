// SPDX-License-Identifier: MIT
// The self-calibration on a Cortex-M7: what it finds, and the instructions of its longest step.
//
//   # what it says meanwhile
//   memory estimator=BYTES model=BYTES points=BYTES self_calibration=BYTES
//   steps N
//   count self_calibration_step instructions=N
//   answer POSE x_um=X y_um=Y z_um=Z
//   check self_calibration_um ok worst=RMS limit=200
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <new>
#include <utility>

#include "firmware/self_calibration_m7/story.hpp"
#include "firmware/selftest/report.hpp"
#include "toolchain/boards/semihosting.hpp"

namespace armsig::story {
namespace {

using selftest::counter;

// What the estimator may have beside the points.
static_assert(sizeof(Memory::fit) + sizeof(calibration::Engine) <= 60'000);

// In plain bytes, as nothing may run before main.
template <typename T>
struct Place {
  alignas(T) std::array<std::byte, sizeof(T)> bytes;
  template <typename... Arguments>
  T& make(Arguments&&... arguments) {
    void* place = bytes.data();
    return *new (place) T(std::forward<Arguments>(arguments)...);
  }
};
Place<Memory> memory;
Place<Story> story;

void say_memory() {
  controller::Line line;
  line.text("memory fit=").integer(sizeof(Memory::fit) + sizeof(calibration::Engine));
  line.text(" model=").integer(sizeof(calibration::ArmModel));
  line.text(" points=").integer(sizeof(Memory) - sizeof(Memory::fit));
  line.text(" whole=").integer(sizeof(controller::SelfCalibration));
  board::say(line.view());
}

void say_answers(Story& told, selftest::Report& report) {
  double squares = 0;
  for (int k = 1; k <= kJudged; ++k) {
    const Story::Answer answer = told.answer(k);
    controller::Line line;
    line.text("answer_um ").integer(static_cast<std::uint64_t>(k));
    for (const double coordinate : answer.found) line.text(" ").number(1e6 * coordinate, 6);
    board::say(line.view());
    squares += (answer.found - answer.truth).squaredNorm();
  }
  report.check("self_calibration_um", 1e6 * std::sqrt(squares / kJudged), 1e6 * kLargest_m);
}

int calibrate() {
  selftest::Report report;
  selftest::start_counter();
  say_memory();
  Story& told = story.make(memory.make());
  double longest = 0;
  std::uint64_t steps = 0;
  const auto timed = [&](auto&& work) {
    const std::uint32_t begin = counter();
    work();
    longest = std::max(longest, selftest::instructions_between(begin, counter()));
    ++steps;
  };
  const auto written =
      run(told, timed, [](const controller::Line& line) { board::say(line.view()); });
  if (!written) return 1;
  controller::Line line;
  board::say(line.text("steps ").integer(steps).view());
  report.count("self_calibration_step", longest);
  say_answers(told, report);
  report.stack();
  return report.passed() ? 0 : 1;
}

}  // namespace
}  // namespace armsig::story

extern "C" int armsig_main() { return armsig::story::calibrate(); }
