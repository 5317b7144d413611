// SPDX-License-Identifier: MIT
// The closed forms of the two common designs, by which a cold start begins.
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/forward.hpp"
#include "firmware/analysis/postures/closed_form.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/pose_difference.hpp"

namespace armsig::kinematics {
namespace {

constexpr Posture kPostures[] = {{false, false, false}, {false, false, true}, {false, true, false},
                                 {false, true, true},   {true, false, false}, {true, false, true},
                                 {true, true, false},   {true, true, true}};

TEST(ClosedForm, knows_the_designs_of_the_known_arms) {
  EXPECT_EQ(closed_form(make_chain(test::puma560().joints)).design, Design::kSphericalWrist);
  EXPECT_EQ(closed_form(make_chain(test::puma560_robot1().joints)).design, Design::kSphericalWrist);
  EXPECT_EQ(closed_form(make_chain(test::ur5().joints)).design, Design::kParallelAxes);
  EXPECT_EQ(closed_form(make_chain(test::ur10e_individual_a().joints)).design,
            Design::kParallelAxes);
  EXPECT_EQ(closed_form(make_chain(test::stanford().joints)).design, Design::kOther);
  EXPECT_EQ(closed_form(make_chain(test::iiwa7().joints)).design, Design::kOther);
}

TEST(ClosedForm, is_exact_for_arms_that_are_as_drawn) {
  std::mt19937_64 random(1);
  test::KnownArm folded = test::puma560();  // axes 2 and 3 parallel the other way round
  folded.joints[1].alpha_rad = kPi;
  folded.joints[2].d_m = 0.05;
  test::KnownArm offset_base = test::puma560();  // as most industrial arms
  offset_base.joints[0].a_m = 0.15;
  offset_base.joints[0].d_m = 0.4;
  for (const test::KnownArm& arm :
       {test::puma560(), test::ur5(), test::ur10e(), folded, offset_base}) {
    const Chain chain = make_chain(arm.joints);
    const ClosedForm form = closed_form(chain);
    ASSERT_NE(form.design, Design::kOther);
    for (int k = 0; k < 500; ++k) {
      const Pose X = *forward(chain, test::random_readings(arm, random));
      for (const Posture& posture : kPostures) {
        const Start start = solve_closed_form(form, X, posture);
        if (!start.reachable || start.near_fold) continue;
        EXPECT_LT(test::pose_difference(*forward(chain, start.q), X), 1e-8) << arm.name;
        EXPECT_EQ(posture_of(form, start.q), posture) << arm.name;
      }
    }
  }
}

// Joint 1 at zero points the Puma along +x with its upper arm at y = +149 mm: to the left. With the
// forearm hanging from a raised upper arm the elbow is above.
TEST(Posture, of_the_puma_is_named_as_in_val) {
  const ClosedForm form = closed_form(make_chain(test::puma560().joints));
  const Posture posture = posture_of(form, {0, radians(-45), radians(150), 0, radians(30), 0});
  EXPECT_TRUE(posture.lefty);
  EXPECT_TRUE(posture.above);
  EXPECT_FALSE(posture.flip);
}

// Axes 2, 3 and 4 parallel the same way round, no length between axes 5 and 6, a forearm.
TEST(ClosedForm, is_none_where_an_arm_departs_from_the_design) {
  const auto design_of = [](auto change) {
    DhRows rows = test::ur5().joints;
    change(rows);
    return closed_form(make_chain(rows)).design;
  };
  EXPECT_EQ(design_of([](DhRows&) {}), Design::kParallelAxes);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[1].alpha_rad = kPi; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[2].alpha_rad = kPi; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[4].a_m = 0.1; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[2].a_m = 0; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[1].a_m = 0; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[3].alpha_rad = 1; }), Design::kOther);
}

// Nearly parallel axes of the UR10e have rows of hundreds of metres: what they turn one link by is
// taken back by the next.
TEST(ClosedForm, starts_within_two_centimetres_of_identified_arms) {
  std::mt19937_64 random(1);
  for (const test::KnownArm& arm : {test::puma560_robot1(), test::puma560_robot2(),
                                    test::ur10e_individual_a(), test::ur10e_individual_b()}) {
    const Chain chain = make_chain(arm.joints);
    const ClosedForm form = closed_form(chain);
    for (int k = 0; k < 200; ++k) {
      const Pose X = *forward(chain, test::random_readings(arm, random));
      for (const Posture& posture : kPostures) {
        const Start start = solve_closed_form(form, X, posture);
        if (!start.reachable || start.near_fold) continue;
        EXPECT_LT(test::pose_difference(*forward(chain, start.q), X), 0.02) << arm.name;
      }
    }
  }
}

// A bent shoulder, a flat upper arm, a wrist whose axes meet, a forearm.
TEST(ClosedForm, is_none_where_a_puma_departs_from_the_design) {
  const auto design_of = [](auto change) {
    DhRows rows = test::puma560().joints;
    change(rows);
    return closed_form(make_chain(rows)).design;
  };
  EXPECT_EQ(design_of([](DhRows&) {}), Design::kSphericalWrist);
  for (const std::size_t bent : {0, 3, 4}) {
    EXPECT_EQ(design_of([&](DhRows& rows) { rows[bent].alpha_rad = 0; }), Design::kOther) << bent;
  }
  EXPECT_EQ(design_of([](DhRows& rows) { rows[1].alpha_rad = kPi / 2; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[3].a_m = 0.1; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[4].d_m = 0.1; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[4].a_m = 0.1; }), Design::kOther);
  EXPECT_EQ(design_of([](DhRows& rows) { rows[2].a_m = rows[3].d_m = 0; }), Design::kOther);
  Chain aside = make_chain(test::puma560().joints);
  aside.y[0] = 0.1;  // across the common normal, as no row of Denavit and Hartenberg has it
  EXPECT_EQ(closed_form(aside).design, Design::kOther);
}

}  // namespace
}  // namespace armsig::kinematics
