// SPDX-License-Identifier: MIT
// The kinematics of a servo tick on a line: where the arm is, and the readings of the next tick,
// which are two milliseconds away from those of this one.
#include <cmath>
#include <cstdlib>
#include <random>

#include "core/calibration/servo_inverse.hpp"
#include "core/kinematics/forward.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/kinematics_random.hpp"

namespace armsig::benchmarks {

namespace {

using calibration::ServoReadings;

constexpr std::size_t kTicks = 256;  // a power of two
constexpr double kMap = radians(0.02);
constexpr double kSag = 5e-4;  // rad per m of lever: 0.5 mm at a metre

struct TickWork {
  kinematics::Chain chain;
  ServoReadings joints;
  kinematics::InverseOptions options;
  std::array<JointVector, kTicks> q;
  std::array<Pose, kTicks> X_0n;
};

// Waves of one, five and thirty a turn, and every lever that the drawing can tell apart.
calibration::PackedDeflections deflections_of(const Arm& drawing, std::mt19937_64& random) {
  auto model = calibration::model_of(drawing, {});
  calibration::choose_gravity_terms(drawing, model);
  for (calibration::GravityTerm& term : model.gravity) {
    term.coefficient = test::uniform(random, -kSag, kSag);
  }
  for (calibration::JointModel& joint : model.joints) {
    for (const double waves : {1.0, 5.0, 30.0}) {
      const double phase = test::uniform(random, 0, 6);
      for (std::size_t k = 0; k < calibration::kKnots; ++k) {
        const double turns = static_cast<double>(k) / calibration::kKnots;
        joint.map[k] += kMap / 3 / calibration::map_unit(joint.type) *
                        std::sin(2 * kPi * waves * turns + phase);
      }
    }
  }
  return calibration::packed(model);
}

// Half a second round a bent arm, some joints at sixty degrees a second.
TickWork work(bool bent) {
  std::mt19937_64 random(5);
  TickWork work;
  const test::KnownArm arm = test::perturbed_puma(random);
  const JointVector middle{0.3, -1, 0.5, 0.4, 0.9, -0.2};
  if (bent) work.joints = ServoReadings(deflections_of(arm.drawing, random), arm.drawing, middle);
  work.chain = kinematics::make_chain(arm.joints);
  work.options.max_iterations = 12;
  for (std::size_t i = 0; i < 6; ++i) work.options.max_step.push_back(0.02);
  for (std::size_t k = 0; k < kTicks; ++k) {
    JointVector q = middle;
    for (std::size_t i = 0; i < 6; ++i) {
      q[i] += 0.085 * std::sin(2 * kPi * static_cast<double>(k) / kTicks + static_cast<double>(i));
    }
    work.q[k] = q;
    work.X_0n[k] = *calibration::forward(work.chain, work.joints, q);
  }
  return work;
}

Work ticks(bool bent) {
  return [w = work(bent), lately = calibration::LatelyTurned{}](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      keep(calibration::forward(w.chain, w.joints, w.q[k % kTicks]));
      const auto solution = calibration::inverse(w.chain, w.joints, w.X_0n[(k + 1) % kTicks],
                                                 w.q[k % kTicks], w.options, lately);

      if (solution->verdict != kinematics::Verdict::kConverged) std::abort();
      keep(solution);
    }
  };
}

const Row kTick("tick", "armsig", [] { return ticks(false); });
const Row kBentTick("tick with maps and gravity", "armsig", [] { return ticks(true); });

}  // namespace
}  // namespace armsig::benchmarks
