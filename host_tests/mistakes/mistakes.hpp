// SPDX-License-Identifier: MIT
// What people get wrong.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "host_tests/mistakes/measured_set.hpp"

namespace armsig::mistakes {

struct Mistake {
  std::string name;
  std::function<void(Set&)> make;
  // A mistake of the person's readings, who will make it again when the arm is used; others are of
  // these measurements alone.
  bool lasts = false;
  std::string says = {};  // words that the refusal holds, on a Puma
};

using Edit = std::function<void(Row&)>;

inline std::function<void(Set&)> every(Edit edit) {
  return [edit = std::move(edit)](Set& set) {
    for (Row& row : set.rows) edit(row);
  };
}

inline std::function<void(Set&)> positions_times(double x, double y, double z) {
  return every([=](Row& row) {
    row.p[0] *= x;
    row.p[1] *= y;
    row.p[2] *= z;
  });
}

// Revolute readings of all joints, or of one.
inline std::function<void(Set&)> angles_times(double factor, std::optional<std::size_t> one = {}) {
  return [=](Set& set) {
    for (Row& row : set.rows) {
      for (std::size_t j = 0; j < set.size(); ++j) {
        if (set.revolute(j) && (!one || *one == j)) row.q[j] *= factor;
      }
    }
  };
}

inline std::function<void(Set&)> rows_from(double share, Edit edit) {
  return [=](Set& set) {
    const auto first = static_cast<std::size_t>(share * static_cast<double>(set.rows.size()));
    for (std::size_t k = first; k < set.rows.size(); ++k) edit(set.rows[k]);
  };
}

// Grows from the first row to the last.
inline std::function<void(Set&)> creeping(std::function<void(Row&, double share)> edit) {
  return [=](Set& set) {
    const auto last = static_cast<double>(set.rows.size() - 1);
    for (std::size_t k = 0; k < set.rows.size(); ++k) {
      edit(set.rows[k], static_cast<double>(k) / last);
    }
  };
}

// From the middle on, and ever after: poses that were held out come later.
inline std::function<void(Set&)> slipping(Edit edit) {
  return [=](Set& set) {
    const bool held_out = set.rows.front().sweep == 0;
    (held_out ? every(edit) : rows_from(0.5, edit))(set);
  };
}

inline void turn(Row& row, double degrees) {
  const double c = std::cos(radians(degrees));
  const double s = std::sin(radians(degrees));
  const double x = row.p[0];
  row.p[0] = c * x - s * row.p[1];
  row.p[1] = s * x + c * row.p[1];
}

inline std::function<void(Set&)> arm_by(std::function<void(DhJoint&)> edit) {
  return [edit = std::move(edit)](Set& set) {
    for (DhJoint& joint : set.joints()) edit(joint);
  };
}

inline void shift_positions(Set& set, std::size_t by) {
  for (std::size_t k = set.rows.size() - 1; k >= by; --k) {
    std::copy_n(set.rows[k - by].p, 3, set.rows[k].p);
  }
}

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

inline std::vector<Mistake> mistakes_of_readings() {
  return {
      {"readings in radians", angles_times(kPi / 180), true, "in radians"},
      {"readings in gon", angles_times(10.0 / 9), true, "gon"},
      {"readings in turns", angles_times(1.0 / 360), true},
      {"one reading in radians", angles_times(kPi / 180, 1), true, "joint 2 is in radians"},
      {"one reading in gon", angles_times(10.0 / 9, 1), true, "joint 2 is in gon"},
      {"gear ratio of two", angles_times(0.5, 1), true, "joint 2 is half"},
      {"slides in metres",
       [](Set& set) {
         for (Row& row : set.rows) {
           for (std::size_t j = 0; j < set.size(); ++j) {
             if (!set.revolute(j)) row.q[j] *= 1e-3;
           }
         }
       },
       true},
      {"all gears 1 % off", angles_times(1.01), true, "1.0100 times what the joint turns"},
      {"a gear 2 % off", angles_times(1.02, 1), true, "joint 2 is 1.0200 times"},
      {"one reading in radians from the middle on",
       rows_from(0.5, [](Row& row) { row.q[2] *= kPi / 180; })},
      {"a reading is zero all along", every([](Row& row) { row.q[2] = 0; }), false, ""},
      {"readings a row late",
       [](Set& set) {
         for (std::size_t k = set.rows.size() - 1; k > 0; --k) set.rows[k].q = set.rows[k - 1].q;
       }},
      {"one reading a row late",
       [](Set& set) {
         for (std::size_t k = set.rows.size() - 1; k > 0; --k) {
           set.rows[k].q[2] = set.rows[k - 1].q[2];
         }
       }},
      {"signs of the readings lost", every([](Row& row) {
         for (double& q : row.q) q = std::abs(q);
       })},
      {"joint 3 reversed", angles_times(-1, 2), true},
      {"the last two readings swapped",
       every([](Row& row) { std::swap(row.q[row.q.size() - 1], row.q[row.q.size() - 2]); }), true},
      {"joint 1 reversed", angles_times(-1, 0), true},
      {"joint 2 reversed", angles_times(-1, 1), true, "joint 2"},
      {"all joints reversed", angles_times(-1), true},
      {"readings of joints 1 and 2 swapped", every([](Row& row) { std::swap(row.q[0], row.q[1]); }),
       true, "joints 1 and 2 are swapped"},
      {"readings in reverse order", every([](Row& row) { std::ranges::reverse(row.q); }), true},
      {"readings moved on by one",
       every([](Row& row) { std::ranges::rotate(row.q, row.q.begin() + 1); }), true},
      {"a coupling is missing", every([](Row& row) { row.q[1] -= row.q[0]; }), true,
       "joint 2 is coupled to joint 1"},
      {"a coupling has the wrong sign",
       [](Set& set) {
         for (Row& row : set.rows) row.q[1] -= row.q[0];
         set.description.arm.couplings.push_back({1, 0, -1});
       },
       true, "ratio"},
      {"a reading is constant", every([](Row& row) { row.q[1] = 12.5; })},
      {"a reading is sorted",
       [](Set& set) {
         std::vector<double> q;
         for (const Row& row : set.rows) q.push_back(row.q[1]);
         std::ranges::sort(q);
         for (std::size_t k = 0; k < q.size(); ++k) set.rows[k].q[1] = q[k];
       }},
      {"an encoder slips", slipping([](Row& row) { row.q[2] += 0.3; }), true},
      {"an encoder creeps", creeping([](Row& row, double share) { row.q[1] += 0.3 * share; })},
      {"an encoder loses counts", rows_from(0.6, [](Row& row) { row.q[0] += 6; })},
      {"zero off by 90 degrees", every([](Row& row) { row.q[1] -= 90; }), true},
      {"zero off by 180 degrees", every([](Row& row) { row.q[0] += 180; }), true},
  };
}

inline std::vector<Mistake> mistakes_of_arm() {
  const auto lengths = [](double factor) {
    return arm_by([factor](DhJoint& joint) {
      joint.a_m *= factor;
      joint.d_m *= factor;
    });
  };
  const auto angles = [](double factor) {
    return arm_by([factor](DhJoint& joint) {
      joint.alpha_rad *= factor;
      joint.theta_rad *= factor;
    });
  };
  return {
      {"lengths of the arm a thousand times too short", lengths(1e-3), true, "too short"},
      {"lengths of the arm a thousand times too long", lengths(1e3), true, "too long"},
      {"lengths of the arm in inches", lengths(1 / 25.4), true, "in inches"},
      {"angles of the arm in radians under _deg", angles(kPi / 180), true, "in radians"},
      {"angles of the arm in degrees under _rad", angles(180 / kPi), true},
      {"modified rows",
       [](Set& set) {
         auto& joints = set.joints();
         for (std::size_t k = joints.size(); k-- > 0;) {
           joints[k].a_m = k == 0 ? 0 : joints[k - 1].a_m;
           joints[k].alpha_rad = k == 0 ? 0 : joints[k - 1].alpha_rad;
         }
       },
       true, "modified"},
      {"alpha negated", arm_by([](DhJoint& joint) { joint.alpha_rad *= -1; }), true},
      {"one alpha negated", [](Set& set) { set.joints()[0].alpha_rad *= -1; }, true},
      {"d and a swapped", arm_by([](DhJoint& joint) { std::swap(joint.a_m, joint.d_m); }), true,
       "d and a"},
      {"rows 2 and 3 swapped",
       [](Set& set) {
         if (set.revolute(1) == set.revolute(2)) std::swap(set.joints()[1], set.joints()[2]);
       },
       true},
      {"another arm",
       [](Set& set) {
         for (std::size_t k = 0; k < set.size(); ++k) {
           set.joints()[k].a_m = 1.4 * set.joints()[k].a_m + 0.05;
           set.joints()[k].d_m *= 1.6;
         }
       },
       true},
      {"the arm of another size", arm_by([](DhJoint& joint) {
         joint.a_m *= 1.3;
         joint.d_m *= 1.3;
       }),
       true, "all lengths seen are"},
      {"a length mistyped", [](Set& set) { set.joints()[1].a_m += 0.09; }, true},
  };
}

inline std::vector<Mistake> all_mistakes() {
  std::vector<Mistake> all;
  for (const auto& some :
       {mistakes_of_positions(), mistakes_of_order(), mistakes_of_readings(), mistakes_of_arm()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace armsig::mistakes
