// SPDX-License-Identifier: MIT
// Solve after predict: of any arm the readings that forward() was asked for bring inverse() to the
// same pose, or it says why not; what it says is true.
#include <array>
#include <bit>
#include <cmath>

#include "core/base/pose.hpp"
#include "core/kinematics/inverse.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using kinematics::Chain;
using kinematics::Verdict;

// Angles are mostly right, as arms are built.
double angle_of(Tape& tape) {
  const std::uint8_t kind = tape.byte();
  if (kind < 192) return (kind % 4) * kPi / 2;
  return kPi * tape.share();
}

Chain chain_of(Tape& tape) {
  DhRows rows;
  FixedVector<JointLimits, kMaxJoints> limits;
  const std::size_t count = 1 + tape.below(kMaxJoints);
  for (std::size_t i = 0; i < count; ++i) {
    DhJoint row;
    row.type = tape.byte() < 32 ? JointType::kPrismatic : JointType::kRevolute;
    row.theta_rad = angle_of(tape);
    row.d_m = tape.byte() < 128 ? 0 : tape.share();
    row.a_m = tape.byte() < 128 ? 0 : tape.share();
    row.alpha_rad = angle_of(tape);
    rows.push_back(row);
    limits.push_back({-2 * kPi, 2 * kPi});
  }
  return kinematics::make_chain(rows, limits);
}

JointVector readings_of(Tape& tape, std::size_t count, double most) {
  JointVector q;
  for (std::size_t i = 0; i < count; ++i) q.push_back(most * tape.share());
  return q;
}

double distance(const Pose& a, const Pose& b) {
  return std::fmax((a.p - b.p).norm(), (a.R - b.R).norm() / std::sqrt(2.0));
}

void fuzz_kinematics(Bytes bytes) {
  Tape tape(bytes);
  const Chain chain = chain_of(tape);
  const JointVector q = readings_of(tape, chain.joint_count, kPi);
  const auto X = kinematics::forward(chain, q);
  FUZZ_CHECK(X && X->p.allFinite());
  FUZZ_CHECK((X->R * X->R.transpose() - Matrix3::Identity()).norm() < 1e-12);
  JointVector seed = q;
  const JointVector off = readings_of(tape, chain.joint_count, 0.5);
  for (std::size_t i = 0; i < seed.size(); ++i) seed[i] += off[i];
  const auto found = kinematics::inverse(chain, *X, seed);
  FUZZ_CHECK(found);
  const auto reached = kinematics::forward(chain, found->q);
  FUZZ_CHECK(reached);
  for (const double reading : found->q) FUZZ_CHECK(std::fabs(reading) <= 2 * kPi);
  FUZZ_CHECK(std::isfinite(found->regularity) && found->iterations <= 200);
  const bool met = found->verdict == Verdict::kConverged || found->verdict == Verdict::kDegraded;
  if (met && chain.joint_count >= 6) FUZZ_CHECK(distance(*X, *reached) < 1e-9);
  // Where it stands already, it stays.
  const auto stays = kinematics::inverse(chain, *X, q);
  FUZZ_CHECK(stays);
  FUZZ_CHECK(stays->verdict == Verdict::kConverged || stays->verdict == Verdict::kDegraded);
}

// Any pose and any options: words or a solution that keeps its promises.
void fuzz_inverse(Bytes bytes) {
  Tape tape(bytes);
  const Chain chain = chain_of(tape);
  const auto number = [&tape] {
    const std::uint64_t bits = (static_cast<std::uint64_t>(tape.word()) << 32U) | tape.word();
    return tape.byte() < 200 ? 3 * tape.share() : std::bit_cast<double>(bits);
  };
  Pose X{rotation_z(number()) * rotation_x(number()), Vector3(number(), number(), number())};
  JointVector seed;
  for (std::size_t i = 0; i < chain.joint_count; ++i) seed.push_back(number());
  kinematics::InverseOptions options;
  options.max_iterations = static_cast<int>(tape.byte());
  if (tape.byte() % 2 == 0) {
    for (std::size_t i = 0; i < chain.joint_count; ++i)
      options.max_step.push_back(std::fabs(number()));
  }
  options.p_nP.x() = number();
  const auto found = kinematics::inverse(chain, X, seed, options);
  if (!found) return;
  FUZZ_CHECK(found->iterations <= options.max_iterations);
  for (std::size_t i = 0; i < found->q.size(); ++i) {
    FUZZ_CHECK(std::isfinite(found->q[i]));
    if (options.max_step.empty()) {
      FUZZ_CHECK(std::fabs(found->q[i]) <= 2 * kPi);
    } else {
      const double moved = std::fabs(found->q[i] - seed[i]);
      FUZZ_CHECK(moved <= options.max_step[i] + 1e-9 * std::fmax(1, std::fabs(seed[i])));
    }
  }
}

constexpr std::array kTargets{Target{"kinematics", fuzz_kinematics},
                              Target{"inverse", fuzz_inverse}};

}  // namespace

std::span<const Target> kinematics_targets() { return kTargets; }

}  // namespace armsig::fuzz
