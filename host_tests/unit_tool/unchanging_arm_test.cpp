// SPDX-License-Identifier: MIT
// Backlash of an arm in sweeps: what an arm that stays as it is explains of it, also before a joint
// first moved, when the order of the rows does not show its side.
#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"

#include <gtest/gtest.h>

#include "core/calibration/approach_direction.hpp"
#include "core/numerics/rotations.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::tool {
namespace {

constexpr double kHalf_rad = 3e-4;
constexpr double kNoise_m = 2e-5;
constexpr int kRows = 25;
constexpr double kArc_rad = 2;

// Every joint goes up through its arc, and back to its place before the next one does.
Evidence swept_joints() {
  Evidence evidence;
  evidence.arm = test::puma();
  const JointTypes types = types_of(evidence.arm.joints);
  calibration::ApproachDirection approach;
  const JointVector home{0.2, -0.9, 1.1, 0.3, 0.6, 0.1};
  for (std::size_t j = 0; j < home.size(); ++j) {
    for (int k = 0; k < kRows; ++k) {
      EvidenceRow row{.sweep = j + 1, .target = 1, .q = home};
      row.q[j] += kArc_rad * (static_cast<double>(k) / (kRows - 1) - 0.5);
      approach.go_to(types, row.q);
      row.sides = approach.sides();
      row.sided = approach.sided();
      evidence.rows.push_back(row);
    }
  }
  return evidence;
}

struct Missed {
  double without_m = 0;
  double with_m = 0;
};

// `first` of every joint: from which side it came to the first row.
Missed missed_by(const JointVector& first) {
  test::Random random(44);
  Evidence evidence = swept_joints();
  DeviatingChain chain(evidence, {});
  chain.place(Pose{rotation_z(0.7), {1.2, -0.4, 0.9}}, {{0.12, 0.05, 0.18}});
  std::vector<Vector3> residuals;
  for (EvidenceRow& row : evidence.rows) {
    const Eigen::Matrix3Xd motions = chain.motions(row);
    residuals.push_back(random.normal_vector(kNoise_m));
    for (std::size_t j = 0; j < first.size(); ++j) {
      const double known = (row.sides >> j & 1) != 0 ? 1 : -1;
      const double side = (row.sided >> j & 1) != 0 ? known : first[j];
      residuals.back() -= side * kHalf_rad * motions.col(static_cast<Eigen::Index>(j));
    }
  }
  const std::vector<Vector3> places = chain.residuals(evidence);
  for (std::size_t k = 0; k < places.size(); ++k) evidence.rows[k].p_S = residuals[k] - places[k];
  return {UnchangingArm(evidence, chain, residuals, Backlash::kNone).missed_m(),
          UnchangingArm(evidence, chain, residuals, Backlash::kPossible).missed_m()};
}

TEST(UnchangingArm, explains_backlash_of_sweeps_whichever_side_the_joints_came_from_at_first) {
  for (const JointVector& first :
       {JointVector{1, 1, 1, 1, 1, 1}, JointVector{-1, -1, -1, -1, -1, -1},
        JointVector{1, -1, 1, -1, 1, -1}}) {
    const Missed missed = missed_by(first);
    EXPECT_GT(missed.without_m, 3 * kNoise_m);
    EXPECT_LT(missed.with_m, 2.5 * kNoise_m);
  }
}

}  // namespace
}  // namespace armsig::tool
