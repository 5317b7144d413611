// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/geometry_alone.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/calibration/chain.hpp"
#include "core/calibration/standing_still.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::calibration {

namespace {

constexpr int kMostGeometrySteps = 30;
constexpr double kSmallStep = 1e-9;  // rad or m
// What one pose must move a target by, per rad or m, for an unknown to be worth moving.
constexpr double kLeastEffect = 1e-5;

// With the origin of the last link as a target where that link has none.
Signature with_tool(const Signature& signature) {
  const std::size_t n = signature.joint_count();
  Signature complete = signature;
  const bool has_tool = std::ranges::any_of(signature.targets,
                                            [&](const Target& target) { return target.link == n; });
  if (!has_tool && !complete.targets.full()) {
    Target tool;
    tool.link = n;
    tool.p_S = signature.X_SL[n].p;
    complete.targets.push_back(tool);
  }
  return complete;
}

// One pose's rows of the linear problem.
void absorb_pose(const Layout& layout, const Signature& signature, const PoeChain& said,
                 const Signature& exact, const PoeChain& whole, const JointVector& readings,
                 SquareRootFactor& factor) {
  const JointMotion moved = said.motion(readings);
  const JointMotion turned = whole.motion(readings);
  PointJacobian jacobian;
  RowBlock<3> block;
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    said.point_and_jacobian(moved, signature.targets[t], jacobian);
    const Vector3 miss = whole.point(turned, exact.targets[t]) - jacobian.p_S;
    block.clear(layout.size());
    add_derivatives(layout, signature, said, moved, t, jacobian, block);
    for (std::size_t c = 0; c < 3; ++c) {
      block.rows[c][layout.size()] = miss[static_cast<Eigen::Index>(c)];
    }
    factor.absorb(block);
  }
}

// What no pose determines stays where it was, `moved` ago.
void absorb_prior(std::size_t unknowns, double weight, const StateVector& moved,
                  SquareRootFactor& factor) {
  RowBlock<1> block;
  for (std::size_t c = 0; c < unknowns; ++c) {
    block.clear(unknowns);
    block.rows[0][c] = weight;
    block.rows[0][unknowns] = -weight * moved[c];
    factor.absorb(block);
  }
}

Pose last_link(const Signature& signature, const ReadingModel& readings, const JointVector& q) {
  return kinematics::link_pose(signature, true_readings(readings, signature.configuration, q),
                               signature.joint_count());
}

// The last link's frame as it is in the mean: no target says how it is turned about its axis.
void follow_last_link(const Signature& exact, const ReadingModel& whole, const ReadingModel& said,
                      std::span<const JointVector> poses, Signature& signature) {
  Vector3 turn = Vector3::Zero();
  Vector3 shift = Vector3::Zero();
  for (const JointVector& q : poses) {
    const Pose X = last_link(signature, said, q).inverse() * last_link(exact, whole, q);
    turn += rotation_vector(X.R);
    shift += X.p;
  }
  const double share = 1 / static_cast<double>(poses.size());
  const Pose X_mean{numerics::rotation_by(share * turn), share * shift};
  signature.X_SL[signature.joint_count()] = signature.X_SL[signature.joint_count()] * X_mean;
}

}  // namespace

FixedVector<JointLimits, kMaxJoints> covered_limits(
    const ArmModel& model, const FixedVector<JointLimits, kMaxJoints>& limits) {
  FixedVector<JointLimits, kMaxJoints> covered = limits;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const JointLimits& measured = model.joints[i].covered;
    if (!(measured.lower < measured.upper)) continue;
    ReadingSpan span;
    span.add(measured.lower);
    span.add(measured.upper);
    if (!span.is_jitter(model.joints[i].type)) covered[i] = measured;
  }
  return covered;
}

JointVector covered_configuration(const ArmModel& model,
                                  const FixedVector<JointLimits, kMaxJoints>& limits, int n) {
  return work_configuration(types_of(model.joints), covered_limits(model, limits), n);
}

Leftover difference(const Signature& exact, const ReadingModel& whole, const Signature& signature,
                    const ReadingModel& said, std::span<const JointVector> poses) {
  const Signature from = with_tool(exact);
  const Signature to = with_tool(signature);
  const PoeChain true_chain(from, whole);
  const PoeChain chain(to, said);
  Leftover left;
  double squares = 0;
  for (const JointVector& q : poses) {
    const JointMotion turned = true_chain.motion(q);
    const JointMotion moved = chain.motion(q);
    for (std::size_t t = 0; t < from.targets.size(); ++t) {
      const double miss_m =
          (true_chain.point(turned, from.targets[t]) - chain.point(moved, to.targets[t])).norm();
      squares += miss_m * miss_m;
      left.largest_m = std::max(left.largest_m, miss_m);
    }
  }
  left.rms_m = std::sqrt(squares / static_cast<double>(poses.size() * from.targets.size()));
  return left;
}

Judged<void> fit_geometry_alone(const ReadingModel& whole, const ReadingModel& said,
                                std::span<const JointVector> poses, Signature& signature) {
  if (poses.empty()) return std::unexpected(Refusal{Error::kTooFewPoints, 0, 1});
  const Signature exact = with_tool(signature);
  Signature fitted = exact;
  std::array<bool, kMaxTargets> observed{};
  std::fill_n(observed.begin(), exact.targets.size(), true);
  ARMSIG_TRY(layout, make_layout(fitted, observed, {}, 0));
  const PoeChain true_chain(exact, whole);
  ReadingModel readings = said;
  SquareRootFactor factor;
  const double prior = kLeastEffect * std::sqrt(static_cast<double>(poses.size()));
  StateVector moved{};
  double largest = 0;
  for (int step = 0; step < kMostGeometrySteps; ++step) {
    const PoeChain chain(fitted, said);
    factor.reset(layout.size());
    absorb_prior(layout.size(), prior, moved, factor);
    for (const JointVector& q : poses) {
      absorb_pose(layout, fitted, chain, exact, true_chain, q, factor);
    }
    const auto x = factor.solve();
    if (!x) return std::unexpected(Refusal{x.error(), 0, 0});
    largest = 0;
    for (std::size_t c = 0; c < layout.size(); ++c) {
      moved[c] += (*x)[c];
      largest = std::max(largest, std::abs((*x)[c]));
    }
    apply_corrections(layout, *x, 1.0, fitted, readings);
    if (largest < kSmallStep) break;
  }
  if (!(largest < kSmallStep)) {
    return std::unexpected(Refusal{Error::kNotConverged, largest, kSmallStep});
  }
  follow_last_link(exact, whole, said, poses, fitted);
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    signature.targets[t].p_S = fitted.targets[t].p_S;
  }
  signature.X_SL = fitted.X_SL;
  return {};
}

}  // namespace armsig::calibration
