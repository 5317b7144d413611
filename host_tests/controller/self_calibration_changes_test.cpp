// SPDX-License-Identifier: MIT
// The arm that calibrates itself while a target slips, a load comes, or points are wrong.
#include <gtest/gtest.h>

#include "host_tests/support/self_calibrating_puma.hpp"

namespace armsig::controller {
namespace {

// Asks, and runs until the arm holds again; before every step `happens` gets the sequence.
template <typename Happens>
void calibrate_while(BentPuma& puma, Happens happens) {
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify accuracy_mm=0.15 minutes=40"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  for (int i = 0; i < 2'000'000 && puma.mode() != Mode::kHolding; ++i) {
    happens(puma.cabinet->state().identification());
    puma.cabinet->step();
  }
  ASSERT_EQ(puma.mode(), Mode::kHolding);
}

void expect_no_model(BentPuma& puma, const std::string& changed) {
  const std::string told = puma.heard("# identify accuracy=");
  EXPECT_TRUE(told.starts_with("# identify accuracy=missed model=none changed=" + changed)) << told;
  EXPECT_NE(puma.heard("is elsewhere when it is measured again; look at the "), "");
  EXPECT_TRUE(puma.heard("# identify ended ").contains("error=NOT_CONVERGED"));
  EXPECT_TRUE(puma.ask("accept").starts_with("error NO_CANDIDATE"));
}

TEST(SelfCalibration, names_a_target_that_slips_while_it_is_measured_and_keeps_no_model) {
  BentPuma puma;
  bool slipped = false;
  calibrate_while(puma, [&](const IdentificationSequence& sequence) {
    if (slipped || sequence.points_done() < 190) return;
    slipped = true;
    puma.cabinet->arm().targets[0].p_L += Vector3(0.6e-3, -0.5e-3, 0.6e-3);
  });
  ASSERT_TRUE(slipped);
  expect_no_model(puma, "target ");
  EXPECT_NEAR(value_after(puma.heard("# identify accuracy="), "by_mm"), 0.98, 0.25);
}

TEST(SelfCalibration, names_a_load_that_comes_after_the_sweeps_and_keeps_no_model) {
  BentPuma puma;
  bool loaded = false;
  calibrate_while(puma, [&](const IdentificationSequence& sequence) {
    if (loaded || sequence.stage() != IdentificationSequence::Stage::kRefining) return;
    loaded = true;
    for (auto& term : puma.cabinet->bent()->gravity) term.coefficient *= 4;
  });
  ASSERT_TRUE(loaded);
  expect_no_model(puma, "load ");
}

TEST(SelfCalibration, is_not_led_astray_by_a_fifth_of_its_points) {
  BentPuma puma;
  simulated::Random random(5);
  const Vector3 p_L = puma.world.arm.targets[0].p_L;
  std::size_t points = 0;
  calibrate_while(puma, [&](const IdentificationSequence& sequence) {
    // Those that judge the candidate are sound.
    const bool judged = sequence.stage() == IdentificationSequence::Stage::kHeldOut;
    if (sequence.points_done() == points && !judged) return;
    points = sequence.points_done();
    const bool wrong = !judged && random.uniform(0, 1) < 0.2;
    const Vector3 way = random.normal_vector().normalized();
    puma.cabinet->arm().targets[0].p_L = p_L + (wrong ? 20e-3 : 0.0) * way;
  });
  puma.cabinet->arm().targets[0].p_L = p_L;
  const auto& sequence = puma.cabinet->state().identification();
  ASSERT_TRUE(sequence.has_verdict()) << puma.console.told.back();
  const std::string told = puma.heard("# identify accuracy=");
  EXPECT_TRUE(told.contains(" model=maps ")) << told;
  EXPECT_NEAR(value_after(told, "rejected") / value_after(told, "fitted"), 0.2, 0.08) << told;
  EXPECT_GE(value_after(told, "outliers"), 1) << told;
  const double miss_mm = 1e3 * puma.miss_m(*sequence.candidate(), 100);
  EXPECT_NEAR(value_after(told, "predicted_tool_error_mm") / miss_mm, 1.1, 0.4) << told;
}

}  // namespace
}  // namespace armsig::controller
