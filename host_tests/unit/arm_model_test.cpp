// SPDX-License-Identifier: MIT
// The model of an arm: its maps, corrections and gravity terms, and readings there and back.
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "core/calibration/gravity_choice.hpp"
#include "core/calibration/model.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Random;

Arm with_slide() {
  Arm arm = test::puma();
  arm.joints[3].type = JointType::kPrismatic;
  arm.limits[3] = {-0.2, 0.3};
  return arm;
}

TEST(ArmModel, of_a_slide_without_limits_has_no_map) {
  Arm arm = with_slide();
  EXPECT_GT(model_of(arm, {}).joints[3].domain.per_length, 0);
  arm.limits[3] = {0.3, 0.3};
  EXPECT_EQ(model_of(arm, {}).joints[3].domain.per_length, 0);
  arm.limits[3] = {0, std::numeric_limits<double>::infinity()};
  EXPECT_EQ(model_of(arm, {}).joints[3].domain.per_length, 0);
  EXPECT_EQ(model_of(arm, {}).joints[3].domain.origin, 0);
  arm.limits.clear();
  const ArmModel unlimited = model_of(arm, {});
  EXPECT_EQ(unlimited.joints[3].domain.per_length, 0);
  EXPECT_GT(unlimited.joints[2].domain.per_length, 0) << "a turn is one whatever the limits";
}

TEST(ArmModel, finds_the_corrections_that_are_asked_for_and_no_others) {
  ArmModel model = model_of(with_slide(), {});
  ParameterRequest request;
  request.readings.resize(6);
  request.readings[1].gain = true;
  request.readings[2].second = true;
  request.readings[3] = {.gain = true, .first = true, .second = true};
  ask_for(request, model);
  ASSERT_EQ(model.further.size(), 4U);
  EXPECT_EQ(model.further[0].kind, ParameterKind::kReadingGain);
  EXPECT_EQ(model.further[0].index, 1);
  EXPECT_EQ(model.further[1].kind, ParameterKind::kReadingSecond);
  EXPECT_EQ(model.further[2].component, 1);
  EXPECT_EQ(model.further[3].kind, ParameterKind::kReadingGain) << "a slide has no waves";
  EXPECT_EQ(model.further[3].index, 3);
}

TEST(ArmModel, places_its_chain_anew_by_what_was_looked_up_before_it_moved) {
  Random random(7);
  ArmModel model = model_of(with_slide(), random.pose(1));
  choose_gravity_terms(with_slide(), model);
  const JointVector q = random.configuration(with_slide());
  ChainFrames anew;
  look_up(model, q, 6, anew);
  for (JointModel& joint : model.joints) {
    for (double& deviation : joint.deviation) deviation = random.normal(1e-3);
    for (double& coefficient : joint.map) coefficient = random.normal();
    joint.correction.gain = random.normal(1e-3);
  }
  for (GravityTerm& term : model.gravity) term.coefficient = random.normal(1e-3);
  FixedLinks links;
  place_links(model, links);
  place_chain(model, links, 6, anew);
  ChainFrames whole;
  evaluate_chain(model, q, 6, whole);
  EXPECT_EQ(anew.X_SL.R, whole.X_SL.R);
  EXPECT_EQ(anew.X_SL.p, whole.X_SL.p);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_EQ(anew.X_SJ[j].p, whole.X_SJ[j].p) << j;
}

TEST(GravityTerms, are_set_once) {
  const Arm drawing = test::puma();
  ArmModel model = model_of(drawing, {});
  GravityChoice choice(drawing, model);
  while (choice.step()) {
  }
  const std::size_t terms = model.gravity.size();
  EXPECT_GT(terms, 0U);
  EXPECT_FALSE(choice.step());
  EXPECT_EQ(model.gravity.size(), terms);
}

// A tenth of a millimetre beside ten metres is no lever of its own; alone it is one.
TEST(GravityTerms, have_levers_that_are_seen_beside_longer_ones) {
  const Arm arm = test::make_arm(
      {{test::kR, 0, 0, 0, kPi / 2}, {test::kR, 0, 0, 10, 0}, {test::kR, 0, 0, 1e-4, 0}},
      {{-3, 3}, {-3, 3}, {-3, 3}});
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  ASSERT_EQ(model.gravity.size(), 2U);
  EXPECT_EQ(model.gravity[0].joint, 1);
  EXPECT_EQ(model.gravity[0].origin, 2);
  EXPECT_EQ(model.gravity[1].joint, 2);
  EXPECT_EQ(model.gravity[1].origin, 3);
}

TEST(Readings, that_turn_joints_by_couplings_and_maps_are_found_again) {
  Random random(21);
  const auto bent = std::make_unique<ArmModel>(model_of(test::puma(), {}));
  for (JointModel& joint : bent->joints) {
    for (double& c : joint.map) c = random.uniform(-3, 3);
  }
  ReadingModel plain;
  plain.couplings.push_back({2, 1, -0.5});
  ReadingModel mapped = plain;
  mapped.deflections = bent.get();
  ReadingModel wave = plain;
  wave.corrections.resize(6, {.sin_1 = 0.01});
  const JointVector configuration = test::cell_configuration();
  const JointVector readings = random.configuration(test::puma());
  for (const auto* model : {&plain, &mapped, &wave}) {
    const JointVector back =
        encoder_readings(*model, configuration, true_readings(*model, configuration, readings));
    for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(back[j], readings[j], 1e-13) << j;
  }
}

}  // namespace
}  // namespace armsig::calibration
