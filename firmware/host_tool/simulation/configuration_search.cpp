// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/configuration_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/joint_range.hpp"
#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"

namespace armsig::tool {
namespace {

using clearance::Surroundings;

constexpr int kCandidates = 3000;
constexpr double kStep_rad = radians(15);
constexpr double kGoodArc_rad = kPi;      // more of a sweep tells hardly more
constexpr double kLook_rad = radians(5);  // between two places of a sweep, when it is only judged
class Search {
 public:
  Search(const Arm& arm, const Surroundings& around) : arm_(arm), around_(around) {
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const auto [lower, upper] = finite_range(arm.limits[i]);
      if (turns(i)) {
        step_.push_back(kStep_rad);
        const double middle = (lower + upper) / 2;
        origin_.push_back(lower < 0 && upper > 0 ? 0 : kStep_rad * std::round(middle / kStep_rad));
      } else {
        step_.push_back((upper - lower) / 10);
        origin_.push_back((lower + upper) / 2);
      }
    }
    constexpr double kAside_m = 0.05;
    const double x_m = dh_frames(arm.joints, effective_readings(arm, origin_)).back().p.x();
    if (std::abs(x_m) > kAside_m) front_ = x_m;
  }

  [[nodiscard]] JointVector best() const {
    JointVector best;
    double best_score = 0;
    for (int n = 1; n <= kCandidates; ++n) {
      JointVector q = evenly_spread_configuration(types_of(arm_.joints), arm_.limits, n);
      snap(q);
      if (const double score = score_of(q, best_score); score > best_score) {
        best_score = score;
        best = q;
      }
    }
    while (!best.empty() && climbs(best, best_score)) {
    }
    return best;
  }

 private:
  [[nodiscard]] bool turns(std::size_t joint) const {
    return arm_.joints[joint].type == JointType::kRevolute;
  }
  [[nodiscard]] bool holds(const JointVector& q) const {
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (q[i] < arm_.limits[i].lower || q[i] > arm_.limits[i].upper) return false;
    }
    return true;
  }
  [[nodiscard]] bool is_clear(const JointVector& q) const {
    return clearance::room_at(arm_.joints, around_, effective_readings(arm_, q)).left_m >=
           clearance::kLeastRoom_m;
  }

  // To whole steps; the first joint stays where it begins: the arm looks the same wherever it
  // points.
  void snap(JointVector& q) const {
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = origin_[i] + step_[i] * std::round((q[i] - origin_[i]) / step_[i]);
    }
    if (turns(0) && q.size() > 2) q[0] = origin_[0];
  }

  // How far joint `j` gets to one side.
  [[nodiscard]] double reach(JointVector q, std::size_t j, double sense) const {
    const double step = turns(j) ? kLook_rad : step_[j] / 4;
    const double most = turns(j) ? kGoodArc_rad : arm_.limits[j].upper - arm_.limits[j].lower;
    double way = 0;
    while (way < most) {
      q[j] += sense * step;
      if (!holds(q) || !is_clear(q)) break;
      way += step;
    }
    return std::min(way, most);
  }

  // The part of a good sweep that joint `j` has.
  [[nodiscard]] double sweep_of(const JointVector& q, std::size_t j) const {
    const double stroke = arm_.limits[j].upper - arm_.limits[j].lower;
    const double good = turns(j) ? std::min(kGoodArc_rad, stroke) : stroke;
    return std::min(1.0, (reach(q, j, 1) + reach(q, j, -1)) / good);
  }

  // Up to 1 each, weighed: how far the arm is stretched, at seven tenths of it at most, beyond
  // which it has only one way to go; how far its elbow is above the line from shoulder to flange;
  // how far its flange is from the mounting plane; how far the last axis is from being in line with
  // the one before the one before it. Less where it reaches behind itself.
  [[nodiscard]] double posture_of(const JointVector& q) const {
    const auto frames = dh_frames(arm_.joints, effective_readings(arm_, q));
    const std::size_t n = q.size();
    double length_m = 0;
    for (std::size_t i = 2; i <= n; ++i) length_m += (frames[i].p - frames[i - 1].p).norm();
    if (!(length_m > 0)) return 0;
    const Vector3 up_B =
        around_.planes.empty() ? Vector3(Vector3::UnitZ()) : around_.planes[0].normal_B;
    const Vector3 across_B = frames[n].p - frames[1].p;
    constexpr double kStretched = 0.7;
    const double part = across_B.norm() / length_m;
    const double stretched = part < kStretched ? part / kStretched : (1 - part) / (1 - kStretched);
    double elbow_m = 0;
    for (std::size_t i = 2; i < n; ++i) {
      const Vector3 at_B = frames[i].p - frames[1].p;
      const double along =
          std::clamp(at_B.dot(across_B) / std::max(1e-9, across_B.squaredNorm()), 0.0, 1.0);
      elbow_m = std::max(elbow_m, (at_B - along * across_B).dot(up_B));
    }
    constexpr double kShare = 0.2;
    const double elbow = std::min(1.0, elbow_m / (kShare * length_m));
    const double height = std::clamp(across_B.dot(up_B) / (kShare * length_m), -1.0, 1.0);
    double bent = 1;
    if (n >= 6) {
      constexpr double kBent = 0.5;
      bent = std::min(1.0, frames[n - 1].R.col(2).cross(frames[n - 3].R.col(2)).norm() / kBent);
    }
    const double behind = front_ * frames[n].p.x() < 0 ? 1 : 0;
    return (2 * stretched + 2 * elbow + height + bent) / 4 - behind;
  }

  // The worst sweep counts most. Below `least`, or not clear: no more is worked out.
  [[nodiscard]] double score_of(const JointVector& q, double least) const {
    if (!holds(q) || !is_clear(q)) return -1;
    const auto n = static_cast<double>(q.size());
    const double posture = posture_of(q);
    double turned = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      turned += std::abs(q[i] - origin_[i]) / (step_[i] * n);
    }
    constexpr double kWorst = 2;
    constexpr double kTurned = 0.03;  // of as good ones the one that is easier to read
    double worst = 1;
    double sum = 0;
    for (std::size_t j = 0; j < q.size(); ++j) {
      const double sweep = sweep_of(q, j);
      worst = std::min(worst, sweep);
      sum += sweep;
      const double best = kWorst * worst + (sum + n - static_cast<double>(j) - 1) / n + posture;
      if (best < least) return -1;
    }
    return kWorst * worst + sum / n + posture - kTurned * turned;
  }

  // One joint by one step, where that is better.
  [[nodiscard]] bool climbs(JointVector& best, double& best_score) const {
    bool better = false;
    for (std::size_t i = 0; i < best.size(); ++i) {
      for (const double sense : {1.0, -1.0}) {
        JointVector q = best;
        q[i] += sense * step_[i];
        const double score = score_of(q, best_score);
        if (score <= best_score) continue;
        best = q;
        best_score = score;
        better = true;
      }
    }
    return better;
  }

  const Arm& arm_;
  const Surroundings& around_;
  JointVector origin_;
  JointVector step_;
  double front_ = 0;  // the sign of x where the arm reaches to, its readings zero
};

}  // namespace

JointVector chosen_configuration(const Arm& arm, const Surroundings& around) {
  return Search(arm, around).best();
}

}  // namespace armsig::tool
