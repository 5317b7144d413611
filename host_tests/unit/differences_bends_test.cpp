// SPDX-License-Identifier: MIT
// Maps of the readings and gravity among what is different about an arm.
#include <cmath>
#include <memory>

#include "core/base/links.hpp"
#include "core/identification.hpp"
#include "firmware/analysis/differences/bends.hpp"
#include "firmware/analysis/differences/difference_effects.hpp"
#include "firmware/analysis/differences/differences.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::differences {
namespace {

// A map that is a cosine is an eccentric encoder disc, and so is gravity about a level axis.
struct Bent {
  calibration::ArmModel model;
  Bending bending;
};

constexpr double kSize_rad = 1e-3;
constexpr std::size_t kShoulder = 1;

std::unique_ptr<Bent> bent(const Arm& arm, const JointVector& configuration) {
  auto made = std::make_unique<Bent>();
  made->model = calibration::model_of(arm, {});
  made->bending = {&made->model, configuration};
  return made;
}

// `bend` of each reading.
template <typename Function>
void lay(Function bend, calibration::ArmModel& model) {
  calibration::JointModel& joint = model.joints[kShoulder];
  for (std::size_t k = 0; k < calibration::kKnots; ++k) {
    // Of the four splines at a knot the second has its middle there.
    const double middle = static_cast<double>(k) - 1;
    const double reading = joint.domain.origin + middle / joint.domain.per_length;
    joint.map[k] = bend(reading) / calibration::map_unit(joint.type);
  }
}

void lay_cosine(double size_rad, calibration::ArmModel& model) {
  lay([&](double reading) { return size_rad * std::cos(reading); }, model);
}

class BentArm : public ::testing::Test {
 protected:
  // What the disc does, found as a correction of the reading.
  Differences by_disc(double size_rad) const {
    const auto estimate = as_drawn();
    for (std::size_t i = 0; i < 6; ++i) estimate->readings.corrections.push_back({});
    estimate->readings.corrections[kShoulder].cos_1 = size_rad;
    return found(*estimate, {});
  }
  Differences by(const Bendings& bendings) const { return found(*as_drawn(), bendings); }
  std::unique_ptr<calibration::Refined> as_drawn() const {
    const KnownTarget tool{1, drawing.joints.size(), Vector3(0.08, 0.03, 0.12)};
    const Pose X_S0{rotation_z(0.3) * rotation_x(0.2), Vector3(1, -2, 0.5)};
    auto estimate = std::make_unique<calibration::Refined>();
    estimate->signature = signature_of(drawing, configuration, X_S0, std::span(&tool, 1));
    return estimate;
  }
  Differences found(const calibration::Refined& estimate, const Bendings& bendings) const {
    auto result = differences(drawing, estimate, 0, bendings);
    EXPECT_TRUE(result.has_value());
    return result.value_or(Differences{});
  }
  static Difference one_of(const Differences& differences, Cause cause) {
    for (const Difference& d : differences.all) {
      if (d.joint == kShoulder && d.cause == cause) return d;
    }
    ADD_FAILURE() << "there is none of cause " << static_cast<int>(cause);
    return {};
  }
  static void expect_the_same(const Differences& differences, Cause cause,
                              const Differences& expected) {
    EXPECT_NEAR(differences.total_rms_m, expected.total_rms_m, 2e-3 * expected.total_rms_m);
    const Effect disc = one_of(expected, Cause::kOnceATurn).effect;
    const Effect effect = one_of(differences, cause).effect;
    EXPECT_NEAR(effect.rms_m, disc.rms_m, 2e-3 * disc.rms_m);
    EXPECT_NEAR(effect.adds_m, disc.adds_m, 2e-3 * disc.adds_m);
    EXPECT_NEAR(one_of(differences, cause).value, kSize_rad, 2e-3 * kSize_rad);
    double sum = 0;
    for (const Difference& d : differences.all) sum += d.effect.adds_m;
    EXPECT_NEAR(sum, differences.total_rms_m, 1e-3 * differences.total_rms_m);
  }

  const Arm drawing = test::puma560();
  // Where the disc is nought: the readings are what the axes say.
  const JointVector configuration = [] {
    JointVector q(6);
    q[kShoulder] = kPi / 2;
    return q;
  }();
};

TEST_F(BentArm, map_does_what_an_eccentric_disc_does) {
  const auto actual = bent(drawing, configuration);
  lay_cosine(kSize_rad, actual->model);
  expect_the_same(by({.drawn = {}, .actual = actual->bending}), Cause::kMap, by_disc(kSize_rad));
  // The change of a map, too.
  const auto drawn = bent(drawing, configuration);
  lay_cosine(0.5 * kSize_rad, drawn->model);
  lay_cosine(1.5 * kSize_rad, actual->model);
  expect_the_same(by({drawn->bending, actual->bending}), Cause::kMap, by_disc(kSize_rad));
}

TEST_F(BentArm, gravity_on_a_link_does_what_an_eccentric_disc_does) {
  const auto actual = bent(drawing, configuration);
  const double lever_m = drawing.joints[kShoulder].a_m;
  actual->model.gravity.push_back({kShoulder, kShoulder + 1, kSize_rad / lever_m});
  // Joint 2 turns about y of the base, forwards and down: where the arm is level the most.
  expect_the_same(by({.drawn = {}, .actual = actual->bending}), Cause::kGravity,
                  by_disc(kSize_rad));
}

TEST_F(BentArm, arm_that_gives_way_as_the_other_does_is_no_different) {
  const auto actual = bent(drawing, configuration);
  lay_cosine(kSize_rad, actual->model);
  actual->model.gravity.push_back({kShoulder, 3, 1e-3});
  EXPECT_LT(by({actual->bending, actual->bending}).total_rms_m, 1e-12);
}

// Both count from rest, where either is nought; by hand, at 0.4 rad from it.
TEST_F(BentArm, as_drawn_gives_way_by_map_and_gravity_together) {
  const auto drawn = bent(drawing, configuration);
  lay_cosine(kSize_rad, drawn->model);
  const double lever_m = drawing.joints[kShoulder].a_m;
  drawn->model.gravity.push_back({kShoulder, kShoulder + 1, kSize_rad / lever_m});
  JointVector q = configuration;
  q[kShoulder] += 0.4;
  const Bend bend = Bends({.drawn = drawn->bending, .actual = {}}).at(q, q);
  const double each = -kSize_rad * std::sin(0.4);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(bend.drawn[i], i == kShoulder ? 2 * each : 0, 2e-6) << i;
    EXPECT_NEAR(bend.more_by_map[i], i == kShoulder ? -each : 0, 2e-6) << i;
    EXPECT_NEAR(bend.more_by_gravity[i], i == kShoulder ? -each : 0, 2e-6) << i;
  }
}

// A map that is the same everywhere is none: the axes were found with it.
TEST_F(BentArm, what_gives_way_counts_from_the_configuration_of_the_signature) {
  const auto actual = bent(drawing, configuration);
  actual->model.joints[kShoulder].map.fill(kSize_rad / calibration::map_unit(JointType::kRevolute));
  EXPECT_LT(by({.drawn = {}, .actual = actual->bending}).total_rms_m, 1e-9);
}

TEST_F(BentArm, without_a_domain_has_no_map_whatever_its_coefficients) {
  const auto actual = bent(drawing, configuration);
  actual->model.joints[kShoulder].domain = {};
  actual->model.joints[kShoulder].map.fill(5);
  const Differences differences = by({.drawn = {}, .actual = actual->bending});
  for (const Difference& d : differences.all) EXPECT_NE(d.cause, Cause::kMap);
}

// Bent by a fifth of its reading, as drawn and in fact, a joint turns as one that goes a fifth
// further: what differs elsewhere does as much to the tool of either.
TEST_F(BentArm, is_compared_where_the_drawing_bends_to) {
  const auto both = bent(drawing, JointVector(6));
  lay([](double reading) { return 0.2 * std::remainder(reading, 2 * kPi); }, both->model);
  DeviatingChain chain{};
  chain.p_T = Vector3(0.08, 0.03, 0.12);
  chain.axes = drawn_axes(drawing, chain.p_T);
  chain.values[deviation_index(kShoulder + 1, Deviation::kZero)] = 1e-3;
  auto limits = drawing.limits;
  limits[kShoulder] = {-1.2, 1.2};
  const double further_m = difference_effects(chain, limits, 200).total_rms_m;
  limits[kShoulder] = {-1, 1};
  EXPECT_GT(std::abs(difference_effects(chain, limits, 200).total_rms_m / further_m - 1), 1e-3);
  chain.bendings = {both->bending, both->bending};
  EXPECT_NEAR(difference_effects(chain, limits, 200).total_rms_m, further_m, 1e-6 * further_m);
}

}  // namespace
}  // namespace armsig::differences
