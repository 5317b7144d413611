// SPDX-License-Identifier: MIT
#include "firmware/paper_arms/paper_arms.hpp"

#include "core/base/pose.hpp"

namespace armsig::tool {
namespace {

struct PrintedRow {
  double theta_deg, d_cm, a_cm, alpha_deg;  // the units of the paper's tables
};
using PrintedTable = std::array<PrintedRow, 6>;

constexpr PrintedTable kTable1{{{0, 0.0, 0.0, -90.0},
                                {0, 14.909, 43.18, 0.0},
                                {0, 0.0, -2.032, 90.0},
                                {0, 43.07, 0.0, -90.0},
                                {0, 0.0, 0.0, 90.0},
                                {0, 0.0, 0.0, 0.0}}};
constexpr PrintedTable kTable2Robot1{{{110.308, -20.678, -0.005, -90.066},
                                      {79.977, 11210.213, 7.607, -0.217},
                                      {-79.483, -11194.978, -2.039, 90.519},
                                      {-0.296, 43.278, -0.001, -90.007},
                                      {-0.497, -0.018, 0.002, 89.990},
                                      {-89.081, 10.300, 0.000, 0.000}}};
constexpr PrintedTable kTable2Robot2{{{110.849, -20.428, -0.023, -90.013},
                                      {63.467, 2783.580, 19.084, -0.803},
                                      {-63.276, -2768.574, -2.028, 90.134},
                                      {0.328, 43.299, -0.009, -89.991},
                                      {-0.126, -0.054, 0.007, 89.969},
                                      {-89.517, 10.273, 0.000, 0.000}}};
constexpr std::array<std::array<double, 2>, 6> kLimits_deg{
    {{-160, 160}, {-225, 45}, {-45, 225}, {-110, 170}, {-100, 100}, {-266, 266}}};

Arm arm_of(const PrintedTable& table) {
  Arm arm;
  for (std::size_t i = 0; i < table.size(); ++i) {
    arm.joints.push_back({.type = JointType::kRevolute,
                          .theta_rad = radians(table[i].theta_deg),
                          .d_m = table[i].d_cm / 100,
                          .a_m = table[i].a_cm / 100,
                          .alpha_rad = radians(table[i].alpha_deg)});
    arm.limits.push_back({radians(kLimits_deg[i][0]), radians(kLimits_deg[i][1])});
  }
  return arm;
}

}  // namespace

Arm puma560() { return arm_of(kTable1); }

Arm table2_robot(int robot) { return arm_of(robot == 1 ? kTable2Robot1 : kTable2Robot2); }

std::array<double, 4> table3(int robot) {
  if (robot == 1) return {4.6, 20.0, 9.1, 33.3};
  return {7.7, 14.3, 4.8, 4.2};
}

}  // namespace armsig::tool
