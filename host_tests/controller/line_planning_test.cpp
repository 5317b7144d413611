// SPDX-License-Identifier: MIT
// Lines are planned in bounded steps, while everything else goes on.
#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

struct Straight {
  Configuration configuration = test::puma_controller();
  Model model = model_of(configuration.drawing);
  JointVector from{radians(0), radians(-90), radians(10), radians(30), radians(40), radians(0)};
  Pose to = *tool_pose(model, from);
  Straight() { to.p += Vector3(0.05, 0, -0.1); }
};

// A sample is one inverse from 1 % of the line away: some 13,000 instructions
// (firmware/selftest_m7).
TEST(LinePlanning, takes_at_most_five_samples_a_step) {
  Straight line;
  LinePlanning planning(line.configuration, line.model, line.from, line.to, 1);
  int steps = 1;
  while (planning.step()) ++steps;
  EXPECT_GE(steps, (kLineSamples + 1) / 5);
  ASSERT_TRUE(planning.result());
  const Planned whole = plan_line(line.configuration, line.model, line.from, line.to);
  ASSERT_TRUE(whole);
  EXPECT_EQ(planning.result()->duration_s, whole->duration_s);
}

// Also of lines that end where the arm does not: the inverse takes its time before it gives up. A
// pass that leads nowhere takes some 16,000 instructions of the R5F, a step may take 180,000.
TEST(LinePlanning, takes_a_bounded_number_of_passes_a_step_wherever_the_line_leads) {
  constexpr int kMost = 10;
  for (const Vector3& way : {Vector3(0.05, 0, -0.1), Vector3(0.4, 0, 0), Vector3(1.0, 0, 0),
                             Vector3(0, 0, 0.9), Vector3(0, -0.8, 0), Vector3(-0.6, 0.2, 0)}) {
    Straight line;
    line.to = *tool_pose(line.model, line.from);
    line.to.p += way;
    LinePlanning planning(line.configuration, line.model, line.from, line.to, 1);
    int before = 0;
    do {
      ASSERT_LE(planning.passes() - before, kMost) << way.transpose();
      before = planning.passes();
    } while (planning.step());
    ASSERT_LE(planning.passes() - before, kMost) << way.transpose();
  }
}

// Of this line the first sample that is out of reach begins with a step of its own.
TEST(LinePlanning, gives_a_sample_up_after_as_many_passes_as_the_inverse_has) {
  Straight line;
  line.to = *tool_pose(line.model, line.from);
  line.to.p.z() -= 1;
  LinePlanning planning(line.configuration, line.model, line.from, line.to, 1);
  int before = 0;
  int in_full_steps = 0;
  for (bool more = true; more;) {
    more = planning.step();
    const int passes = planning.passes() - before;
    in_full_steps = passes == kPassesAStep ? in_full_steps + passes : 0;
    before = planning.passes();
  }
  EXPECT_EQ(test::failure_of(planning.result()).error, Error::kOutOfReach);
  EXPECT_EQ(in_full_steps, kinematics::InverseOptions{}.max_iterations);
}

TEST(LinePlanning, ends_where_the_line_does) {
  Straight line;
  const Planned planned = plan_line(line.configuration, line.model, line.from, line.to, 0.5);
  ASSERT_TRUE(planned);
  EXPECT_LT((tool_pose(line.model, planned->to)->p - line.to.p).norm(), 1e-9);
  const Planned faster = plan_line(line.configuration, line.model, line.from, line.to);
  EXPECT_NEAR(planned->duration_s, 2 * faster->duration_s, 1e-12);
}

TEST(LinePlanning, keeps_no_other_operator_waiting) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.bend_wrist());
  puma.console.requests.emplace_back("move dz_mm=-100 dx_mm=50");
  puma.other.requests.emplace_back("status");
  puma.run(0.008);
  EXPECT_EQ(puma.other.replies.size(), 1U) << "while the line is planned";
  EXPECT_EQ(puma.console.replies.size(), 2U);
  EXPECT_TRUE(puma.ask(puma.other, "move q1_deg=1").starts_with("error WRONG_MODE "));
  EXPECT_EQ(puma.ask(puma.other, "stop"), "ok");
  puma.run(0.1);
  ASSERT_EQ(puma.console.replies.size(), 3U);
  EXPECT_TRUE(puma.console.replies.back().starts_with("error WRONG_MODE "));
}

}  // namespace
}  // namespace armsig::controller
