// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

constexpr double kRadian = 180 / kPi;
// Of a larger factor the joint may only seem to have stood still.
constexpr double kGear = 2;

struct ReadingUnit {
  double factor;
  const char* cause;
  const char* mend;
  bool all;  // makes sense of all joints at once
};

constexpr std::array<ReadingUnit, 8> kAngles{{
    {kRadian, "in radians where the column says degrees", "name the column _rad", true},
    {1 / kRadian, "in degrees where the column says radians", "name the column _deg", true},
    {0.9, "in gon where the column says degrees", "multiply by 0.9", true},
    {360, "in turns where the column says degrees", "multiply by 360", true},
    {-1, "counted the other way", "turn its sign", true},
    {2, "half of what the joint turns", "multiply by 2: look at the gear ratio", false},
    {0.5, "twice what the joint turns", "divide by 2: look at the gear ratio", false},
    {0, "of something else than the joint, which rested", "look which column is the joint's",
     false},
}};
constexpr std::array<ReadingUnit, 6> kLengths{{
    {1000, "in metres where the column says millimetres", "name the column _m", true},
    {1e-3, "in millimetres where the column says metres", "name the column _mm", true},
    {25.4, "in inches", "multiply by 25.4", true},
    {-1, "counted the other way", "turn its sign", false},
    {2, "half of what the joint moves", "multiply by 2: look at the gear ratio", false},
    {0.5, "twice what the joint moves", "divide by 2: look at the gear ratio", false},
}};

void add_reading_units(const Evidence& evidence, std::vector<Hypothesis>& all) {
  const auto& joints = evidence.arm.joints;
  for (const ReadingUnit& unit : kAngles) {
    if (!unit.all) continue;
    const double factor = unit.factor;
    all.push_back({.cause = fmt::format("the joint readings are {}", unit.cause),
                   .undoing = fmt::format("times {:.4g}", factor),
                   .mend = unit.mend,
                   .surprise = 0.2,
                   .undo = [factor](Evidence& e) {
                     for (EvidenceRow& row : e.rows) {
                       for (std::size_t j = 0; j < row.q.size(); ++j) {
                         if (e.arm.joints[j].type == JointType::kRevolute) row.q[j] *= factor;
                       }
                     }
                   }});
  }
  const auto add_one = [&](std::size_t j, const ReadingUnit& unit) {
    const double factor = unit.factor;
    all.push_back({.cause = fmt::format("the reading of joint {} is {}", j + 1, unit.cause),
                   .undoing = fmt::format("with q{} times {:.4g}", j + 1, factor),
                   .mend = fmt::format("column q{}: {}", j + 1, unit.mend),
                   .surprise = factor == 0 ? 2 : 0.5,
                   .undo = [j, factor](Evidence& e) {
                     for (EvidenceRow& row : e.rows) row.q[j] *= factor;
                   }});
  };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const bool still = !has_moved(evidence, j);
    const auto add = [&](const ReadingUnit& unit) {
      if (!still || unit.factor > kGear) add_one(j, unit);
    };
    if (joints[j].type == JointType::kRevolute) {
      std::ranges::for_each(kAngles, add);
    } else {
      std::ranges::for_each(kLengths, add);
    }
  }
}

void add_order(const Evidence& evidence, std::vector<Hypothesis>& all) {
  const auto& joints = evidence.arm.joints;
  const std::size_t n = joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (joints[i].type != joints[j].type) continue;
      if (!has_moved(evidence, i) && !has_moved(evidence, j)) continue;
      all.push_back(
          {.cause = fmt::format("the readings of joints {} and {} are swapped", i + 1, j + 1),
           .undoing = "the other way round",
           .mend = fmt::format("swap the columns q{} and q{}", i + 1, j + 1),
           .surprise = 0.8,
           .undo = [i, j](Evidence& e) {
             for (EvidenceRow& row : e.rows) std::swap(row.q[i], row.q[j]);
           }});
    }
  }
  if (std::ranges::any_of(joints,
                          [&](const DhJoint& joint) { return joint.type != joints[0].type; })) {
    return;
  }
  for (const int turn : {1, -1, 0}) {
    all.push_back({.cause = "the columns of the readings are in another order",
                   .undoing = turn == 0 ? "from the last joint to the first"
                                        : fmt::format("moved on by {:+d}", turn),
                   .mend = "name the columns q1, q2, ... from the base to the tip",
                   .surprise = 1,
                   .undo = [turn, n](Evidence& e) {
                     for (EvidenceRow& row : e.rows) {
                       const JointVector q = row.q;
                       for (std::size_t j = 0; j < n; ++j) {
                         const std::size_t from =
                             turn == 0 ? n - 1 - j : (j + (turn > 0 ? 1 : n - 1)) % n;
                         row.q[j] = q[from];
                       }
                     }
                   }});
  }
}

void add_couplings(const Evidence& evidence, std::vector<Hypothesis>& all) {
  const auto& joints = evidence.arm.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!has_moved(evidence, j)) continue;
    for (std::size_t i = j < 3 ? 0 : j - 3; i < j; ++i) {
      if (joints[i].type != joints[j].type || !has_moved(evidence, i)) continue;
      for (const double ratio : {1.0, -1.0, 0.5, -0.5}) {
        all.push_back(
            {.cause = fmt::format("joint {} is coupled to joint {}", j + 1, i + 1),
             .undoing = fmt::format("with q{0} = q{0} {1} {2:.3f} q{3}", j + 1,
                                    ratio < 0 ? "-" : "+", std::abs(ratio), i + 1),
             .mend = fmt::format("state it in the arm description: {}", coupling_line(j, i, ratio)),
             .surprise = std::abs(ratio) == 1 ? 0.8 : 1.2,
             .undo = [i, j, ratio](Evidence& e) {
               for (EvidenceRow& row : e.rows) row.q[j] += ratio * row.q[i];
             }});
      }
    }
  }
  for (std::size_t k = 0; k < evidence.arm.couplings.size(); ++k) {
    const JointCoupling coupling = evidence.arm.couplings[k];
    for (const double factor : {-1.0, 0.0}) {
      all.push_back(
          {.cause = fmt::format("joint {} does not follow joint {} as the arm description "
                                "says",
                                coupling.joint + 1, coupling.from + 1),
           .undoing = factor == 0 ? std::string("without that coupling")
                                  : fmt::format("with the ratio {:+.4g}", -coupling.ratio),
           .mend = factor == 0
                       ? std::string("take the coupling out of the arm description")
                       : "state " + coupling_line(coupling.joint, coupling.from, -coupling.ratio),
           .surprise = 0.6,
           .undo = [k, factor](Evidence& e) { e.arm.couplings[k].ratio *= factor; }});
    }
  }
}

// The last joints turn, and the point that is seen does not follow them.
void add_earlier_links(const Evidence& evidence, std::vector<Hypothesis>& all) {
  const std::size_t n = evidence.arm.joints.size();
  for (const std::size_t beyond : {2U, 3U}) {
    if (n <= beyond) continue;
    const std::size_t first = n - beyond;
    all.push_back(
        {.cause = fmt::format("the target follows no joint beyond joint {}", first),
         .undoing = fmt::format("with joints {} to {} left out", first + 1, n),
         .mend = "a target on the flange; or sweep = number of the joint that moves it last, and a "
                 "sweep of each joint",
         .surprise = 0.7,
         .undo = [first](Evidence& e) {
           for (EvidenceRow& row : e.rows) {
             for (std::size_t j = first; j < row.q.size(); ++j) row.q[j] = 0;
           }
         }});
  }
}

void add_zeros(const Evidence& evidence, std::vector<Hypothesis>& all) {
  for (std::size_t j = 0; j < evidence.arm.joints.size(); ++j) {
    if (evidence.arm.joints[j].type != JointType::kRevolute) continue;
    for (const double angle_deg : {90.0, -90.0, 180.0, 45.0, -45.0}) {
      all.push_back(
          {.cause = fmt::format("the zero of joint {} is {:.0f}° from the nominal model's", j + 1,
                                angle_deg),
           .undoing = fmt::format("with {:+.0f}° on q{}", angle_deg, j + 1),
           .mend = fmt::format("add {:+.0f} to theta_deg of joint {} in the arm description",
                               angle_deg, j + 1),
           .surprise = std::abs(angle_deg) < 60 ? 1.2 : 0.8,
           .harmless = true,
           .undo = [j, angle_deg](Evidence& e) {
             e.arm.joints[j].theta_rad += radians(angle_deg);
           }});
    }
  }
}

}  // namespace

std::string coupling_line(std::size_t joint, std::size_t from, double ratio) {
  return fmt::format("coupling: [{{joint: {}, from: {}, ratio: {:.4g}}}]", joint + 1, from + 1,
                     ratio);
}

std::vector<Hypothesis> hypotheses_of_readings(const Evidence& evidence) {
  std::vector<Hypothesis> all;
  add_reading_units(evidence, all);
  add_order(evidence, all);
  add_couplings(evidence, all);
  add_earlier_links(evidence, all);
  add_zeros(evidence, all);
  return all;
}

}  // namespace armsig::tool
