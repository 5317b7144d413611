// SPDX-License-Identifier: MIT
// The same fit by Ceres: same unknowns, same priors, and the same answer, which is checked. Ceres
// is told sigma and the scales of the priors, which armsig finds.
//
// One block of unknowns a joint, one for the base and one for the target: the form that Ceres is
// fastest with, since every row depends on all of them.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "host_tests/benchmarks/calibration_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

constexpr std::size_t kJoints = 6;
// Units of the priors, as core/calibration/engine.hpp states them.
constexpr double kRotation = 2e-3;
constexpr double kShift_m = 1e-3;
constexpr double kZero = 10e-3;
constexpr double kBaseTurn = 1;
constexpr double kFarAway_m = 3;
// Both answers, where they put the target: a hundredth of the noise, since armsig finds its scales
// once more after its last step.
constexpr double kSame_m = 2e-6;

struct Unknowns {
  std::array<std::array<double, 5>, kJoints> joint{};  // turn x, y; shift x, y; zero
  std::array<double, 6> base{};                        // turn and shift about the start
  std::array<double, 3> target{};
};

// p moved by a pose.
template <typename T>
void move(const Pose& X, T* p) {
  T moved[3];
  for (int r = 0; r < 3; ++r) {
    moved[r] = X.R(r, 0) * p[0] + X.R(r, 1) * p[1] + X.R(r, 2) * p[2] + X.p[r];
  }
  std::copy_n(moved, 3, p);
}

struct MeasuredRow {
  const calibration::ArmModel* start;
  const Vector3* start_p_L;
  const calibration::Observation* row;
  double sigma_m;

  template <typename T>
  void back_through(std::size_t i, const T* x, T* p) const {
    const calibration::JointModel& joint = start->joints[i];
    move(joint.after, p);
    const T angle = row->readings[i] + joint.offset + x[4];
    const T c = cos(angle);
    const T s = sin(angle);
    const T turned[3] = {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
    const T axis[3] = {x[0], x[1], T(0)};
    ceres::AngleAxisRotatePoint(axis, turned, p);
    p[0] += x[2];
    p[1] += x[3];
  }

  template <typename T>
  bool operator()(const T* x1, const T* x2, const T* x3, const T* x4, const T* x5, const T* x6,
                  const T* base, const T* target, T* residual) const {
    const std::array<const T*, kJoints> joints = {x1, x2, x3, x4, x5, x6};
    T p[3];
    for (int c = 0; c < 3; ++c) p[c] = (*start_p_L)[c] + target[c];
    for (std::size_t i = kJoints; i-- > 0;) back_through(i, joints[i], p);
    const Matrix3& R = start->X_SB.R;
    T turned[3];
    for (int r = 0; r < 3; ++r) turned[r] = R(r, 0) * p[0] + R(r, 1) * p[1] + R(r, 2) * p[2];
    ceres::AngleAxisRotatePoint(base, turned, p);
    for (int c = 0; c < 3; ++c) {
      residual[c] = (p[c] + start->X_SB.p[c] + base[3 + c] - row->p_S[c]) / sigma_m;
    }
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

template <int kCount>
void add_prior(const std::array<double, kCount>& sigma, double* x, ceres::Problem& problem) {
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorOn<kCount>, kCount, kCount>(new PriorOn<kCount>{sigma}),
      nullptr, x);
}

Unknowns fitted_by_ceres(const CalibrationWork& work) {
  Unknowns x;
  const calibration::Scales& scales = work.scales();
  const double sigma_m = std::sqrt(scales.sigma_squared);
  ceres::Problem problem;
  for (const auto& row : work.log()) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<MeasuredRow, 3, 5, 5, 5, 5, 5, 5, 6, 3>(
            new MeasuredRow{&work.start(), &work.start_p_L(), &row, sigma_m}),
        nullptr, x.joint[0].data(), x.joint[1].data(), x.joint[2].data(), x.joint[3].data(),
        x.joint[4].data(), x.joint[5].data(), x.base.data(), x.target.data());
  }
  const double turn = kRotation * std::sqrt(scales.rotation);
  const double shift_m = kShift_m * std::sqrt(scales.shift);
  const double zero = kZero * std::sqrt(scales.zero);
  for (auto& joint : x.joint) {
    add_prior<5>({turn, turn, shift_m, shift_m, zero}, joint.data(), problem);
  }
  add_prior<6>({kBaseTurn, kBaseTurn, kBaseTurn, kFarAway_m, kFarAway_m, kFarAway_m}, x.base.data(),
               problem);
  add_prior<3>({kFarAway_m, kFarAway_m, kFarAway_m}, x.target.data(), problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
  return x;
}

// Largest distance between where both put the target, at poses of its own.
double distance_between(const CalibrationWork& work, const Unknowns& x) {
  test::Random random(7);
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    calibration::Observation at;
    at.readings = random.configuration(test::puma());
    Vector3 p_S;
    MeasuredRow{&work.start(), &work.start_p_L(), &at, 1}(
        x.joint[0].data(), x.joint[1].data(), x.joint[2].data(), x.joint[3].data(),
        x.joint[4].data(), x.joint[5].data(), x.base.data(), x.target.data(), p_S.data());
    calibration::ChainFrames frames;
    calibration::evaluate_chain(work.found(), at.readings, kJoints, frames);
    largest = std::max(largest, (frames.X_SL * work.target().p_L - p_S).norm());
  }
  return largest;
}

struct CalibrationRows {
  CalibrationRows() {
    for (const CalibrationLog& of : kCalibrationLogs) {
      const Row row(
          of.path, "Ceres",
          [of] {
            return [work = std::make_shared<CalibrationWork>(of)](std::size_t calls) {
              work->fit();
              for (std::size_t k = 0; k < calls; ++k) {
                const Unknowns x = fitted_by_ceres(*work);
                if (k == 0 && distance_between(*work, x) > kSame_m) std::abort();
                keep(x);
              }
            };
          },
          1);
    }
  }
};
const CalibrationRows kCalibrationRows;

}  // namespace
}  // namespace armsig::benchmarks
