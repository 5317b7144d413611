// SPDX-License-Identifier: MIT
// "Figures to expect": how many times smaller the tool error becomes, over arms drawn about the
// Puma 560 (alpha 0.1 degrees, theta 0.2 degrees, a and d 0.5 mm), 30 points a joint, 0.2 mm per
// axis. The floors were found with an independent simulation.
//
// One target on the hand, 10 cm beside and before the flange, serves all sweeps; the arm is
// stretched in the signature configuration, so that the first joints swing the target widely. The
// drawing has its base and its target where they really are at that configuration.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "firmware/analysis/evaluation/tool_error.hpp"
#include "firmware/host_tool/identification/identification_run.hpp"
#include "firmware/host_tool/simulation/simulation.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::tool {
namespace {

constexpr int kArms = 100;
constexpr int kToolTarget = 1;
constexpr int kConfigurations = 300;

struct ErrorSums {
  double drawing_m2 = 0;
  double signature_m2 = 0;

  [[nodiscard]] double factor() const { return std::sqrt(drawing_m2 / signature_m2); }
};

JointVector stretched() {
  JointVector configuration;
  for (const double reading_deg : {10.0, -20.0, 110.0, 20.0, 40.0, 10.0}) {
    configuration.push_back(radians(reading_deg));
  }
  return configuration;
}

double squared(double x) { return x * x; }

// RMS over arms and poses of the tool error by the drawing, over that by the signature.
template <typename Identify>
double improvement_factor(double arc_deg, features::Method method, Purpose purpose,
                          const Identify& identify) {
  const Arm drawing = puma560();
  const JointVector configuration = stretched();
  ErrorSums sums;
  for (int n = 1; n <= kArms; ++n) {
    simulated::Random random(static_cast<std::uint64_t>(n));
    simulated::SimulatedArm built{
        .arm = simulated::drawn_arm(drawing, simulated::Tolerances{}, random),
        .X_S0 = simulated::demo_base_pose(),
        .targets = {}};
    mount_hand_target(built, Vector3(0.1, 0, 0.1));
    const Simulation simulation{.arm = built,
                                .plan = plan_sweeps(drawing, configuration, radians(arc_deg), 30),
                                .sensor = simulated::CartesianConfig{.sigma_m = 0.2e-3},
                                .seed = static_cast<std::uint64_t>(n)};
    IdentificationRun run(drawing, std::nullopt, "", method, purpose);
    simulate(simulation, [&](const MeasurementRow& row) { EXPECT_TRUE(run.take(row)); });
    const Read<Identified> identified = identify(run);
    EXPECT_TRUE(identified) << (identified ? "" : render(identified.error()));
    if (!identified) return 0;
    const Signature truth = truth_of(built, configuration);
    const auto error = [&](const Signature& model) {
      return evaluation::rms_tool_error(model, truth, kToolTarget, Pose{}, drawing.limits,
                                        kConfigurations);
    };
    Signature drawn = signature_of(drawing, configuration, built.X_S0, {});
    drawn.targets = truth.targets;
    sums.drawing_m2 += squared(error(drawn));
    sums.signature_m2 += squared(error(identified->signature));
  }
  std::printf("arc %3.0f degrees: factor %.1f\n", arc_deg, sums.factor());
  return sums.factor();
}

double improvement_factor(double arc_deg, features::Method method) {
  return improvement_factor(arc_deg, method, Purpose::kFeatures,
                            [](IdentificationRun& run) { return run.finish(); });
}

double factor_of_refinement(double arc_deg) {
  return improvement_factor(arc_deg, features::Method::kEncoder, Purpose::kRefinement,
                            [](IdentificationRun& run) -> Read<Identified> {
                              ARMSIG_TRY(found, run.finish_refined({}));
                              return std::move(found.first);
                            });
}

TEST(FiguresToExpect, are_reached_by_the_papers_fit) {
  EXPECT_GE(improvement_factor(60, features::Method::kPaper), 1.6);
  EXPECT_GE(improvement_factor(90, features::Method::kPaper), 3.6);
  EXPECT_GE(improvement_factor(120, features::Method::kPaper), 6.0);
  EXPECT_GE(improvement_factor(180, features::Method::kPaper), 10.8);
}

TEST(FiguresToExpect, are_reached_by_the_encoder_referenced_circle) {
  EXPECT_GE(improvement_factor(60, features::Method::kEncoder), 3.1);
  EXPECT_GE(improvement_factor(90, features::Method::kEncoder), 6.1);
  EXPECT_GE(improvement_factor(120, features::Method::kEncoder), 9.2);
  EXPECT_GE(improvement_factor(180, features::Method::kEncoder), 14);
}

TEST(FiguresToExpect, are_reached_by_the_refinement_of_sweeps_alone) {
  EXPECT_GE(factor_of_refinement(60), 4);
  EXPECT_GE(factor_of_refinement(90), 8);
  EXPECT_GE(factor_of_refinement(120), 11);
  EXPECT_GE(factor_of_refinement(180), 19);
}

}  // namespace
}  // namespace armsig::tool
