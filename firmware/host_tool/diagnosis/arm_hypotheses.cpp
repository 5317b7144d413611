// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

void add_of_arm(std::vector<Hypothesis>& all, std::string cause, std::string undoing,
                std::string mend, double surprise, std::function<void(DhRows&)> undo) {
  all.push_back({.cause = std::move(cause),
                 .undoing = std::move(undoing),
                 .mend = std::move(mend),
                 .surprise = surprise,
                 .undo = [undo = std::move(undo)](Evidence& e) { undo(e.arm.joints); }});
}

void add_arm_units(std::vector<Hypothesis>& all) {
  constexpr std::array<std::pair<double, const char*>, 6> kDrawnLengths{
      {{1000, "a thousand times too short"},
       {1e-3, "a thousand times too long"},
       {25.4, "in inches"},
       {1 / 25.4, "multiplied by 25.4 once too often"},
       {10, "in centimetres"},
       {0.1, "ten times too long"}}};
  for (const auto& [factor, words] : kDrawnLengths) {
    add_of_arm(all, fmt::format("the lengths of the arm description are {}", words),
               fmt::format("with d and a times {:.4g}", factor),
               "look at the units of d_mm and a_mm (or d_m and a_m) in the arm description", 0.3,
               [factor](DhRows& joints) {
                 for (DhJoint& joint : joints) {
                   joint.a_m *= factor;
                   joint.d_m *= factor;
                 }
               });
  }
  for (const double factor : {180 / kPi, kPi / 180}) {
    const char* cause = factor > 1 ? "the angles of the arm description are in radians under _deg"
                                   : "the angles of the arm description are in degrees under _rad";
    const auto undoing = fmt::format("with theta and alpha times {:.4g}", factor);
    add_of_arm(all, cause, undoing, "look at the units of theta and alpha in the arm description",
               0.3, [factor](DhRows& joints) {
                 for (DhJoint& joint : joints) {
                   joint.alpha_rad *= factor;
                   joint.theta_rad *= factor;
                 }
               });
    add_of_arm(all, cause, fmt::format("with alpha times {:.4g}", factor),
               "look at the unit of alpha in the arm description", 0.4, [factor](DhRows& joints) {
                 for (DhJoint& joint : joints) joint.alpha_rad *= factor;
               });
  }
}

void add_conventions(std::vector<Hypothesis>& all) {
  add_of_arm(
      all, "these are modified (Craig's) Denavit-Hartenberg rows",
      "read as alpha and a of the joint before",
      "give standard rows: alpha and a of each row move up to the row before; or use armsig import",
      0.2, [](DhRows& joints) {
        for (std::size_t k = 0; k < joints.size(); ++k) {
          const bool last = k + 1 == joints.size();
          joints[k].a_m = last ? 0 : joints[k + 1].a_m;
          joints[k].alpha_rad = last ? 0 : joints[k + 1].alpha_rad;
        }
      });
  add_of_arm(all, "all alpha of the arm description have the other sign", "with alpha negated",
             "turn the signs of alpha in the arm description", 0.5, [](DhRows& joints) {
               for (DhJoint& joint : joints) joint.alpha_rad = -joint.alpha_rad;
             });
  add_of_arm(all, "d and a of the arm description are swapped", "the other way round",
             "swap d and a in the arm description", 0.5, [](DhRows& joints) {
               for (DhJoint& joint : joints) std::swap(joint.a_m, joint.d_m);
             });
  add_of_arm(all, "theta and alpha of the arm description are swapped", "the other way round",
             "swap theta and alpha in the arm description", 0.5, [](DhRows& joints) {
               for (DhJoint& joint : joints) std::swap(joint.alpha_rad, joint.theta_rad);
             });
}

void add_row_mistakes(const Evidence& evidence, std::vector<Hypothesis>& all) {
  const DhRows& drawn = evidence.arm.joints;
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const std::string row = fmt::format("row {} of the arm description", k + 1);
    if (std::abs(std::sin(drawn[k].alpha_rad)) > 0.1) {
      add_of_arm(all, fmt::format("alpha in {} has the other sign", row), "with it negated",
                 fmt::format("turn the sign of alpha in {}", row), 0.7,
                 [k](DhRows& joints) { joints[k].alpha_rad = -joints[k].alpha_rad; });
    }
    if (drawn[k].a_m != 0) {
      add_of_arm(all, fmt::format("a in {} has the other sign", row), "with it negated",
                 fmt::format("turn the sign of a in {}", row), 0.7,
                 [k](DhRows& joints) { joints[k].a_m = -joints[k].a_m; });
    }
    for (const double turn : {90.0, -90.0}) {
      add_of_arm(all, fmt::format("alpha in {} is off by {:.0f}°", row, turn),
                 fmt::format("with {:+.0f}°", turn), fmt::format("look at alpha in {}", row), 1.0,
                 [k, turn](DhRows& joints) { joints[k].alpha_rad += radians(turn); });
    }
    if (k + 1 < drawn.size() && drawn[k].type == drawn[k + 1].type) {
      add_of_arm(all,
                 fmt::format("rows {} and {} of the arm description are swapped", k + 1, k + 2),
                 "the other way round", fmt::format("swap rows {} and {}", k + 1, k + 2), 0.8,
                 [k](DhRows& joints) { std::swap(joints[k], joints[k + 1]); });
    }
  }
}

}  // namespace

std::vector<Hypothesis> hypotheses_of_arm(const Evidence& evidence) {
  std::vector<Hypothesis> all;
  add_arm_units(all);
  add_conventions(all);
  add_row_mistakes(evidence, all);
  return all;
}

}  // namespace armsig::tool
