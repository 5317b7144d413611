// SPDX-License-Identifier: MIT
// What people get wrong with the sensor: its units, its place, the order of its rows.
#pragma once

#include "host_tests/mistakes/mistake.hpp"

namespace armsig::mistakes {

inline std::vector<Mistake> mistakes_of_positions() {
  constexpr double kInch = 25.4;
  return {
      {"positions in metres", positions_times(1e-3, 1e-3, 1e-3), false, "positions are in metres"},
      {"positions in inches", positions_times(1 / kInch, 1 / kInch, 1 / kInch), false,
       "positions are in inches"},
      {"positions in micrometres", positions_times(1e3, 1e3, 1e3), false, "times 0.001"},
      {"positions in centimetres", positions_times(0.1, 0.1, 0.1), false, "in centimetres"},
      {"positions in tenths", positions_times(10, 10, 10), false, "in tenths"},
      {"positions in feet", positions_times(1 / 304.8, 1 / 304.8, 1 / 304.8), false, "in feet"},
      {"positions converted twice", positions_times(kInch, kInch, kInch), false, "once too often"},
      {"x mirrored", positions_times(-1, 1, 1), false, "mirror"},
      {"z mirrored", positions_times(1, 1, -1), false, "mirror"},
      {"x and y swapped", every([](Row& row) { std::swap(row.p[0], row.p[1]); }), false, "mirror"},
      {"y and z swapped", every([](Row& row) { std::swap(row.p[1], row.p[2]); }), false, "mirror"},
      {"x in inches", positions_times(1 / kInch, 1, 1), false, "x is in another unit"},
      {"z in metres", positions_times(1, 1, 1e-3), false, "z is in another unit"},
      {"half of the rows in metres",
       rows_from(0.5,
                 [](Row& row) {
                   for (double& x : row.p) x *= 1e-3;
                 }),
       false, "in another unit"},
      {"a fifth of the rows in inches",
       rows_from(0.8,
                 [](Row& row) {
                   for (double& x : row.p) x /= 25.4;
                 }),
       false, ""},
      {"decimals cut off", every([](Row& row) {
         for (double& x : row.p) x = 10 * std::trunc(0.1 * x);
       })},
      {"decimal points lost", every([](Row& row) {
         for (double& x : row.p) x = std::fmod(std::abs(x), 7) < 3.5 ? x : 10 * x;
       })},
      {"y constant", every([](Row& row) { row.p[1] = 123.4; }), false, "one value"},
      {"x sorted",
       [](Set& set) {
         std::vector<double> x;
         for (const Row& row : set.rows) x.push_back(row.p[0]);
         std::ranges::sort(x);
         for (std::size_t k = 0; k < x.size(); ++k) set.rows[k].p[0] = x[k];
       }},
      {"z written into y", every([](Row& row) { row.p[1] = row.p[2]; })},
      {"scale of the sensor off by 5 %", positions_times(1.05, 1.05, 1.05), false,
       "all lengths seen are 1.0"},
      {"scale of the sensor off by -2 %", positions_times(0.98, 0.98, 0.98), false,
       "all lengths seen are 0.9"},
      {"x and y swapped from the middle on",
       rows_from(0.5, [](Row& row) { std::swap(row.p[0], row.p[1]); })},
      {"signs of the positions lost", every([](Row& row) {
         for (double& x : row.p) x = std::abs(x);
       })},
      {"positions to the centimetre", every([](Row& row) {
         for (double& x : row.p) x = 10 * std::round(0.1 * x);
       })},
      {"x leans towards y", every([](Row& row) { row.p[0] += 0.02 * row.p[1]; })},
      {"sigma in micrometres", every([](Row& row) { row.sigma *= 1e3; }), false, "sigma_mm"},
  };
}

inline std::vector<Mistake> mistakes_of_order() {
  return {
      {"tracker moved between sweeps",
       [](Set& set) {
         for (std::size_t k = set.start_of(3); k < set.rows.size(); ++k) {
           set.rows[k].p[0] += 200;
           set.rows[k].p[1] -= 150;
         }
       },
       false, "measured from another place: 25"},
      {"tracker moved for one sweep",
       [](Set& set) {
         for (Row& row : set.rows) {
           if (row.sweep == 2) row.p[2] += 250;
         }
       },
       false, "measured from another place"},
      {"tracker moved in a sweep", rows_from(0.42, [](Row& row) { row.p[0] += 250; }), false,
       "measured from another place"},
      {"tracker turned", rows_from(0.55, [](Row& row) { turn(row, 5); }), false,
       "measured from another place"},
      {"tracker turned for a while",
       [](Set& set) {
         for (std::size_t k = 2 * set.rows.size() / 5; k < 4 * set.rows.size() / 5; ++k) {
           turn(set.rows[k], 5);
         }
       },
       false, "measured from another place"},
      {"the tracker creeps", creeping([](Row& row, double share) { row.p[0] += 3 * share; })},
      {"the tracker turns slowly",
       creeping([](Row& row, double share) { turn(row, 0.15 * share); })},
      {"one row of another sweep",
       [](Set& set) {
         const std::size_t k = set.start_of(2) + 3;
         if (k < set.rows.size()) set.rows[k].sweep = 3;
       }},
      {"three rows of another target",
       [](Set& set) {
         const std::size_t first = set.start_of(2) + 5;
         for (std::size_t k = first; k < first + 3; ++k) set.rows[k].target = 1;
       }},
      {"positions of a sweep in any order",
       [](Set& set) {
         const std::size_t a = set.start_of(2);
         const std::size_t b = set.start_of(3);
         // Steps of seven through the rows: no order of any use.
         const std::vector<Row> rows(set.rows.begin() + static_cast<std::ptrdiff_t>(a),
                                     set.rows.begin() + static_cast<std::ptrdiff_t>(b));
         for (std::size_t k = 0; k < rows.size(); ++k) {
           std::copy_n(rows[7 * k % rows.size()].p, 3, set.rows[a + k].p);
         }
       }},
      {"tracker moved for the poses",
       [](Set& set) {
         for (std::size_t k = set.start_of(0); k < set.rows.size(); ++k) set.rows[k].p[1] += 60;
       },
       false, "another p"},
      {"positions a row late", [](Set& set) { shift_positions(set, 1); }, false, "out of step"},
      {"positions a row early",
       [](Set& set) {
         for (std::size_t k = 0; k + 1 < set.rows.size(); ++k) {
           std::copy_n(set.rows[k + 1].p, 3, set.rows[k].p);
         }
       },
       false, "out of step"},
      {"a sweep backwards",
       [](Set& set) {
         std::vector<std::size_t> of;
         for (std::size_t k = 0; k < set.rows.size(); ++k) {
           if (set.rows[k].sweep == 2) of.push_back(k);
         }
         for (std::size_t k = 0; k < of.size() / 2; ++k) {
           std::swap(set.rows[of[k]].p, set.rows[of[of.size() - 1 - k]].p);
         }
       }},
      {"positions of two sweeps exchanged",
       [](Set& set) {
         const std::size_t a = set.start_of(1);
         const std::size_t b = set.start_of(2);
         for (std::size_t k = 0; a + k < b; ++k) std::swap(set.rows[a + k].p, set.rows[b + k].p);
       }},
      {"a sweep pasted twice",
       [](Set& set) {
         const std::size_t a = set.start_of(1);
         const std::size_t b = set.start_of(2);
         for (std::size_t k = 0; a + k < b; ++k) {
           std::copy_n(set.rows[a + k].p, 3, set.rows[b + k].p);
         }
       }},
      {"another tool at the end",
       [](Set& set) {
         // The tool is turned into another by the distance of the last target from its axis.
         for (std::size_t k = set.rows.size() - 15; k < set.rows.size(); ++k) {
           for (std::size_t i = 0; i < 3; ++i)
             set.rows[k].p[i] += 30 * std::sin(double(k) + double(i));
         }
       }},
      {"targets one, moved", every([](Row& row) { row.target = 1; }), false, "target"},
      {"targets of two sweeps exchanged", every([](Row& row) {
         if (row.sweep == 0) row.target = 1;
       })},
      {"sweeps off by one",
       [](Set& set) {
         for (Row& row : set.rows) {
           if (row.sweep > 0) row.sweep = row.sweep % static_cast<int>(set.size()) + 1;
         }
       }},
      {"sweeps 1 and 2 exchanged", every([](Row& row) {
         if (row.sweep == 1 || row.sweep == 2) row.sweep = 3 - row.sweep;
       })},
  };
}

}  // namespace armsig::mistakes
