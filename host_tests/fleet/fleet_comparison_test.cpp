// SPDX-License-Identifier: MIT
// Two signatures as their documents say them, held against each other joint by joint.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/fleet/host/signature_comparison.hpp"
#include "firmware/fleet/wire/signature_document.hpp"

namespace armsig::fleet {
namespace {

// A PUMA 560 as the controller tells it, with one value changed.
std::string puma(const std::string& key = "", double value = 0) {
  const std::array<std::array<double, 4>, 6> rows{{{0, 0, 0, -90},
                                                   {0, 149.09, 431.8, 0},
                                                   {90, 0, -20.32, 90},
                                                   {0, 433.07, 0, -90},
                                                   {0, 0, 0, 90},
                                                   {0, 56.25, 0, 0}}};
  const std::array<std::pair<std::string, std::string>, 4> names{
      {{"theta", "_deg"}, {"d", "_mm"}, {"a", "_mm"}, {"alpha", "_deg"}}};
  std::string document;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string name = names[k].first + std::to_string(i + 1) + names[k].second;
      if (!document.empty()) document += ' ';
      document += name + '=' + std::to_string(name == key ? value : rows[i][k]);
    }
  }
  return document;
}

TEST(FleetComparison, SameSignaturesDifferByNothing) {
  const auto compared = compare_signatures(puma(), puma());
  ASSERT_TRUE(compared);
  ASSERT_EQ(compared->joints.size(), 6U);
  EXPECT_LT(compared->tool_rms_m, 1e-9);
}

// A row's a, alpha and theta move the next axis, the next axis, and the joint's own zero.
TEST(FleetComparison, ChangeIsToldAtTheJointWhereItIs) {
  auto compared = compare_signatures(puma(), puma("a2_mm", 432.8));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].shift_m, i == 2 ? 1e-3 : 0, 1e-7) << i;
    EXPECT_NEAR(compared->joints[i].tilt_rad, 0, 1e-7) << i;
  }
  EXPECT_GT(compared->tool_rms_m, 1e-4);
  compared = compare_signatures(puma(), puma("alpha3_deg", 90.05));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].tilt_rad, i == 3 ? radians(0.05) : 0, 1e-6) << i;
  }
  compared = compare_signatures(puma(), puma("theta5_deg", 0.1));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].zero, i == 4 ? radians(0.1) : 0, 1e-6) << i;
  }
}

constexpr std::array kPolar{JointType::kRevolute, JointType::kRevolute, JointType::kPrismatic};
const std::vector<double> kRest{0.1, 0.3, 0.5};

// A slide, a map, gravity: a polar arm whose third joint is prismatic. Every knot of the map of
// joint 2 is `knot`, half a turn of them `wave` more.
std::string polar(double d3_mm, int knot, double sag, int wave = 0,
                  const std::vector<double>& rest = kRest) {
  const std::string rows =
      "theta1_deg=0 d1_mm=400 a1_mm=0 alpha1_deg=-90 theta2_deg=0 d2_mm=100 a2_mm=0 alpha2_deg=90 "
      "theta3_deg=0 d3_mm=" +
      std::to_string(d3_mm) + " a3_mm=0 alpha3_deg=0 ";
  calibration::PackedDeflections deflections;
  for (const JointType type : kPolar) {
    const bool slides = type == JointType::kPrismatic;
    const JointLimits limits = slides ? JointLimits{0.1, 0.9} : JointLimits{-2, 2};
    deflections.maps.push_back({.domain = calibration::map_domain(type, limits), .step = 1e-8});
  }
  deflections.drawn_zero = {0.1, -0.2, 0.3};
  for (std::size_t k = 0; k < calibration::kKnots; ++k) {
    const bool on_wave = k < calibration::kKnots / 2;
    deflections.maps[1].steps[k] = static_cast<std::int16_t>(on_wave ? knot + wave : knot);
  }
  deflections.gravity.push_back({.joint = 1, .origin = 3, .coefficient = sag});
  return signature_document(rows.substr(0, rows.size() - 1), kPolar, deflections, rest);
}

TEST(FleetComparison, SlideIsASlideAndMapsAndGravityAreHeldAgainstEachOther) {
  const auto same = compare_signatures(polar(0, 5000, 1e-4), polar(0, 5000, 1e-4));
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->bends);
  EXPECT_EQ(same->joints[2].type, JointType::kPrismatic);
  for (const JointDifference& joint : same->joints) {
    EXPECT_LT(joint.map + joint.gravity + std::abs(joint.zero), 1e-12);
  }
  const auto changed = compare_signatures(polar(2, 5000, 1e-4), polar(3, 9000, 3e-4));
  ASSERT_TRUE(changed);
  // The splines of a map whose knots are all the same sum up to that.
  EXPECT_NEAR(changed->joints[1].map, 4000e-8, 1e-12);
  EXPECT_NEAR(changed->joints[1].gravity, 2e-4, 1e-12);
  EXPECT_EQ(changed->joints[0].map, 0);
  EXPECT_EQ(changed->joints[2].gravity, 0);
}

// From the readings on at which the joints stand as the rows say: what a map has there is in them.
TEST(FleetComparison, MapsAndGravityAreInTheSumAtTheTool) {
  const auto at_the_tool = [](const std::string& now) {
    const auto compared = compare_signatures(polar(0, 0, 1e-4), now);
    EXPECT_TRUE(compared && compared->whole);
    if (!compared) return 0.0;
    double sum = 0;
    for (const JointDifference& joint : compared->joints) sum += joint.adds_m;
    EXPECT_NEAR(sum, compared->tool_rms_m, 1e-3 * compared->tool_rms_m + 1e-12);
    return compared->tool_rms_m;
  };
  EXPECT_LT(at_the_tool(polar(0, 5000, 1e-4)), 1e-9) << "the same everywhere";
  // 1e-4 rad over half a turn, at half a metre of slide and 0.1 m of tool: 30 um to either side.
  EXPECT_NEAR(at_the_tool(polar(0, 0, 1e-4, 10'000)), 25e-6, 10e-6);
  // 3e-4 rad for a metre of lever, which is the slide: over its metre in all directions 84 um, and
  // 97 um that the joint stands off by at all readings but those at rest.
  EXPECT_NEAR(at_the_tool(polar(0, 0, 4e-4)), 128e-6, 15e-6);
}

TEST(FleetComparison, WhereADocumentDoesNotSayFromWhereTheSumIsWithoutThem) {
  const auto compared = compare_signatures(polar(0, 0, 1e-4), polar(0, 0, 4e-4, 10'000, {}));
  ASSERT_TRUE(compared);
  EXPECT_TRUE(compared->bends);
  EXPECT_FALSE(compared->whole);
  EXPECT_LT(compared->tool_rms_m, 1e-9);
  EXPECT_GT(compared->joints[1].map, 0.9e-4);
}

TEST(FleetComparison, DocumentSaysWhatTheRecordDoes) {
  const std::string document = polar(0, -321, 1.5e-5);
  const auto read = read_signature_document(document);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->arm.joints.size(), 3U);
  EXPECT_EQ(read->arm.joints[2].type, JointType::kPrismatic);
  EXPECT_EQ(read->deflections.maps[1].steps[119], -321);
  EXPECT_EQ(read->deflections.drawn_zero[1], -0.2);
  const std::string rows = document.substr(0, document.find(" type3"));
  EXPECT_EQ(std::vector(read->configuration.begin(), read->configuration.end()), kRest);
  EXPECT_EQ(signature_document(rows, kPolar, read->deflections, kRest), document);
  const std::string former = polar(0, -321, 1.5e-5, 0, {});
  const auto of_a_former_version = read_signature_document(former);
  ASSERT_TRUE(of_a_former_version);
  EXPECT_TRUE(of_a_former_version->configuration.empty());
  EXPECT_EQ(signature_document(rows, kPolar, of_a_former_version->deflections, {}), former);
  // An arm that is all revolute and does not bend keeps the document, and the hash, that it had.
  const std::array<JointType, 6> revolute{};
  EXPECT_EQ(signature_document(puma(), revolute, {}, {}), puma());
  EXPECT_FALSE(compare_signatures(rows, document));  // a slide is no revolute joint
}

TEST(FleetComparison, DocumentCutAnywhereOrBeyondAnyArmIsNone) {
  const std::string document = polar(0, 100, 1e-4);
  const std::size_t maps = document.find(" zero1_rad");
  for (std::size_t size = maps + 1; size < document.size(); ++size) {
    const std::string cut = document.substr(0, size);
    if (const auto read = read_signature_document(cut)) {
      // Before a gravity term, or within its number.
      EXPECT_GE(size, document.find(" gravity=")) << cut;
    }
  }
  for (const auto& [what, with] :
       {std::pair{"map2_step_rad=1e-08", "map2_step_rad=1"},
        std::pair{"gravity=2,3,", "gravity=2,9,"}, std::pair{"gravity=2,3,0.0001", "gravity=2,3,1"},
        std::pair{" rest2_rad=0.3", ""}, std::pair{" rest1_rad=0.1", ""},
        std::pair{"rest3_m=0.5", "rest3_m=nan"}, std::pair{"rest3_m=0.5", "rest3_rad=0.5"},
        std::pair{"type3=prismatic", "type3=round"}, std::pair{"map1=0,0", "map1=0"},
        std::pair{"map1=0,0", "map1=0,0,0"}, std::pair{"map1=0,0", "map1=40000,0"},
        std::pair{"zero1_rad=0.1", "zero1_rad=inf"}}) {
    std::string changed = document;
    const std::size_t at = changed.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    changed.replace(at, std::string(what).size(), with);
    EXPECT_FALSE(read_signature_document(changed)) << with;
  }
}

// Rows near parallel axes are metres apart for a microradian; the axes are not.
TEST(FleetComparison, NearlyParallelAxesAreComparedAsLines) {
  const auto compared = compare_signatures(puma(), puma("alpha2_deg", 0.001));
  ASSERT_TRUE(compared);
  EXPECT_NEAR(compared->joints[2].tilt_rad, radians(0.001), 1e-7);
  EXPECT_LT(compared->joints[2].shift_m, 1e-6);
}

TEST(FleetComparison, NothingThatAnArmSaysIsTooMuch) {
  for (const char* document :
       {"", "theta1_deg", "theta1_deg=", "theta1_deg=nan d1_mm=0 a1_mm=0 alpha1_deg=0",
        "theta1_deg=1 d1_mm=1 a1_mm=1", "theta2_deg=1 d2_mm=1 a2_mm=1 alpha2_deg=1",
        "theta1_deg=1,d1_mm=1 a1_mm=1 alpha1_deg=1"}) {
    EXPECT_FALSE(read_signature_document(document)) << document;
    EXPECT_FALSE(compare_signatures(puma(), document)) << document;
  }
  for (const std::string key : {"theta3_deg", "d3_mm", "a3_mm", "alpha3_deg"}) {
    for (const double value : {1e8, -9e8, 1e-300, 180.0, 90.0}) {
      EXPECT_TRUE(read_signature_document(puma(key, value)));
      (void)compare_signatures(puma(), puma(key, value));
      (void)compare_signatures(puma(key, value), puma());
    }
  }
  const std::string one = "theta1_deg=0 d1_mm=0 a1_mm=0 alpha1_deg=0";
  ASSERT_TRUE(read_signature_document(one));
  (void)compare_signatures(one, one);
}

}  // namespace
}  // namespace armsig::fleet
