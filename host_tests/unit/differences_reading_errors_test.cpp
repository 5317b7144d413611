// SPDX-License-Identifier: MIT
// Errors of the readings among what is different about an arm, with their uncertainty.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/signature_of_model.hpp"
#include "firmware/analysis/differences/differences.hpp"
#include "firmware/analysis/differences/drawn_axes.hpp"
#include "firmware/analysis/starts/determination.hpp"
#include "host_tests/support/engine_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::differences {
namespace {

using calibration::Refined;
using test::Cell;
using test::Random;

constexpr double kGain = 1e-3;
constexpr double kFirst_rad = 5e-4;

// Joint 2 reads by a wrong gear, joint 3 by a disc off its centre; both are sought, and the second
// wave of joint 5, which it has not. Joint 4 slides.
struct Misread {
  Random random{111};
  Cell cell = test::mixed_cell(random);
  std::unique_ptr<Refined> refined = std::make_unique<Refined>();

  Misread() {
    std::vector<calibration::FitRow> rows;
    for (int k = 0; k < 300; ++k) {
      const JointVector readings = random.configuration(cell.arm);
      JointVector q = readings;
      q[1] += kGain * q[1];
      q[2] += kFirst_rad * std::cos(q[2]);
      rows.push_back(test::position_row(readings, cell.point(q, 0) + random.normal_vector(1e-5)));
    }
    test::EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0]}, rows);
    calibration::ParameterRequest request;
    request.readings.resize(6);
    request.readings[1].gain = true;
    request.readings[2].first = true;
    request.readings[4].second = true;
    calibration::ask_for(request, *fit.model);
    EXPECT_TRUE(fit.engine().run(test::kGeometryAlone));
    refined->signature = test::signature_of(cell, test::cell_configuration());
    std::vector<double> scratch(calibration::kMaxParameters * calibration::kMaxParameters);
    EXPECT_TRUE(calibration::geometry_to_signature(*fit.model, fit.targets, fit.engine(), *refined,
                                                   request, scratch));
    for (const calibration::JointModel& joint : fit.model->joints) {
      refined->readings.corrections.push_back(joint.correction);
    }
    refined->readings.corrections[4] = {};
    refined->readings.corrections[5].sin_2 = 2e-4;  // known otherwise: no unknown of the fit
  }
};

TEST(Differences, name_errors_of_readings_with_their_sigmas) {
  const Misread arm;
  const auto found = differences(arm.cell.arm, *arm.refined, 0);
  ASSERT_TRUE(found);
  const auto of = [&](std::size_t joint, Cause cause) {
    for (const Difference& one : found->all) {
      if (one.joint == joint && one.cause == cause) return one;
    }
    return Difference{};
  };
  const auto& layout = arm.refined->layout;
  EXPECT_NEAR(of(1, Cause::kScale).value, kGain, 0.1 * kGain);
  EXPECT_NEAR(of(1, Cause::kScale).sigma,
              calibration::parameter_sigma(arm.refined->information, layout.gain[1]), 1e-12);
  const Difference first = of(2, Cause::kOnceATurn);
  EXPECT_NEAR(first.value, kFirst_rad, 0.1 * kFirst_rad);
  // Of an amplitude that is its cosine, nearly.
  EXPECT_NEAR(first.sigma, calibration::parameter_sigma(arm.refined->information, layout.first[2]),
              0.2 * first.sigma);
  EXPECT_EQ(of(4, Cause::kTwiceATurn).value, 0) << "none is not told";
  EXPECT_NEAR(of(5, Cause::kTwiceATurn).value, 2e-4, 1e-12);
  EXPECT_EQ(of(5, Cause::kTwiceATurn).sigma, 0) << "nobody has estimated it";
}

TEST(FittedDrawing, is_refused_of_an_arm_that_is_not_the_drawings) {
  const Arm drawing = test::puma();
  Cell cell{drawing, {}, {Vector3(0, 0, 0.1)}};
  cell.arm.joints[0].alpha_rad *= -1;
  cell.arm.joints[2].alpha_rad *= -1;
  const auto estimate = std::make_unique<Refined>();
  estimate->signature = test::signature_of(cell, test::cell_configuration());
  const auto fitted = fitted_drawing(drawing, *estimate, 0);
  ASSERT_FALSE(fitted);
  EXPECT_EQ(test::failure_of(fitted), Error::kNotConverged);
}

// Behind a slide an axis has no turn to be told by; beside a tool on it, no direction either.
TEST(DrawnAxes, behind_a_slide_and_through_the_tool_have_a_heading) {
  const Arm arm = test::make_arm(
      {{test::kP, 0, 0, 0, kPi / 2}, {test::kR, 0, 0, 0, 0}, {test::kR, 0, 0.2, 0, 0}},
      {{-0.5, 0.5}, {-3, 3}, {-3, 3}});
  const auto axes = drawn_axes(arm, Vector3(0, 0, 0.1));
  EXPECT_EQ(axes[1].heading, Heading::kAlongAxis);
  EXPECT_EQ(axes[1].of_zero, Deviation::kShiftX);
  EXPECT_EQ(axes[1].y_away, 0);
  EXPECT_EQ(axes[2].heading, Heading::kToTool) << "one with the axis before";
  EXPECT_TRUE(axes[2].X_before.R.allFinite());
  EXPECT_NEAR(axes[2].X_before.R.col(0).norm(), 1, 1e-12);
}

}  // namespace
}  // namespace armsig::differences
