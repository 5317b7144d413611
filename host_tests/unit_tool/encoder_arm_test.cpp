// SPDX-License-Identifier: MIT
// What encoders must read, and what they may: poses in which an arm stands are never refused.
#include "firmware/library/encoder_arm.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "core/base/couplings.hpp"
#include "core/calibration/model.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"

namespace armsig::tool {
namespace {

// As individuals are, so that no closed form is exact.
Arm individual(std::string_view name, std::mt19937& random) {
  Arm arm = read_arm(std::string(name)).value().arm;
  std::normal_distribution<double> normal;
  for (DhJoint& joint : arm.joints) {
    joint.alpha_rad += 1e-3 * normal(random);
    joint.a_m += 3e-4 * normal(random);
  }
  return arm;
}

EncoderArm encoder_arm(const Arm& arm, const calibration::ArmModel* deflections = nullptr) {
  EncoderArm::Parts parts;
  parts.chain = kinematics::make_chain(arm.joints, effective_limits(arm));
  parts.readings.couplings = arm.couplings;
  parts.readings.deflections = deflections;
  parts.configuration.resize(arm.joints.size());
  parts.limits = arm.limits;
  return EncoderArm(parts);
}

JointVector readings_inside(const Arm& arm, std::mt19937& random) {
  JointVector q;
  for (const JointLimits& limits : arm.limits) {
    q.push_back(std::uniform_real_distribution<double>(limits.lower, limits.upper)(random));
  }
  return q;
}

// At poses in which the arm stands with `at_limit` of its joints at a limit: how many are refused.
int refused(const EncoderArm& encoders, const Arm& arm, int at_limit, std::mt19937& random) {
  constexpr int kPoses = 40;
  int refused = 0;
  for (int k = 0; k < kPoses; ++k) {
    JointVector q = readings_inside(arm, random);
    for (int n = 0; n < at_limit; ++n) {
      const std::size_t j = random() % q.size();
      q[j] = random() % 2 == 0 ? arm.limits[j].lower : arm.limits[j].upper;
    }
    const Pose X_BF = encoders.forward(q).value();
    const auto all = encoders.solutions(X_BF).value();
    if (all.empty() || !is_solved(all[0].verdict)) {
      ++refused;
      continue;
    }
    for (const FoundReadings& one : all) {
      if (!is_solved(one.verdict)) continue;
      for (std::size_t j = 0; j < q.size(); ++j) {
        EXPECT_GE(one.readings[j], arm.limits[j].lower);
        EXPECT_LE(one.readings[j], arm.limits[j].upper);
      }
      const Pose X_BA = encoders.forward(one.readings).value();
      EXPECT_LT((X_BA.p - X_BF.p).norm(), 1e-8);
      // Arms of fewer joints meet the position.
      if (q.size() >= 6) EXPECT_LT((X_BA.R - X_BF.R).norm(), 1e-8);
    }
  }
  return refused;
}

TEST(EncoderArm, is_not_refused_where_it_stands_whatever_joint_is_at_its_limit) {
  std::mt19937 random(44);
  for (const KnownArm& known : known_arms()) {
    const Arm arm = individual(known.name, random);
    for (const int at_limit : {0, 1, 2}) {
      EXPECT_EQ(refused(encoder_arm(arm), arm, at_limit, random), 0) << known.name;
    }
  }
}

// Limits are those of the encoders, and the joints turn beyond what they read.
TEST(EncoderArm, is_not_refused_at_a_limit_where_gravity_bends_it) {
  std::mt19937 random(66);
  for (const std::string_view name : {"puma560", "ur10e", "lrmate200id", "irb120"}) {
    const Arm arm = individual(name, random);
    calibration::ArmModel model = calibration::model_of(arm, {});
    calibration::choose_gravity_terms(arm, model);
    for (calibration::GravityTerm& term : model.gravity) term.coefficient = 2e-3;
    EXPECT_EQ(refused(encoder_arm(arm, &model), arm, 1, random), 0) << name;
  }
}

// The third reading of this arm goes against the horizontal, and the second joint turns it along.
TEST(EncoderArm, turns_a_coupled_joint_into_the_limits_of_its_own_reading) {
  const Arm arm = read_arm("lrmate200id").value().arm;
  const EncoderArm encoders = encoder_arm(arm);
  const JointVector stands{0.9, 2.0, 3.3, 1.1, 1.0, 0.8};
  const auto all = encoders.solutions(encoders.forward(stands).value()).value();
  const auto same = [&](const FoundReadings& one) {
    return is_solved(one.verdict) && largest_change(one.readings, stands) < 1e-8;
  };
  EXPECT_TRUE(std::ranges::any_of(all, same));
  EXPECT_TRUE(is_solved(all[0].verdict));
}

}  // namespace
}  // namespace armsig::tool
