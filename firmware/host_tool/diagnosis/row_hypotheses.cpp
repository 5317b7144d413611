// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

struct PositionUnit {
  double factor;  // undoes the mistake
  const char* cause;
  const char* mend;
};

constexpr std::array<PositionUnit, 7> kPositionUnits{{
    {1000, "in metres where the columns say millimetres", "name the columns x_m, y_m, z_m"},
    {1e-3, "in millimetres where the columns say metres, or in micrometres where they say mm",
     "name the columns x_mm, y_mm, z_mm, or divide by 1000"},
    {25.4, "in inches", "multiply x, y and z by 25.4"},
    {1 / 25.4, "multiplied by 25.4 once too often", "divide x, y and z by 25.4"},
    {10, "in centimetres", "multiply x, y and z by 10"},
    {0.1, "in tenths of the unit that the columns say", "divide x, y and z by 10"},
    {304.8, "in feet", "multiply x, y and z by 304.8"},
}};

void add_position_units(std::vector<Hypothesis>& all) {
  for (const PositionUnit& unit : kPositionUnits) {
    const double factor = unit.factor;
    all.push_back({.cause = fmt::format("the positions are {}", unit.cause),
                   .undoing = fmt::format("times {:.4g}", factor),
                   .mend = unit.mend,
                   .surprise = 0,
                   .undo = [factor](Evidence& e) {
                     for (EvidenceRow& row : e.rows) row.p_S *= factor;
                   }});
  }
}

void add_single_axes(std::vector<Hypothesis>& all) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double factor : {1000.0, 1e-3, 25.4, 1 / 25.4}) {
      all.push_back({.cause = fmt::format("{} is in another unit than the other two coordinates",
                                          "xyz"[axis]),
                     .undoing = fmt::format("with {} times {:.4g}", "xyz"[axis], factor),
                     .mend = fmt::format("give column {} in the unit of the others", "xyz"[axis]),
                     .surprise = 1,
                     .undo = [axis, factor](Evidence& e) {
                       for (EvidenceRow& row : e.rows) row.p_S[axis] *= factor;
                     }});
    }
  }
}

// Rows of one file in two units: those far from the middle of the others.
void add_mixed_units(const Evidence& evidence, std::vector<Hypothesis>& all) {
  std::vector<double> norms;
  for (const EvidenceRow& row : evidence.rows) norms.push_back(row.p_S.norm());
  const auto [least, most] = std::ranges::minmax(norms);
  if (!(most > 8 * least)) return;
  for (const double factor : {1000.0, 25.4}) {
    for (const bool small : {true, false}) {
      const double limit = small ? most / std::sqrt(factor) : least * std::sqrt(factor);
      std::size_t first = 0;
      std::size_t last = 0;
      for (const EvidenceRow& row : evidence.rows) {
        if ((row.p_S.norm() < limit) != small) continue;
        if (first == 0) first = row.line;
        last = row.line;
      }
      if (first == 0) continue;
      const double undo = small ? factor : 1 / factor;
      all.push_back(
          {.cause = fmt::format("some rows from line {} to {} are in another unit", first, last),
           .undoing = fmt::format("with those times {:.4g}", undo),
           .mend = "give all rows in one unit",
           .surprise = 0.5,
           .undo = [limit, small, undo](Evidence& e) {
             for (EvidenceRow& row : e.rows) {
               if ((row.p_S.norm() < limit) == small) row.p_S *= undo;
             }
           }});
    }
  }
}

void add_mirror(std::vector<Hypothesis>& all) {
  all.push_back({.cause = "the positions are a mirror image of the arm",
                 .undoing = "mirrored",
                 .mend = "swap two of the columns x, y, z, or turn the sign of one: which two or "
                         "which one does not matter to the arm",
                 .surprise = 0.5,
                 .undo = [](Evidence& e) {
                   for (EvidenceRow& row : e.rows) row.p_S.x() = -row.p_S.x();
                 }});
}

// The readings of each row belong to the position of the row `steps` behind it, or before it where
// that is less than zero.
void shift_positions(Evidence& e, int steps) {
  const auto back = static_cast<std::size_t>(std::abs(steps)) - 1;
  std::erase_if(e.rows, [&](const EvidenceRow& row) { return row.earlier[back].q.empty(); });
  for (EvidenceRow& row : e.rows) {
    const EarlierRow& other = row.earlier[back];
    if (steps < 0) {
      row.p_S = other.p_S;
    } else {
      row.sweep = other.sweep;
      row.target = other.target;
      row.q = other.q;
    }
  }
}

void add_shifts(std::vector<Hypothesis>& all) {
  for (const int steps : {1, -1, 2, -2}) {
    all.push_back(
        {.cause = "positions and joint readings are out of step",
         .undoing = fmt::format("with the positions {} row{} {}", std::abs(steps),
                                std::abs(steps) == 1 ? "" : "s", steps > 0 ? "earlier" : "later"),
         .mend = "shift the columns of the positions against those of the readings",
         .surprise = std::abs(steps) == 1 ? 0.5 : 1,
         .undo = [steps](Evidence& e) { shift_positions(e, steps); }});
  }
}

void add_numbers(const Evidence& evidence, std::vector<Hypothesis>& all) {
  std::map<int, std::size_t> sweep_of;
  bool shared = false;
  for (const EvidenceRow& row : evidence.rows) {
    const auto [known, added] = sweep_of.try_emplace(row.target, row.sweep);
    shared = shared || (!added && known->second != row.sweep);
  }
  if (shared) {
    all.push_back({.cause = "one target number stands for points that are not one point of the arm",
                   .undoing = "with a target of its own for every sweep",
                   .mend = "give the target a new number in column target each time that it is "
                           "moved",
                   .surprise = 1,
                   .undo = [](Evidence& e) {
                     for (EvidenceRow& row : e.rows) {
                       row.target = row.target * 16 + static_cast<int>(row.sweep);
                     }
                   }});
  }
  const std::size_t n = evidence.arm.joints.size();
  for (const int step : {1, -1}) {
    all.push_back({.cause = "the numbers in column sweep are off by one",
                   .undoing = fmt::format("with {:+d} to each", step),
                   .mend = "number the sweeps from 1, joint by joint from the base",
                   .surprise = 1,
                   .undo = [step, n](Evidence& e) {
                     for (EvidenceRow& row : e.rows) {
                       const int sweep = static_cast<int>(row.sweep) + step;
                       row.sweep = sweep < 0 || sweep > static_cast<int>(n)
                                       ? 0
                                       : static_cast<std::size_t>(sweep);
                     }
                   }});
  }
}

}  // namespace

std::vector<Hypothesis> hypotheses_of_rows(const Evidence& evidence) {
  std::vector<Hypothesis> all;
  add_position_units(all);
  add_mirror(all);
  add_single_axes(all);
  add_mixed_units(evidence, all);
  add_shifts(all);
  add_numbers(evidence, all);
  return all;
}

std::string odd_columns(const Evidence& evidence) {
  const auto& rows = evidence.rows;
  if (rows.size() < 8) return {};
  const auto odd = [&](const std::string& name, const auto& value) -> std::string {
    bool constant = true;
    bool rising = true;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      constant = constant && value(rows[k]) == value(rows[0]);
      rising = rising && value(rows[k]) >= value(rows[k - 1]);
    }
    if (constant) return fmt::format("{} has one value in all rows", name);
    return rising ? fmt::format("{} rises from row to row, as if that column alone had been sorted",
                                name)
                  : "";
  };
  for (int axis = 0; axis < 3; ++axis) {
    auto said =
        odd(std::string(1, "xyz"[axis]), [axis](const EvidenceRow& row) { return row.p_S[axis]; });
    if (!said.empty()) return said;
  }
  for (std::size_t j = 0; j < evidence.arm.joints.size(); ++j) {
    auto said = odd(fmt::format("q{}", j + 1), [j](const EvidenceRow& row) { return row.q[j]; });
    if (!said.empty()) return said;
  }
  return {};
}

}  // namespace armsig::tool
