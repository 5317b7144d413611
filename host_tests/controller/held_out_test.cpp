// SPDX-License-Identifier: MIT
#include "firmware/controller/held_out.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::controller {
namespace {

constexpr double kAngle = radians(0.05);
constexpr double kLength_m = 0.5e-3;

// A Puma as built, and what twenty poses of it say of a candidate and the active model.
struct HeldOut : testing::Test {
  test::Random random{5};
  test::Cell cell = test::puma_cell(random);
  std::unique_ptr<SignatureRecord> candidate = std::make_unique<SignatureRecord>();
  std::unique_ptr<SignatureRecord> active = std::make_unique<SignatureRecord>();

  HeldOut() {
    candidate->signature = exact(cell);
    active->signature = exact(cell);
  }

  [[nodiscard]] static Signature exact(const test::Cell& of) {
    return test::signature_of(of, test::puma_configuration());
  }

  // Precondition: `model` null is the drawing.
  HeldOutReport compare_with(const SignatureRecord* model) {
    HeldOutComparison comparison(*candidate, model, test::puma());
    while (comparison.step()) {
    }
    for (int pose = 0; pose < 20; ++pose) {
      const JointVector q = random.configuration(cell.arm);
      comparison.judge(q, cell.point(q, 0));
    }
    return comparison.report();
  }
};

TEST_F(HeldOut, a_worse_candidate_does_not_spoil_the_place_of_the_signature_it_is_judged_against) {
  candidate->signature = test::disturbed(candidate->signature, kAngle, kLength_m, random);
  const HeldOutReport report = compare_with(active.get());
  EXPECT_EQ(report.poses, 20U);
  EXPECT_LT(report.active_rms_m, 1e-9);
  EXPECT_GT(report.candidate_rms_m, 1e-4);
  EXPECT_FALSE(report.is_better());
}

TEST_F(HeldOut, a_signature_is_judged_from_anew_where_sensor_and_target_were_moved) {
  test::Cell before = cell;
  before.X_SB = Pose{rotation_z(0.4), Vector3(0.3, -0.2, 0.1)} * cell.X_SB;
  before.p_tool[0] += Vector3(0.01, -0.02, 0.03);
  active->signature = exact(before);
  const HeldOutReport report = compare_with(active.get());
  EXPECT_LT(report.active_rms_m, 1e-9);
  EXPECT_LT(report.candidate_rms_m, 1e-9);
}

TEST_F(HeldOut, a_better_candidate_wins_wherever_the_worse_signature_stood) {
  active->signature = test::disturbed(active->signature, kAngle, kLength_m, random);
  const HeldOutReport report = compare_with(active.get());
  EXPECT_LT(report.candidate_rms_m, 1e-9);
  EXPECT_GT(report.active_rms_m, 1e-4);
  EXPECT_TRUE(report.is_better());
}

TEST_F(HeldOut, the_drawing_is_laid_over_the_candidate) {
  const HeldOutReport report = compare_with(nullptr);
  EXPECT_LT(report.candidate_rms_m, 1e-9);
  EXPECT_GT(report.active_rms_m, 1e-4);
  EXPECT_LT(report.active_rms_m, 0.05);
}

TEST_F(HeldOut, without_a_pose_no_candidate_is_better) {
  const HeldOutReport report = HeldOutComparison(*candidate, active.get(), test::puma()).report();
  EXPECT_EQ(report.poses, 0U);
  EXPECT_FALSE(report.is_better());
}

}  // namespace
}  // namespace armsig::controller
