// SPDX-License-Identifier: MIT
// What people get wrong with the joint readings and with the drawing.
#pragma once

#include "host_tests/mistakes/mistake.hpp"

namespace armsig::mistakes {

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

}  // namespace armsig::mistakes
