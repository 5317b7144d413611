// SPDX-License-Identifier: MIT
// A whole refinement of a six-joint arm from 250 measurements, beside Ceres on the same problem.
#include <cmath>
#include <cstdlib>
#include <memory>

#include "core/refinement/refinement.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/simulated_arm.hpp"

#ifdef ARMSIG_HAS_CERES
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#endif

namespace armsig::benchmarks {
namespace {

constexpr std::size_t kMeasurements = 250;
constexpr double kSigma = 2e-4;

struct RefinementWork {
  Signature start;
  test::Log log;
  test::Cell cell;
};

// Noise is kept inside the knee of the robust weights, so that least squares has the same answer.
RefinementWork work_of(bool with_sweeps) {
  test::Random random(13);
  RefinementWork work;
  work.cell = test::puma_cell(random);
  const JointVector held = test::puma_configuration();
  work.start = test::disturbed(test::signature_of(work.cell, held), 2e-3, 2e-3, random);
  if (with_sweeps) test::add_sweeps(work.cell, held, kPi, 36, 0, random, work.log);
  const auto swept = static_cast<int>(work.log.size());
  test::add_poses(work.cell, static_cast<int>(kMeasurements) - swept, 0, random, work.log);
  for (auto& row : work.log) {
    Vector3 noise = random.normal_vector(kSigma);
    if (noise.norm() > 3 * kSigma) noise *= 3 * kSigma / noise.norm();
    row.p_S += noise;
    row.sigma_m = kSigma;
  }
  return work;
}

void refine(const RefinementWork& work, std::vector<refinement::RowOutcome>& outcomes,
            refinement::Refined& refined) {
  if (!refinement::refine(work.start, work.log, {}, outcomes, refined)) std::abort();
}

#ifdef ARMSIG_HAS_CERES
constexpr int kJoints = 6;
constexpr int kUnknowns = 4 * kJoints + 3;

// The unknowns of core/refinement/parameters.hpp, all about the start: per joint the turn of its
// axis about x, y of its link frame and the shift along them, then the target.
struct PoseResidual {
  const Signature* start;
  const refinement::Observation* row;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    T p[3];
    for (int c = 0; c < 3; ++c) p[c] = start->targets[0].p_S[c] + x[4 * kJoints + c];
    for (int i = kJoints; i-- > 0;) {
      const auto joint = static_cast<std::size_t>(i);
      const Pose& X = start->X_SL[joint];
      const T* correction = x + 4 * i;
      const T turn[3] = {correction[0], correction[1], T(0)};
      const T axis_L[3] = {T(0), T(0), T(1)};
      T turned[3];
      ceres::AngleAxisRotatePoint(turn, axis_L, turned);
      T rotation[3];
      T from_axis[3];
      T origin[3];
      const double moved = row->readings[joint] - start->configuration[joint];
      for (int r = 0; r < 3; ++r) {
        rotation[r] = T(0);
        for (int c = 0; c < 3; ++c) rotation[r] += X.R(r, c) * turned[c] * moved;
        origin[r] = X.p[r] + X.R(r, 0) * correction[2] + X.R(r, 1) * correction[3];
        from_axis[r] = p[r] - origin[r];
      }
      T moved_point[3];
      ceres::AngleAxisRotatePoint(rotation, from_axis, moved_point);
      for (int r = 0; r < 3; ++r) p[r] = origin[r] + moved_point[r];
    }
    for (int c = 0; c < 3; ++c) residual[c] = (p[c] - row->p_S[c]) / kSigma;
    return true;
  }
};

using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

Unknowns refined_by_ceres(const RefinementWork& work) {
  Unknowns x = Unknowns::Zero();
  ceres::Problem problem;
  for (const auto& row : work.log) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PoseResidual, 3, kUnknowns>(
                                 new PoseResidual{&work.start, &row}),
                             nullptr, x.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
  return x;
}

// Where Ceres' answer puts the target, at poses of its own.
double distance_between(const RefinementWork& work, const refinement::Refined& refined,
                        const Unknowns& x) {
  test::Random random(7);
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    refinement::Observation at;
    at.readings = random.configuration(work.cell.arm);
    Vector3 residual;
    PoseResidual{&work.start, &at}(x.data(), residual.data());
    const Vector3 p_S = kSigma * residual;
    largest = std::max(largest, (uncertainty::tool_position(refined, at.readings, 0) - p_S).norm());
  }
  return largest;
}
#endif

struct RefinementRows {
  RefinementRows() {
    for (const bool with_sweeps : {true, false}) {
      const std::string path = with_sweeps ? "refinement, 6 joints, 216 swept and 34 mixed rows"
                                           : "refinement, 6 joints, 250 mixed rows";
      const Row own(path, "armsig", [with_sweeps] {
        return [work = work_of(with_sweeps),
                outcomes = std::vector<refinement::RowOutcome>(kMeasurements),
                refined = std::make_shared<refinement::Refined>()](std::size_t calls) mutable {
          for (std::size_t k = 0; k < calls; ++k) {
            refine(work, outcomes, *refined);
            keep(*refined);
          }
        };
      });
#ifdef ARMSIG_HAS_CERES
      const Row peer(path, "Ceres", [with_sweeps] {
        return [work = work_of(with_sweeps),
                outcomes = std::vector<refinement::RowOutcome>(kMeasurements),
                refined = std::make_shared<refinement::Refined>()](std::size_t calls) mutable {
          refine(work, outcomes, *refined);
          for (std::size_t k = 0; k < calls; ++k) {
            const Unknowns x = refined_by_ceres(work);
            // A tenth of a micrometre; priors and tolerances differ by less.
            if (distance_between(work, *refined, x) > 1e-7) std::abort();
            keep(x);
          }
        };
      });
#endif
    }
  }
};
const RefinementRows kRefinementRows;

}  // namespace
}  // namespace armsig::benchmarks
