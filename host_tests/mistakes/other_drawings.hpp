// SPDX-License-Identifier: MIT
// Nominal models of arms of eight kinds, by makers' tables, for the machines that share no code.
#pragma once

#include "host_tests/mistakes/other_machine.hpp"

namespace armsig::mistakes::other {

// Angles in degrees, lengths in millimetres.
inline Joint turning(double theta, double d, double a, double alpha, double reach, double home) {
  constexpr double kDegree = std::numbers::pi / 180;
  return {.turns = true,
          .theta = theta * kDegree,
          .d = 1e-3 * d,
          .a = 1e-3 * a,
          .alpha = alpha * kDegree,
          .low = (home - reach) * kDegree,
          .high = (home + reach) * kDegree,
          .home = home * kDegree};
}
inline Joint sliding(double theta, double a, double alpha, double low, double high) {
  constexpr double kDegree = std::numbers::pi / 180;
  return {.turns = false,
          .theta = theta * kDegree,
          .d = 0,
          .a = 1e-3 * a,
          .alpha = alpha * kDegree,
          .low = 1e-3 * low,
          .high = 1e-3 * high,
          .home = 0.5e-3 * (low + high)};
}

inline std::vector<Joint> ur10e_joints() {
  return {turning(0, 180.7, 0, 90, 150, 0),    turning(0, 0, -612.7, 0, 80, -80),
          turning(0, 0, -571.55, 0, 120, 60),  turning(0, 174.15, 0, 90, 150, 0),
          turning(0, 119.85, 0, -90, 100, 60), turning(0, 116.55, 0, 0, 170, 0)};
}

inline Machine rail_machine() {
  Machine rail{.name = "rail", .joints = {sliding(0, 0, -90, 0, 2000)}};
  std::vector<Joint> arm = ur10e_joints();
  rail.joints.insert(rail.joints.end(), arm.begin(), arm.end());
  rail.down = {0, -1, 0};
  return rail;
}

inline Machine palletizer() {
  return {.name = "palletizer",
          .joints = {turning(0, 800, 260, -90, 160, 0), turning(0, 0, 1000, 0, 45, -65),
                     turning(0, 0, 1100, 0, 55, 55), turning(0, 0, 220, -90, 60, 0),
                     turning(0, 200, 0, 0, 170, 0)},
          .couplings = {{3, 1, -1}, {3, 2, -1}}};
}

constexpr std::size_t kPalletizer = 7;
constexpr std::size_t kDrawings = 8;

inline std::vector<Machine> drawings() {
  return {
      {.name = "puma",
       .joints = {turning(0, 0, 0, -90, 160, 0), turning(0, 149.09, 431.8, 0, 100, -60),
                  turning(0, 0, -20.32, 90, 110, 70), turning(0, 430.7, 0, -90, 130, 30),
                  turning(0, 0, 0, 90, 100, 30), turning(0, 0, 0, 0, 170, 0)}},
      {.name = "ur10e", .joints = ur10e_joints()},
      {.name = "iiwa",
       .joints = {turning(0, 340, 0, -90, 160, 0), turning(0, 0, 0, 90, 80, 30),
                  turning(0, 400, 0, 90, 160, 0), turning(0, 0, 0, -90, 80, -40),
                  turning(0, 400, 0, -90, 160, 0), turning(0, 0, 0, 90, 80, 30),
                  turning(0, 126, 0, 0, 170, 0)}},
      {.name = "scara",
       .joints = {turning(0, 387, 325, 0, 105, 0), turning(0, 0, 275, 180, 88, 40),
                  sliding(0, 0, 0, 0, 210), turning(0, 0, 0, 0, 170, 0)}},
      {.name = "stanford",
       .joints = {turning(0, 412, 0, -90, 160, 0), turning(0, 154, 0, 90, 90, 60),
                  sliding(-90, 20.3, 0, 300, 1000), turning(0, 0, 0, -90, 160, 0),
                  turning(0, 0, 0, 90, 85, 30), turning(0, 0, 0, 0, 170, 0)}},
      rail_machine(),
      {.name = "gantry",
       .joints = {sliding(90, 0, 90, 0, 1500), sliding(90, 0, 90, 0, 1000),
                  sliding(0, 0, 0, 0, 600), turning(0, 100, 0, -90, 160, 0),
                  turning(0, 0, 0, 90, 90, 60), turning(0, 120, 0, 0, 170, 0)},
       .down = {0, 1, 0}},
      palletizer(),
  };
}

}  // namespace armsig::mistakes::other
