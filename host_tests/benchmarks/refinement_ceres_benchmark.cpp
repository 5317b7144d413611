// SPDX-License-Identifier: MIT
// The same refinement by Ceres: same unknowns, same priors, and the same answer, which is checked.
//
// The form that Ceres is fastest with: one block of unknowns an axis and one for the target, so
// that a swept point has seven derivatives and not 27.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cstdlib>
#include <memory>

#include "core/uncertainty/tool_covariance.hpp"
#include "host_tests/benchmarks/refinement_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

constexpr std::size_t kJoints = 6;

// About the start, as core/refinement/parameters.hpp has them: the turn of each axis about x, y of
// its link frame and its shift along them; the shift of the target.
struct Unknowns {
  std::array<std::array<double, 4>, kJoints> axis{};
  std::array<double, 3> target{};
};

// Turns p about the corrected axis of a joint.
template <typename T>
void turn_about(const Pose& X_SL, const T* axis, double moved, T* p) {
  const T turn[3] = {axis[0], axis[1], T(0)};
  const T z[3] = {T(0), T(0), T(1)};
  T turned_z[3];
  ceres::AngleAxisRotatePoint(turn, z, turned_z);
  T rotation[3];
  T origin[3];
  T arm[3];
  for (int r = 0; r < 3; ++r) {
    rotation[r] = T(0);
    for (int c = 0; c < 3; ++c) rotation[r] += X_SL.R(r, c) * turned_z[c] * moved;
    origin[r] = X_SL.p[r] + X_SL.R(r, 0) * axis[2] + X_SL.R(r, 1) * axis[3];
    arm[r] = p[r] - origin[r];
  }
  T turned[3];
  ceres::AngleAxisRotatePoint(rotation, arm, turned);
  for (int r = 0; r < 3; ++r) p[r] = origin[r] + turned[r];
}

struct MeasuredRow {
  const Signature* start;
  const refinement::Observation* row;

  template <typename T>
  void start_at_target(const T* shift, T* p) const {
    for (int c = 0; c < 3; ++c) p[c] = start->targets[0].p_S[c] + shift[c];
  }
  template <typename T>
  void turn(std::size_t joint, const T* axis, T* p) const {
    const double moved = row->readings[joint] - start->configuration[joint];
    turn_about(start->X_SL[joint], axis, moved, p);
  }
  template <typename T>
  void compare(const T* p, T* residual) const {
    for (int c = 0; c < 3; ++c) residual[c] = (p[c] - row->p_S[c]) / kRefinementSigma_m;
  }
};

struct SweptRow : MeasuredRow {
  template <typename T>
  bool operator()(const T* axis, const T* target, T* residual) const {
    T p[3];
    start_at_target(target, p);
    turn(row->sweep - 1, axis, p);
    compare(p, residual);
    return true;
  }
};

struct MixedRow : MeasuredRow {
  template <typename T>
  bool operator()(const T* axis1, const T* axis2, const T* axis3, const T* axis4, const T* axis5,
                  const T* axis6, const T* target, T* residual) const {
    const std::array<const T*, kJoints> axes = {axis1, axis2, axis3, axis4, axis5, axis6};
    T p[3];
    start_at_target(target, p);
    for (std::size_t i = kJoints; i-- > 0;) turn(i, axes[i], p);
    compare(p, residual);
    return true;
  }
};

template <int kCount>
struct PriorOn {
  std::array<double, kCount> sigma;
  template <typename T>
  bool operator()(const T* x, T* residual) const {
    for (std::size_t i = 0; i < kCount; ++i) residual[i] = x[i] / sigma[i];
    return true;
  }
};

void add_row(const MeasuredRow& measured, Unknowns& x, ceres::Problem& problem) {
  if (measured.row->sweep > 0) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SweptRow, 3, 4, 3>(new SweptRow{measured}), nullptr,
        x.axis[measured.row->sweep - 1].data(), x.target.data());
  } else {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<MixedRow, 3, 4, 4, 4, 4, 4, 4, 3>(new MixedRow{measured}),
        nullptr, x.axis[0].data(), x.axis[1].data(), x.axis[2].data(), x.axis[3].data(),
        x.axis[4].data(), x.axis[5].data(), x.target.data());
  }
}

void add_priors(Unknowns& x, ceres::Problem& problem) {
  const refinement::Prior prior;
  const std::array<double, 4> of_axis = {prior.direction_rad, prior.direction_rad, prior.position_m,
                                         prior.position_m};
  for (auto& axis : x.axis) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PriorOn<4>, 4, 4>(new PriorOn<4>{of_axis}), nullptr,
        axis.data());
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorOn<3>, 3, 3>(
                               new PriorOn<3>{{prior.target_m, prior.target_m, prior.target_m}}),
                           nullptr, x.target.data());
}

Unknowns refined_by_ceres(const RefinementWork& work) {
  Unknowns x;
  ceres::Problem problem;
  for (const auto& row : work.log) add_row({&work.start, &row}, x, problem);
  add_priors(x, problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-12;  // at Ceres' own 1e-6 the answer is not the same to 1e-9
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
  return x;
}

// Largest distance between where both put the target, at poses of its own.
double distance_between(const RefinementWork& work, const refinement::Refined& refined,
                        const Unknowns& x) {
  test::Random random(7);
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    refinement::Observation at;
    at.readings = random.configuration(work.cell.arm);
    Vector3 residual;
    MixedRow{{&work.start, &at}}(x.axis[0].data(), x.axis[1].data(), x.axis[2].data(),
                                 x.axis[3].data(), x.axis[4].data(), x.axis[5].data(),
                                 x.target.data(), residual.data());
    const Vector3 p_S = kRefinementSigma_m * residual;
    largest = std::max(largest, (uncertainty::tool_position(refined, at.readings, 0) - p_S).norm());
  }
  return largest;
}

struct RefinementRows {
  RefinementRows() {
    for (const RefinementLog& of : kRefinementLogs) {
      const Row row(
          of.path, "Ceres",
          [of] {
            return [work = refinement_work(of),
                    refined = std::make_shared<refinement::Refined>()](std::size_t calls) {
              refine(work, *refined);
              for (std::size_t k = 0; k < calls; ++k) {
                const Unknowns x = refined_by_ceres(work);
                if (k == 0 && distance_between(work, *refined, x) > 1e-9) std::abort();
                keep(x);
              }
            };
          },
          1);
    }
  }
};
const RefinementRows kRefinementRows;

}  // namespace
}  // namespace armsig::benchmarks
