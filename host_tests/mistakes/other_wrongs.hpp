// SPDX-License-Identifier: MIT
// What goes wrong while the machines that share no code are measured, and the words by which it is
// named first.
#pragma once

#include <memory>

#include "host_tests/mistakes/other_measurement.hpp"

namespace armsig::mistakes::other {

struct Unsound {
  std::string name;
  Wrong wrong;
  std::vector<std::string> says;  // any of them
  bool of_arm = true;             // the arm's: it is never laid on the sensor
};

// A change of the machine at one row, for good.
inline Wrong from(double share, std::function<void(Machine&)> change) {
  auto done = std::make_shared<bool>(false);
  return {.before = [=](Machine& machine, double at) {
    if (*done || at < share) return;
    *done = true;
    change(machine);
  }};
}
// As it was built, and not as it is described.
inline Wrong always(std::function<void(Machine&)> change) { return from(0, std::move(change)); }

inline Wrong seen(std::function<void(OtherRow&)> edit, double share = 0) {
  return {.after = [=](OtherRow& row, double at) {
    if (at >= share) edit(row);
  }};
}

inline Wrong creeping(std::function<void(OtherRow&, double)> edit) { return {.after = edit}; }

// Grows evenly from the first row to the last; `grow` gets what was added since the row before.
inline Wrong growing(std::function<void(Machine&, double)> grow) {
  auto before = std::make_shared<double>(0);
  return {.before = [=](Machine& machine, double at) {
    grow(machine, at - *before);
    *before = at;
  }};
}

inline constexpr double kDegree = std::numbers::pi / 180;

// Of a slide, 0.3 mm for every 0.1 degrees.
inline Wrong zero_moves(std::size_t joint, double degrees, double share = 0.55) {
  return from(share, [=](Machine& machine) {
    Joint& moved = machine.joints[joint];
    (moved.turns ? moved.theta : moved.d) += degrees * (moved.turns ? kDegree : 3e-3);
  });
}
// The third joint with the second, or where it slides the fifth with the fourth.
inline Wrong coupled(double ratio) {
  return always([=](Machine& machine) {
    const std::size_t from = machine.joints[2].turns ? 1 : 3;
    machine.couplings.push_back({from + 1, from, ratio});
  });
}
// What a person reads, and will read so when the arm is used.
inline Wrong read_as(std::function<void(OtherRow&)> edit) {
  Wrong wrong = seen(std::move(edit));
  wrong.lasts = true;
  return wrong;
}
inline Wrong reading(std::size_t joint, double factor, double offset_degrees = 0) {
  return read_as(
      [=](OtherRow& row) { row.q[joint] = factor * row.q[joint] + offset_degrees * kDegree; });
}
inline Wrong positions(double x, double y, double z) {
  return seen([=](OtherRow& row) { row.p = {x * row.p[0], y * row.p[1], z * row.p[2]}; });
}

inline std::vector<Unsound> changes_of_place() {
  const std::vector<std::string> place{"positions are shifted", "measured from another place",
                                       "positions are turned", "sensor"};
  const auto moved = [](double way, double share = 0.55) {
    return from(share, [=](Machine& machine) { machine.base.origin[1] += way; });
  };
  return {
      {"place moved 0.5 mm", moved(0.5e-3), place, false},
      {"place moved 2 mm", moved(2e-3, 0.4), place, false},
      {"place moved 200 mm", moved(0.2), place, false},
      {"place turned 0.05 deg", from(0.6, [](Machine& m) { m.base.turn(0, 0.05 * kDegree); }),
       place, false},
      {"place creeps 1 mm", creeping([](OtherRow& row, double at) { row.p[0] += 1e-3 * at; }),
       place, false},
      {"target reseated 0.5 mm",
       from(0.5, [](Machine& m) { m.targets[0][0] += 0.5e-3; }),
       {"target"},
       false},
      {"target reseated 5 mm",
       from(0.7, [](Machine& m) { m.targets[0][1] += 5e-3; }),
       {"target"},
       false},
      {"place and target",
       {.before = from(0.5,
                       [](Machine& m) {
                         m.base.origin[0] += 3e-3;
                         m.targets[0][1] += 2e-3;
                       })
                      .before},
       {"target", "another place", "positions are"},
       false},
      {"positions lag", {.lag = 0.004}, {"lag", "late"}, false},
      {"two targets under one number",
       {.before =
            [](Machine& m, double at) {
              m.targets[0][2] = static_cast<int>(at * 997) % 3 == 0 ? 0.15 : 0.12;
            }},
       {"target"},
       false},
      {"two changes",
       {.before =
            [a = from(0.35, [](Machine& m) { m.base.origin[0] += 2e-3; }),
             b = from(0.7, [](Machine& m) { m.joints[1].theta += 0.2 * kDegree; })](Machine& m,
                                                                                    double at) {
              a.before(m, at);
              b.before(m, at);
            }},
       {"joint 2", "positions are", "another place"},
       false},
  };
}

inline std::vector<Unsound> changes_of_arm() {
  return {
      {"zero 1 moves 0.1 deg", zero_moves(0, 0.1), {"joint 1", "positions are", "place"}},
      {"zero 2 moves 0.1 deg", zero_moves(1, 0.1), {"joint 2"}},
      {"zero 2 moves 1 deg", zero_moves(1, 1, 0.3), {"joint 2"}},
      {"zero 3 moves -0.15 deg", zero_moves(2, -0.15), {"joint 3"}},
      {"zero 5 moves 0.3 deg", zero_moves(4, 0.3), {"joint 5"}},
      {"several zeros",
       from(0.5,
            [](Machine& m) {
              for (std::size_t j = 1; j < 5; ++j)
                m.joints[j].theta += (j % 2 == 0 ? 0.2 : -0.15) * kDegree;
            }),
       {"several readings", "joint 2"}},
      {"gear 3 changes", from(0.5, [](Machine& m) { m.joints[2].gain += 4e-3; }), {"joint 3"}},
      {"load is taken",
       from(0.5,
            [](Machine& m) {
              for (Joint& joint : m.joints) joint.softness += 0.8e-3;
            }),
       {"bends otherwise", "load", "gives way"}},
      {"link 2 bent",
       from(0.5,
            [](Machine& m) {
              m.joints[1].a += 0.5e-3;
              m.joints[1].alpha += 0.1 * kDegree;
            }),
       {"link", "joint", "axis"}},
      {"arm warms",
       growing([](Machine& m, double more) {
         for (Joint& joint : m.joints) {
           joint.a *= 1 + 2e-3 * more;
           joint.d *= 1 + 2e-3 * more;
         }
       }),
       {"length", "warm"}},
      {"zero 2 creeps",
       growing([](Machine& m, double more) { m.joints[1].theta += 0.2 * kDegree * more; }),
       {"joint 2"}},
      {"coupling 0.005",
       always([](Machine& m) { m.couplings.push_back({4, 3, 0.005}); }),
       {"joint 5 follows joint 4"}},
      {"coupling 0.05",
       coupled(-0.05),
       {"joint 3 follows joint 2", "joint 3 is coupled to joint 2", "joint 5 follows joint 4",
        "joint 5 is coupled to joint 4"}},
      {"coupling 1",
       coupled(-1),
       {"joint 3 follows joint 2", "joint 3 is coupled to joint 2",
        "joint 3 seems to follow joint 2", "joint 5 follows joint 4",
        "joint 5 is coupled to joint 4", "joint 5 seems to follow joint 4"}},
  };
}

inline std::vector<Unsound> wrong_columns() {
  const auto every = [](std::function<void(OtherRow&)> edit) { return seen(std::move(edit)); };
  return {
      {"metres as millimetres", positions(1e-3, 1e-3, 1e-3), {"metres"}, false},
      {"inches", positions(1 / 25.4, 1 / 25.4, 1 / 25.4), {"inches"}, false},
      {"x mirrored", positions(-1, 1, 1), {"mirror"}, false},
      {"y and z swapped",
       every([](OtherRow& row) { std::swap(row.p[1], row.p[2]); }),
       {"mirror", "swapped"},
       false},
      {"x in inches", positions(1 / 25.4, 1, 1), {"x is in another unit", "x"}, false},
      {"z 3000 ppm long", positions(1, 1, 1.003), {"axes are not of one scale"}, false},
      {"all 1 % long", positions(1.01, 1.01, 1.01), {"all lengths"}, false},
      {"readings in radians",
       every([](OtherRow& row) {
         for (double& q : row.q) q *= kDegree;
       }),
       {"radians"}},
      {"joint 2 in radians", reading(1, kDegree), {"joint 2"}},
      {"joint 2 reversed", reading(1, -1), {"joint 2"}},
      {"joint 3 off by 90 deg", reading(2, 1, 90), {"joint 3", "zero"}},
      {"gear 2 off by 2 %", reading(1, 1.02), {"joint 2"}},
      {"readings 1 and 2 swapped",
       read_as([](OtherRow& row) { std::swap(row.q[0], row.q[1]); }),
       {"swapped"}},
      {"a row late",
       {.at_last =
            [](std::vector<OtherRow>& rows) {
              for (std::size_t k = rows.size() - 1; k > 0; --k) rows[k].p = rows[k - 1].p;
            }},
       {"out of step"},
       false},
      {"reading 3 off by 90 deg from the middle on",
       seen([](OtherRow& row) { row.q[2] -= 90 * kDegree; }, 0.5),
       {"joint 3"}},
      {"sigma a thousand times",
       every([](OtherRow& row) { row.sigma = {0.2, 0.2, 0.2}; }),
       {"sigma_mm"},
       false},
  };
}

inline std::vector<Unsound> unsound() {
  std::vector<Unsound> all = changes_of_place();
  for (const auto& more : {changes_of_arm(), wrong_columns()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace armsig::mistakes::other
