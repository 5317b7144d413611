// SPDX-License-Identifier: MIT
// The arms of the shared data as the kinematics tests use them: exact chains, with their limits.
#pragma once

#include <array>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::test {

struct KnownArm {
  const char* name;
  FixedVector<DhJoint, kMaxJoints> rows;
  FixedVector<JointLimits, kMaxJoints> limits;
};

inline constexpr double kMm = 1e-3;

// puma560.yaml
inline KnownArm puma560() {
  return {"puma560",
          {{JointType::kRevolute, 0, 0, 0, radians(-90)},
           {JointType::kRevolute, 0, 149.09 * kMm, 431.8 * kMm, 0},
           {JointType::kRevolute, 0, 0, -20.32 * kMm, radians(90)},
           {JointType::kRevolute, 0, 430.7 * kMm, 0, radians(-90)},
           {JointType::kRevolute, 0, 0, 0, radians(90)},
           {JointType::kRevolute, 0, 0, 0, 0}},
          {{radians(-160), radians(160)},
           {radians(-225), radians(45)},
           {radians(-45), radians(225)},
           {radians(-110), radians(170)},
           {radians(-100), radians(100)},
           {radians(-266), radians(266)}}};
}

// puma560-stone1986-robot1.yaml
inline KnownArm puma560_stone1986_robot1() {
  return {
      "puma560-stone1986-robot1",
      {{JointType::kRevolute, radians(110.308), -206.78 * kMm, -0.05 * kMm, radians(-90.066)},
       {JointType::kRevolute, radians(79.977), 112102.13 * kMm, 76.07 * kMm, radians(-0.217)},
       {JointType::kRevolute, radians(-79.483), -111949.78 * kMm, -20.39 * kMm, radians(90.519)},
       {JointType::kRevolute, radians(-0.296), 432.78 * kMm, -0.01 * kMm, radians(-90.007)},
       {JointType::kRevolute, radians(-0.497), -0.18 * kMm, 0.02 * kMm, radians(89.99)},
       {JointType::kRevolute, radians(-89.081), 103.0 * kMm, 0, 0}},
      {{radians(-160), radians(160)},
       {radians(-225), radians(45)},
       {radians(-45), radians(225)},
       {radians(-110), radians(170)},
       {radians(-100), radians(100)},
       {radians(-266), radians(266)}}};
}

// puma560-stone1986-robot2.yaml
inline KnownArm puma560_stone1986_robot2() {
  return {"puma560-stone1986-robot2",
          {{JointType::kRevolute, radians(110.849), -204.28 * kMm, -0.23 * kMm, radians(-90.013)},
           {JointType::kRevolute, radians(63.467), 27835.8 * kMm, 190.84 * kMm, radians(-0.803)},
           {JointType::kRevolute, radians(-63.276), -27685.74 * kMm, -20.28 * kMm, radians(90.134)},
           {JointType::kRevolute, radians(0.328), 432.99 * kMm, -0.09 * kMm, radians(-89.991)},
           {JointType::kRevolute, radians(-0.126), -0.54 * kMm, 0.07 * kMm, radians(89.969)},
           {JointType::kRevolute, radians(-89.517), 102.73 * kMm, 0, 0}},
          {{radians(-160), radians(160)},
           {radians(-225), radians(45)},
           {radians(-45), radians(225)},
           {radians(-110), radians(170)},
           {radians(-100), radians(100)},
           {radians(-266), radians(266)}}};
}

// stanford.yaml
inline KnownArm stanford() {
  return {"stanford",
          {{JointType::kRevolute, 0, 412 * kMm, 0, radians(-90)},
           {JointType::kRevolute, 0, 154 * kMm, 0, radians(90)},
           {JointType::kPrismatic, radians(-90), 0, 20.3 * kMm, 0},
           {JointType::kRevolute, 0, 0, 0, radians(-90)},
           {JointType::kRevolute, 0, 0, 0, radians(90)},
           {JointType::kRevolute, 0, 0, 0, 0}},
          {{radians(-170), radians(170)},
           {radians(-170), radians(170)},
           {300 * kMm, 1000 * kMm},
           {radians(-170), radians(170)},
           {radians(-90), radians(90)},
           {radians(-170), radians(170)}}};
}

// ur5.yaml
inline KnownArm ur5() {
  return {"ur5",
          {{JointType::kRevolute, 0, 0.089159, 0, 1.570796327},
           {JointType::kRevolute, 0, 0, -0.425, 0},
           {JointType::kRevolute, 0, 0, -0.39225, 0},
           {JointType::kRevolute, 0, 0.10915, 0, 1.570796327},
           {JointType::kRevolute, 0, 0.09465, 0, -1.570796327},
           {JointType::kRevolute, 0, 0.0823, 0, 0}},
          {{radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)}}};
}

// ur10e.yaml
inline KnownArm ur10e() {
  return {"ur10e",
          {{JointType::kRevolute, 0, 0.1807, 0, 1.570796327},
           {JointType::kRevolute, 0, 0, -0.6127, 0},
           {JointType::kRevolute, 0, 0, -0.57155, 0},
           {JointType::kRevolute, 0, 0.17415, 0, 1.570796327},
           {JointType::kRevolute, 0, 0.11985, 0, -1.570796327},
           {JointType::kRevolute, 0, 0.11655, 0, 0}},
          {{radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)}}};
}

// ur10e-individual-a.yaml
inline KnownArm ur10e_individual_a() {
  return {"ur10e-individual-a",
          {{JointType::kRevolute, 1.5961352531693174e-07, 0.18055510502488192,
            0.00010865106862793039, 1.5703515450471581},
           {JointType::kRevolute, -0.9172096215288302, 303.4691356661582, -0.3723758247494677,
            -0.0016021511253121415},
           {JointType::kRevolute, 7.129361313464995, -309.88394307789747, -0.5697437181978651,
            0.006319177933310919},
           {JointType::kRevolute, 0.07102990294243923, 6.58874904397395, 2.630761491656844e-05,
            1.5691457745265918},
           {JointType::kRevolute, -1.6425897652605492e-06, 0.11980517670998099,
            3.966386325000127e-06, -1.570032644484455},
           {JointType::kRevolute, 9.172861010348088e-08, 0.11567928597209635, 0, 0}},
          {{radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)}}};
}

// ur10e-individual-b.yaml
inline KnownArm ur10e_individual_b() {
  return {"ur10e-individual-b",
          {{JointType::kRevolute, -2.4147806894359025e-07, 0.18053981171425867,
            2.122348655712059e-05, 1.5701460804424159},
           {JointType::kRevolute, 1.6023395238669456, 439.14097407990096, 0.01931713262770063,
            0.001394166668255904},
           {JointType::kRevolute, -1.686071907521713, -446.02705980633215, -0.5692516636110877,
            0.006938188803259951},
           {JointType::kRevolute, 0.08373311477001187, 7.0603368964236015, -4.614090237209339e-05,
            1.5699846854376098},
           {JointType::kRevolute, -1.0126035587115778e-07, 0.11981134115031418,
            -6.392800534718015e-05, -1.5703852064954293},
           {JointType::kRevolute, 3.919862091861237e-08, 0.11567091725742626, 0, 0}},
          {{radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)},
           {radians(-360), radians(360)}}};
}

// cobra600.yaml
inline KnownArm cobra600() {
  return {"cobra600",
          {{JointType::kRevolute, 0, 387 * kMm, 325 * kMm, 0},
           {JointType::kRevolute, 0, 0, 275 * kMm, radians(180)},
           {JointType::kPrismatic, 0, 0, 0, 0},
           {JointType::kRevolute, 0, 0, 0, 0}},
          {{radians(-50), radians(50)},
           {radians(-88), radians(88)},
           {0 * kMm, 210 * kMm},
           {radians(-180), radians(180)}}};
}

// iiwa7.yaml
inline KnownArm iiwa7() {
  return {"iiwa7",
          {{JointType::kRevolute, 0, 340 * kMm, 0, radians(-90)},
           {JointType::kRevolute, 0, 0, 0, radians(90)},
           {JointType::kRevolute, 0, 400 * kMm, 0, radians(90)},
           {JointType::kRevolute, 0, 0, 0, radians(-90)},
           {JointType::kRevolute, 0, 400 * kMm, 0, radians(-90)},
           {JointType::kRevolute, 0, 0, 0, radians(90)},
           {JointType::kRevolute, 0, 126 * kMm, 0, 0}},
          {{radians(-170), radians(170)},
           {radians(-120), radians(120)},
           {radians(-170), radians(170)},
           {radians(-120), radians(120)},
           {radians(-170), radians(170)},
           {radians(-120), radians(120)},
           {radians(-175), radians(175)}}};
}

inline std::array<KnownArm, 8> six_joint_arms() {
  return {puma560(), puma560_stone1986_robot1(), puma560_stone1986_robot2(), stanford(), ur5(),
          ur10e(),   ur10e_individual_a(),       ur10e_individual_b()};
}

inline std::array<KnownArm, 10> known_arms() {
  return {puma560(), puma560_stone1986_robot1(), puma560_stone1986_robot2(), stanford(), ur5(),
          ur10e(),   ur10e_individual_a(),       ur10e_individual_b(),       cobra600(), iiwa7()};
}

}  // namespace armsig::test
