// SPDX-License-Identifier: MIT
// An arm of six joints calibrates itself, with nothing around it: the same points on a Cortex-M7
// and on the host, so that what is found there can be compared.
//
// The arm is robot 1 of Table 2 of the paper, its readings wrong by waves of 0.02 degrees, sagging
// by half a millimetre, measured to 0.1 mm. Where it truly is, is computed apart from the model
// that is fitted (hal/simulated).
#pragma once

#include "core/calibration/servo_readings.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/self_calibration/self_calibration.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::story {

inline constexpr std::size_t kJoints = 6;
// Sweeps, poses and those measured again; more points only if accuracy is long in coming.
inline constexpr std::size_t kPoints = 400;
inline constexpr std::size_t kPointsOfASweep = 24;
inline constexpr double kAsked_m = 0.15e-3;
inline constexpr int kJudged = 100;  // poses at which the answer is
// RMS of what is left there; geometry alone leaves twice as much.
inline constexpr double kLargest_m = 0.2e-3;

using Memory = controller::SelfCalibrationMemory<kPoints, kJoints>;

// Large: keep it out of stacks.
class Story {
 public:
  explicit Story(Memory& memory);
  Story(const Story&) = delete;
  Story& operator=(const Story&) = delete;

  // Steps of the background.
  void begin();
  void refine() { calibration_.refine(record_.signature); }
  [[nodiscard]] controller::Refinement::Next step() { return calibration_.step(now_); }
  void tell(controller::Line& line) const { calibration_.tell(line); }
  void take(std::size_t sweep, const JointVector& readings,
            const controller::MeasuredPoint& measured) {
    calibration_.take(sweep, readings, measured);
  }
  [[nodiscard]] Result<void> write() { return calibration_.write(record_); }

  // Where the arm is sent meanwhile: point `k` of the sweep of joint `joint` from 0; some seconds
  // on, the pose asked for.
  [[nodiscard]] JointVector readings_of_sweep(std::size_t joint, std::size_t k) const;
  [[nodiscard]] const JointVector& visit();
  // What the sensor says of the target there.
  [[nodiscard]] controller::MeasuredPoint measured_at(const JointVector& readings);

  // After write(): where pose `k` from 1 has the target, by what was found and in truth.
  struct Answer {
    Vector3 found = Vector3::Zero();
    Vector3 truth = Vector3::Zero();
  };
  [[nodiscard]] Answer answer(int k);

 private:
  [[nodiscard]] Vector3 target_at(const JointVector& readings) const;

  simulated::SimulatedArm arm_;
  controller::Configuration configuration_;
  controller::SelfCalibration calibration_;
  controller::SignatureRecord record_;
  simulated::Random random_{7};
  hal::Instant now_;
  calibration::ServoReadings joints_;
};

// All of it, from the sweeps to what is written; `timed` is given each step of the background
// and calls it, `told` is given each line that is said.
template <typename Timed, typename Told>
[[nodiscard]] Result<void> run(Story& story, Timed timed, Told told) {
  timed([&] { story.begin(); });
  const auto measure = [&](std::size_t sweep, const JointVector& readings) {
    const controller::MeasuredPoint measured = story.measured_at(readings);
    timed([&] { story.take(sweep, readings, measured); });
  };
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    for (std::size_t k = 0; k < kPointsOfASweep; ++k) {
      measure(joint + 1, story.readings_of_sweep(joint, k));
    }
  }
  timed([&] { story.refine(); });
  for (auto next = controller::Refinement::Next::kComputes;;) {
    timed([&] { next = story.step(); });
    if (next == controller::Refinement::Next::kDone) break;
    if (next == controller::Refinement::Next::kVisits) {
      measure(0, story.visit());
    } else if (next == controller::Refinement::Next::kTells) {
      controller::Line line;
      timed([&] { story.tell(line); });
      told(line);
    }
  }
  Result<void> written;
  timed([&] { written = story.write(); });
  return written;
}

}  // namespace armsig::story
