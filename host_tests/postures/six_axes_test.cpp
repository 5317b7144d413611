// SPDX-License-Identifier: MIT
// All postures of six-axis arms that two hundred random starts of an independent Newton method find
// are listed, each once, and none that is false. Prints a table by kind of arm.
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/support/independent_postures.hpp"
#include "host_tests/support/posture_kinds.hpp"

namespace armsig::test {
namespace {

using kinematics::NamedSolution;
using kinematics::Solutions;
using kinematics::Verdict;

constexpr double kSame = 1e-4;        // rad or m
constexpr double kSameAtFold = 3e-4;  // nearer than this at a fold, two are one
constexpr double kFold = 1e-2;        // least singular value of a posture at a fold
constexpr double kRegular = 1e-6;     // least singular value of a posture that must be listed
constexpr double kTrue = 1e-9;        // m and rad
constexpr int kStarts = 200;

struct Tally {
  int poses = 0;
  int postures = 0;  // of the independent search, regular ones
  int missed = 0;
  int wrong = 0;  // listed, but not meeting the pose
  int twice = 0;
  int refused = 0;   // nothing inside the limits, where the arm stands
  int unsorted = 0;  // one inside the limits after one outside
};

bool is_inside(const NamedSolution& s) { return s.solution.verdict != Verdict::kJointLimit; }

class Judge {
 public:
  explicit Judge(std::uint64_t seed) : random_(seed) {}

  std::mt19937_64& random() { return random_; }

  void judge(const KnownArm& arm, const JointVector& q, Tally& tally) {
    const IndependentSearch independent(arm.joints, 1.0);
    const auto target = independent.pose(q);
    Pose X;
    X.R = target.R.cast<double>();
    X.p = target.p.cast<double>();
    const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
    const Solutions listed = *kinematics::cold_start(chain, kinematics::closed_form(chain), X);
    ++tally.poses;
    if (listed.empty() || !is_inside(listed[0])) note(arm, q, "refused", tally.refused);
    for (std::size_t k = 0; k < listed.size(); ++k) {
      if (independent.miss(target, listed[k].solution.q) > kTrue)
        note(arm, q, "false", tally.wrong);
      if (k > 0 && is_inside(listed[k]) && !is_inside(listed[k - 1])) ++tally.unsorted;
      for (std::size_t i = 0; i < k; ++i) {
        if (apart(arm.joints, listed[i].solution.q, listed[k].solution.q) < 1e-4)
          note(arm, q, "twice", tally.twice);
      }
    }
    for (const IndependentPosture& one : independent.search(target, q, kStarts, random_)) {
      if (one.least_singular_value < kRegular) continue;
      ++tally.postures;
      const bool found = std::ranges::any_of(listed, [&](const NamedSolution& s) {
        return apart(arm.joints, s.solution.q, one.q) <
               (one.least_singular_value < kFold ? kSameAtFold : kSame);
      });
      if (!found && has_slide_outside(arm, one.q)) continue;
      if (!found) {
        note(arm, q, "missed", tally.missed, one.least_singular_value);
        double nearest = 10;
        for (const NamedSolution& s : listed) {
          nearest = std::min(nearest, apart(arm.joints, s.solution.q, one.q));
        }
        if (std::getenv("ARMSIG_POSTURES_TOLD") != nullptr)
          std::printf(" of %zu listed, nearest %.3g\n", listed.size(), nearest);
      }
    }
  }

 private:
  // A slide is looked for inside its limits.
  static bool has_slide_outside(const KnownArm& arm, const JointVector& q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (arm.joints[i].type == kR) continue;
      if (q[i] < arm.limits[i].lower || q[i] > arm.limits[i].upper) return true;
    }
    return false;
  }

  static void note(const KnownArm& arm, const JointVector& q, const char* what, int& count,
                   double value = 0) {
    ++count;
    if (std::getenv("ARMSIG_POSTURES_TOLD") == nullptr) return;
    std::printf("%s: %s (%.3g), readings", arm.name.c_str(), what, value);
    for (const double reading : q) std::printf(" %.17g", reading);
    std::printf("\n rows");
    for (const DhJoint& row : arm.joints) {
      std::printf(" {%.17g, %.17g, %.17g, %.17g}", row.theta_rad, row.d_m, row.a_m, row.alpha_rad);
    }
    std::printf("\n");
  }

  std::mt19937_64 random_;
};

int poses_a_kind() {
  const char* told = std::getenv("ARMSIG_POSTURES");
  return told == nullptr ? 4 : std::atoi(told);
}

std::vector<PostureKind> kinds_of(const std::string& name, KnownArm (*drawn)()) {
  const auto as_built = [drawn](std::mt19937_64& random) { return built(drawn(), random); };
  const auto as_drawn = [drawn](std::mt19937_64&) { return drawn(); };
  return {
      {name + ", as drawn", as_drawn, anywhere},
      {name + ", as built", as_built, anywhere},
      {name + ", wrist straight to 1e-3 ... 1e-12", as_built, near_angle(4, 0, -12, -3)},
      {name + ", as drawn, wrist straight", as_drawn, near_angle(4, 0, -12, -3)},
      {name + ", elbow straight", as_built, near_angle(2, 0, -12, -2)},
      {name + ", over axis 1", as_drawn, over_axis_1},
      {name + ", on folds", as_built, on_fold},
      {name + ", beside folds", as_built, off_fold},
  };
}

std::vector<PostureKind> all_kinds() {
  std::vector<PostureKind> kinds;
  for (const tool::KnownArm& known : tool::known_arms()) {
    const auto described = tool::read_arm(std::string(known.name));
    const KnownArm arm = drawn(std::string(known.name), described->arm);
    if (arm.joints.size() != 6) continue;
    kinds.push_back({arm.name, [arm](std::mt19937_64&) { return arm; }, anywhere});
    kinds.push_back({arm.name + " built",
                     [arm](std::mt19937_64& random) { return built(arm, random); }, anywhere});
  }
  for (const KnownArm& arm : six_joint_arms()) {
    kinds.push_back({arm.name + " (shared)", [arm](std::mt19937_64&) { return arm; }, anywhere});
  }
  for (auto* drawn :
       {puma_like, ur_like, table_top, offset_cobot, bent_cobot, slanted_wrist, light_arm}) {
    const auto more = kinds_of(drawn().name, drawn);
    kinds.insert(kinds.end(), more.begin(), more.end());
  }
  kinds.push_back({"any offset wrist", offset_wrist_arm, anywhere});
  kinds.push_back({"any offset wrist, on folds", offset_wrist_arm, on_fold});
  kinds.push_back({"square twists", square_arm, anywhere});
  kinds.push_back({"any axes", any_arm, anywhere});
  kinds.push_back({"any axes, on folds", any_arm, on_fold});
  return kinds;
}

TEST(SixAxes, list_every_posture_once) {
  Judge judge(1);
  Tally all;
  std::printf("| kind | poses | postures | missed | false | twice | refused | unsorted |\n");
  std::printf("|---|--:|--:|--:|--:|--:|--:|--:|\n");
  const auto print = [](const std::string& name, const Tally& t) {
    std::printf("| %s | %d | %d | %d | %d | %d | %d | %d |\n", name.c_str(), t.poses, t.postures,
                t.missed, t.wrong, t.twice, t.refused, t.unsorted);
    std::fflush(stdout);
  };
  const char* only = std::getenv("ARMSIG_POSTURES_KIND");
  for (const PostureKind& kind : all_kinds()) {
    if (only != nullptr && kind.name.find(only) == std::string::npos) continue;
    Tally tally;
    for (int k = 0; k < poses_a_kind(); ++k) {
      const KnownArm arm = kind.arm(judge.random());
      judge.judge(arm, kind.stand(arm, judge.random()), tally);
    }
    print(kind.name, tally);
    all.poses += tally.poses;
    all.postures += tally.postures;
    all.missed += tally.missed;
    all.wrong += tally.wrong;
    all.twice += tally.twice;
    all.refused += tally.refused;
    all.unsorted += tally.unsorted;
  }
  print("all", all);
  EXPECT_EQ(all.missed, 0);
  EXPECT_EQ(all.wrong, 0);
  EXPECT_EQ(all.twice, 0);
  EXPECT_EQ(all.refused, 0);
  EXPECT_EQ(all.unsorted, 0);
}

}  // namespace
}  // namespace armsig::test
