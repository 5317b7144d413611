// SPDX-License-Identifier: MIT
// The method whole, as a controller or a user of the library runs it: six sweeps of a Puma, each
// point through the estimator, then features, frames, S-Model and pseudo-Denavit-Hartenberg
// parameters, and the kinematics of the servo.
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/features/sweep_estimator.hpp"
#include "core/identification.hpp"
#include "core/kinematics/forward.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::benchmarks {
namespace {

constexpr double kSigma_m = 2e-4;

struct IdentificationWork {
  explicit IdentificationWork(int points_per_sweep) {
    test::Random random(14);
    const test::Cell cell = test::puma_cell(random);
    test::add_sweeps(cell, configuration, kPi, points_per_sweep, kSigma_m, random, log);
  }

  [[nodiscard]] kinematics::Chain identified() const {
    FixedVector<features::JointFeature, kMaxJoints> features;
    std::size_t row = 0;
    for (std::size_t joint = 0; joint < configuration.size(); ++joint) {
      features::SweepEstimator sweep({.type = drawing.joints[joint].type});
      for (; row < log.size() && log[row].sweep == joint + 1; ++row) {
        const calibration::Observation& of = log[row];
        const Matrix3 covariance_m2 = of.sigma_m * of.sigma_m * Matrix3::Identity();
        if (!sweep.add(of.readings[joint], of.p_S, covariance_m2)) std::abort();
      }
      const auto feature = sweep.estimate();
      if (!feature) std::abort();
      features.push_back(*feature);
    }
    const auto signature = identify(features, configuration, drawing);
    if (!signature || !signature->description_matches) std::abort();
    return kinematics::make_chain(signature->pseudo_dh);
  }

  Arm drawing = test::puma();
  JointVector configuration = test::cell_configuration();
  test::Log log;
};

struct IdentificationRows {
  IdentificationRows() {
    for (const int points : {16, 36, 60}) {
      const Row row(
          "six sweeps of " + std::to_string(points) + " points to the servo's kinematics", "armsig",
          [points] {
            return [work = IdentificationWork(points)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) keep(work.identified());
            };
          },
          1);
    }
  }
};
const IdentificationRows kIdentificationRows;

}  // namespace
}  // namespace armsig::benchmarks
