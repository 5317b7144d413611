// SPDX-License-Identifier: MIT
// Seven axes meet a pose along curves: no random start of an independent method, moved along the
// free joint, comes nearer to the middle of the limits than the first of the list.
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/support/independent_postures.hpp"
#include "host_tests/support/posture_kinds.hpp"

namespace armsig::test {
namespace {

using kinematics::Solutions;
using kinematics::Verdict;

constexpr int kSevenStarts = 100;

class MiddleSearch {
 public:
  MiddleSearch(const KnownArm& arm, const JointVector& q)
      : arm_(arm), exact_(arm.joints), target_(exact_.place(wide(q))) {}

  // The largest distance from the middle over all joints; infinite outside the limits.
  [[nodiscard]] double distance(const Eigen::VectorXd& q) const {
    double most = 0;
    for (std::size_t i = 0; i < arm_.limits.size(); ++i) {
      const JointLimits& limit = arm_.limits[i];
      const double middle = 0.5 * (limit.lower + limit.upper);
      double best = 1e9;
      for (const double turn : {-2 * kPi, 0.0, 2 * kPi}) {
        const double reading = q[static_cast<Eigen::Index>(i)] + turn;
        if (reading < limit.lower || reading > limit.upper) continue;
        best = std::min(best, std::abs(reading - middle));
      }
      most = std::max(most, best);
    }
    return most;
  }

  // The least found by `starts` starts, each moved along its curve as far as that helps.
  double least(int starts, std::mt19937_64& random) const {
    double least = 1e9;
    for (int k = 0; k < starts; ++k) {
      IndependentArm<double>::Readings q(7);
      for (Eigen::Index i = 0; i < 7; ++i) {
        const JointLimits& limit = arm_.limits[static_cast<std::size_t>(i)];
        q[i] = uniform(random, limit.lower, limit.upper);
      }
      if (!meet(q)) continue;
      for (Eigen::Index i = 0; i < 7; ++i) q[i] = std::remainder(q[i], 2 * kPi);
      double at = distance(q);
      double step = 0.1;
      while (step > 1e-4) {
        bool better = false;
        for (const double by : {step, -step}) {
          auto next = q;
          next += by * free_direction(q);
          if (!meet(next)) continue;
          const double there = distance(next);
          if (there >= at) continue;
          q = next;
          at = there;
          better = true;
          break;
        }
        if (!better) step *= 0.5;
      }
      least = std::min(least, at);
    }
    return least;
  }

  [[nodiscard]] Pose target() const {
    Pose X;
    X.R = target_.R.cast<double>();
    X.p = target_.p.cast<double>();
    return X;
  }
  [[nodiscard]] double miss(const JointVector& q) const {
    return static_cast<double>(
        IndependentArm<long double>::error(target_, exact_.place(wide(q))).norm());
  }

 private:
  static IndependentArm<long double>::Readings wide(const JointVector& q) {
    IndependentArm<long double>::Readings all(static_cast<Eigen::Index>(q.size()));
    for (std::size_t i = 0; i < q.size(); ++i) {
      all[static_cast<Eigen::Index>(i)] = static_cast<long double>(q[i]);
    }
    return all;
  }
  bool meet(IndependentArm<double>::Readings& q) const {
    return fast_.approach({target_.R.cast<double>(), target_.p.cast<double>()}, q, 1e-9, 60) <=
           1e-8;
  }
  Eigen::VectorXd free_direction(const IndependentArm<double>::Readings& q) const {
    IndependentArm<double>::JacobianS J;
    fast_.place(q, &J);
    const Eigen::MatrixXd any = J;
    return Eigen::JacobiSVD<Eigen::MatrixXd>(any, Eigen::ComputeFullV).matrixV().col(6);
  }

  const KnownArm& arm_;
  IndependentArm<long double> exact_;
  IndependentArm<double> fast_{arm_.joints};
  IndependentArm<long double>::Frame target_;
};

std::vector<KnownArm> seven_axis_arms() {
  std::vector<KnownArm> arms;
  for (const tool::KnownArm& known : tool::known_arms()) {
    const auto described = tool::read_arm(std::string(known.name));
    const KnownArm arm = drawn(std::string(known.name), described->arm);
    if (arm.joints.size() == 7) arms.push_back(arm);
  }
  return arms;
}

TEST(SevenAxes, are_no_nearer_to_the_middle_than_the_first_of_the_list) {
  const char* told = std::getenv("ARMSIG_POSTURES");
  const int poses = told == nullptr ? 2 : std::atoi(told);
  std::mt19937_64 random(1);
  int beaten = 0;
  int refused = 0;
  std::printf("| arm | poses | beaten by more than 0.001 rad | by at most, rad | refused |\n");
  std::printf("|---|--:|--:|--:|--:|\n");
  for (const KnownArm& drawing : seven_axis_arms()) {
    double most = 0;
    int of_arm = 0;
    int none = 0;
    for (int k = 0; k < poses; ++k) {
      const KnownArm arm = built(drawing, random);
      const JointVector q = random_readings(arm, random);
      const MiddleSearch independent(arm, q);
      const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
      const Solutions listed =
          *kinematics::cold_start(chain, kinematics::ClosedForm{}, independent.target());
      if (listed.empty() || listed[0].solution.verdict == Verdict::kJointLimit) {
        ++none;
        continue;
      }
      for (const auto& one : listed) EXPECT_LT(independent.miss(one.solution.q), 1e-9) << arm.name;
      const JointVector& first = listed[0].solution.q;
      const double ours = independent.distance(
          Eigen::Map<const Eigen::VectorXd>(first.data(), static_cast<Eigen::Index>(first.size())));
      const double by = ours - independent.least(kSevenStarts, random);
      most = std::max(most, by);
      of_arm += by > 1e-3 ? 1 : 0;
    }
    std::printf("| %s | %d | %d | %.3f | %d |\n", drawing.name.c_str(), poses, of_arm, most, none);
    std::fflush(stdout);
    beaten += of_arm;
    refused += none;
  }
  EXPECT_EQ(beaten, 0);
  EXPECT_EQ(refused, 0);
}

}  // namespace
}  // namespace armsig::test
