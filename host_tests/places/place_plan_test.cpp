// SPDX-License-Identifier: MIT
// Planned touches against the simulation: do they reach what they promise, and can they be made?
#include "firmware/host_tool/places/place_plan.hpp"

#include <gtest/gtest.h>

#include "host_tests/places/task_of_session.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

using touching::Drawing;
using touching::Session;
using touching::Vector3d;
using touching::VectorXd;

constexpr double kSigma_m = 0.05e-3;
constexpr std::size_t kLookedAt = 40;
constexpr const char* kBars = R"(armsig: instrument/1
name: two bars
tool_mm: [0, 0, 150]
instruments: [{name: ball, kind: socket}]
lengths:
  - {from: A1, to: A2, length_mm: 300, sigma_mm: 0.02}
  - {from: B1, to: B2, length_mm: 300, sigma_mm: 0.02}
)";

ArmDescription described(const Drawing& drawing) {
  return *parse_arm(Session(drawing, 1).arm_yaml(), "arm.yaml");
}

Read<PlaceLayout> laid_out(const ArmDescription& arm, const std::string& instrument,
                           const Vector3& lower_B = Vector3::Constant(-10)) {
  const auto description = parse_instrument(instrument, "i.yaml");
  if (!description) return std::unexpected(description.error());
  clearance::Surroundings around = clearance::surroundings_of(arm.arm, arm.mounting);
  around.lower_B = lower_B;
  around.upper_B = Vector3::Constant(10);
  const TouchSearch search(arm.arm, description->tool_F, around);
  return lay_out(arm.arm, *description, search, kSigma_m, kLookedAt, "i.yaml");
}

VectorXd as_vector(const JointVector& q) {
  VectorXd readings(static_cast<Eigen::Index>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) readings[static_cast<Eigen::Index>(i)] = q[i];
  return readings;
}

// RMS over sessions of the planned touches of what was expected, and of what came of it.
struct Kept {
  double expected_m = 0;
  double observed_m = 0;
};

Kept kept_by(const Drawing& drawing, std::size_t touches) {
  constexpr unsigned kSeeds = 10;
  const ArmDescription arm = described(drawing);
  const auto layout = laid_out(arm, std::string(kBars) +
                                        "  - {from: C1, to: C2, length_mm: 300, sigma_mm: 0.02}\n"
                                        "  - {from: D1, to: D2, length_mm: 300, sigma_mm: 0.02}\n");
  EXPECT_TRUE(layout);
  const PlacePlan plan = plan_touches(*layout, kSigma_m, 1e-6, touches);
  EXPECT_EQ(plan.touches.size(), touches);
  EXPECT_FALSE(plan.is_whole);
  std::vector<VectorXd> judged;
  for (const JointVector& q : layout->judged) judged.push_back(as_vector(q));
  Kept kept{plan.expected_rms_m.back(), 0};
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Session session(drawing, seed);
    // A person sets the bars up some 50 mm beside.
    std::vector<Vector3> at_B = layout->middle_B;
    for (const SocketLength& bar : layout->task.lengths) {
      const Vector3 beside = 0.05 * touching::any_stem(session.random());
      at_B[bar.from] += beside;
      at_B[bar.to] += beside;
    }
    for (const SocketLength& bar : layout->task.lengths) {
      session.lengths().push_back({layout->task.places[bar.from].name,
                                   layout->task.places[bar.to].name,
                                   bar.length_m + bar.sigma_m * session.normal(), bar.sigma_m});
    }
    for (const std::size_t k : plan.touches) {
      const TouchRow& touch = layout->task.touches[k];
      session.touch_near(layout->task.places[touch.place].name, at_B[touch.place],
                         as_vector(touch.q));
    }
    const auto found = calibrated(session);
    EXPECT_TRUE(found) << "seed " << seed;
    if (!found) continue;
    const double error_m = session.tool_error_over_m(
        [&](const VectorXd& q) {
          JointVector readings;
          for (const double one : q) readings.push_back(one);
          return Vector3d(found->fit->state().tool_at(readings));
        },
        judged);
    kept.observed_m += error_m * error_m / kSeeds;
  }
  kept.observed_m = std::sqrt(kept.observed_m);
  return kept;
}

void expect_kept(const Kept& kept) {
  EXPECT_GT(kept.observed_m, 0.75 * kept.expected_m) << kept.expected_m;
  EXPECT_LT(kept.observed_m, 1.25 * kept.expected_m) << kept.expected_m;
}

TEST(PlacePlan, expects_of_a_ur5_what_its_touches_reach) {
  const Kept kept = kept_by(touching::ur5(), 80);
  expect_kept(kept);
  EXPECT_LT(kept.observed_m, 0.15e-3);
}

TEST(PlacePlan, expects_of_an_iiwa_what_its_touches_reach) {
  expect_kept(kept_by(touching::iiwa(), 80));
}

TEST(PlacePlan, has_the_tool_at_its_place_and_its_stem_within_75_degrees) {
  const ArmDescription arm = described(touching::puma560());
  const auto layout = laid_out(arm, kBars);
  ASSERT_TRUE(layout);
  std::mt19937 random(1);
  const touching::TrueArm drawn(touching::puma560(), {0, 0, 0, 0, 0}, random);
  ASSERT_GT(layout->task.touches.size(), 100U);
  for (const TouchRow& touch : layout->task.touches) {
    const touching::Frame flange = drawn.flange(as_vector(touch.q));
    const Vector3d ball = flange.p + flange.R * Vector3d(0, 0, 0.15);
    EXPECT_LT((ball - layout->middle_B[touch.place]).norm(), 1e-8);
    EXPECT_GE((flange.p - ball).normalized().z(), std::cos(75 * touching::kDegree) - 1e-12);
    EXPECT_TRUE(drawn.within(as_vector(touch.q)));
    EXPECT_GT(flange.p.z(), 0);
  }
}

TEST(PlacePlan, sets_bars_up_at_their_length_apart_from_each_other_and_above_the_table) {
  const auto layout = laid_out(described(touching::ur5()), kBars);
  ASSERT_TRUE(layout);
  ASSERT_EQ(layout->middle_B.size(), 4U);
  const auto& at = layout->middle_B;
  EXPECT_NEAR((at[0] - at[1]).norm(), 0.3, 1e-12);
  EXPECT_NEAR((at[2] - at[3]).norm(), 0.3, 1e-12);
  EXPECT_NEAR(at[0].z(), at[1].z(), 1e-12);
  for (const Vector3& middle_B : at) EXPECT_GT(middle_B.z(), 0.03);
  for (const std::size_t a : {0, 1}) {
    for (const std::size_t b : {2, 3}) EXPECT_GT((at[a] - at[b]).norm(), 0.1);
  }
}

TEST(PlacePlan, keeps_places_inside_the_box) {
  const auto layout = laid_out(described(touching::ur5()), kBars, Vector3(-10, -0.2, -10));
  ASSERT_TRUE(layout);
  for (const Vector3& middle_B : layout->middle_B) EXPECT_GE(middle_B.y(), -0.2);
}

TEST(PlacePlan, ends_where_the_accuracy_is_reached_and_no_touch_makes_it_worse) {
  const auto layout = laid_out(described(touching::ur5()), kBars);
  ASSERT_TRUE(layout);
  const PlacePlan plan = plan_touches(*layout, kSigma_m, 0.16e-3, 200);
  EXPECT_TRUE(plan.is_whole);
  ASSERT_GT(plan.expected_rms_m.size(), 20U);
  EXPECT_LE(plan.expected_rms_m.back(), 0.16e-3);
  EXPECT_GT(*(plan.expected_rms_m.end() - 2), 0.16e-3);
  EXPECT_TRUE(std::ranges::is_sorted(plan.expected_rms_m, std::greater{}));
}

// What is stated along the way is what a fit to the same touches would state.
TEST(PlacePlan, states_what_the_covariance_of_its_touches_gives) {
  const auto layout = laid_out(described(touching::ur5()), kBars);
  ASSERT_TRUE(layout);
  const PlacePlan plan = plan_touches(*layout, kSigma_m, 1e-6, 30);
  const PlaceScales scales = expected_scales(layout->task, kSigma_m);
  PlaceFit fit(layout->task, nominal_state(layout->task), {}, &scales);
  fit.foresee(plan.touches);
  const double rms_m = tool_knowledge(fit, layout->judged).rms_m;
  EXPECT_NEAR(plan.expected_rms_m.back(), rms_m, 1e-6 * rms_m);
}

TEST(PlacePlan, touches_every_place_four_times_however_little_is_asked) {
  const auto layout = laid_out(described(touching::ur5()), kBars);
  ASSERT_TRUE(layout);
  const PlacePlan plan = plan_touches(*layout, kSigma_m, 1, 200);
  std::vector<int> touched(4, 0);
  for (const std::size_t k : plan.touches) ++touched[layout->task.touches[k].place];
  for (const int count : touched) EXPECT_GE(count, 4);
  EXPECT_TRUE(plan.is_whole);
  const std::size_t least = plan.touches.size();
  EXPECT_TRUE(plan_touches(*layout, kSigma_m, 1, least).is_whole);
  EXPECT_FALSE(plan_touches(*layout, kSigma_m, 1, least - 1).is_whole);
}

TEST(PlacePlan, touches_a_plane_in_many_postures) {
  const auto layout = laid_out(described(touching::ur5()), R"(armsig: instrument/1
name: a plate
tool_mm: [0, 0, 150]
instruments: [{name: plate, kind: plane}]
places: {table: plate}
)");
  ASSERT_TRUE(layout);
  ASSERT_GT(layout->task.touches.size(), 20U);
  // The elbow bends to both sides.
  const auto bends_up = [](const TouchRow& touch) { return touch.q[2] > 0; };
  const auto up = std::ranges::count_if(layout->task.touches, bends_up);
  EXPECT_GE(up, 5);
  EXPECT_GE(static_cast<std::ptrdiff_t>(layout->task.touches.size()) - up, 5);
}

// Nothing that the arm reaches is in the lower half of the heights above its own foot.
TEST(PlacePlan, finds_places_of_an_arm_on_a_column_of_3_metres) {
  Drawing drawing = touching::ur5();
  drawing.rows[0].d = 3;
  const auto layout = laid_out(described(drawing), kBars);
  ASSERT_TRUE(layout) << render(layout.error());
  for (const Vector3& middle_B : layout->middle_B) EXPECT_GT(middle_B.z(), 1.8);
}

TEST(PlacePlan, crosses_no_two_bars) {
  std::string text = kBars;
  for (const char* name : {"C", "D", "E", "F"}) {
    text += std::string("  - {from: ") + name + "1, to: " + name +
            "2, length_mm: 500, sigma_mm: 0.02}\n";
  }
  const auto layout = laid_out(described(touching::ur5()), text);
  ASSERT_TRUE(layout) << render(layout.error());
  const auto& at = layout->middle_B;
  for (std::size_t a = 0; a < at.size(); a += 2) {
    for (std::size_t b = a + 2; b < at.size(); b += 2) {
      for (int k = 0; k <= 100; ++k) {
        for (int l = 0; l <= 100; ++l) {
          const Vector3 on_a = at[a] + (at[a + 1] - at[a]) * k / 100;
          const Vector3 on_b = at[b] + (at[b + 1] - at[b]) * l / 100;
          ASSERT_GT((on_a - on_b).norm(), 0.05) << a << " and " << b;
        }
      }
    }
  }
}

TEST(PlacePlan, plans_planes_and_wires_too) {
  const auto layout = laid_out(described(touching::ur5()), R"(armsig: instrument/1
name: plate and wires
tool_mm: [0, 0, 150]
instruments:
  - {name: plate, kind: plane}
  - {name: encoder, kind: wire, gain_sigma: 0, zero_mm: 20, zero_sigma_mm: 1}
places: {table: plate, W1: encoder, W2: encoder, W3: encoder}
)");
  ASSERT_TRUE(layout) << render(layout.error());
  const PlacePlan plan = plan_touches(*layout, kSigma_m, 1e-6, 150);
  EXPECT_LT(plan.expected_rms_m.back(), 0.25e-3);
  for (const TouchRow& touch : layout->task.touches) {
    const TouchedPlace& place = layout->task.places[touch.place];
    const Vector3 p_B = nominal_state(layout->task).tool_at(touch.q);
    if (place.kind == InstrumentKind::kPlane) {
      EXPECT_NEAR(place.point_B.dot(p_B), place.distance_m, 1e-8);
    } else {
      EXPECT_NEAR((place.point_B - p_B).norm(), touch.length_m + 0.02, 1e-12);
    }
  }
}

TEST(PlacePlan, refuses_a_description_without_places) {
  const auto failure = test::failure_of(laid_out(described(touching::ur5()), R"(armsig: instrument/1
name: a ball
tool_mm: [0, 0, 150]
instruments: [{name: ball, kind: socket}]
)"));
  EXPECT_EQ(failure.what, "no place is named");
}

TEST(PlacePlan, refuses_a_socket_of_two_bars_by_its_line) {
  const auto failure = test::failure_of(
      laid_out(described(touching::ur5()),
               std::string(kBars) + "  - {from: A1, to: C1, length_mm: 300, sigma_mm: 0.02}\n"));
  EXPECT_EQ(failure.what, "a second length with A1");
  EXPECT_EQ(failure.line, 8);
}

TEST(PlacePlan, refuses_a_bar_that_is_longer_than_the_arm_reaches) {
  const auto failure = test::failure_of(
      laid_out(described(touching::ur5()),
               std::string(kBars) + "  - {from: C1, to: C2, length_mm: 5000, sigma_mm: 0.02}\n"));
  EXPECT_EQ(failure.what, "the bar C1 to C2 can stand nowhere that was tried");
}

}  // namespace
}  // namespace armsig::tool
