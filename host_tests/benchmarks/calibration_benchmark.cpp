// SPDX-License-Identifier: MIT
// The fit of the geometry over everything measured, as `armsig identify --method refined` does it.
#include <cstdlib>
#include <memory>

#include "firmware/analysis/starts/base_and_tool.hpp"
#include "host_tests/benchmarks/calibration_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

constexpr double kSigma_m = 2e-4;

}  // namespace

// Noise is kept inside the gate, so that least squares has the same answer.
CalibrationWork::CalibrationWork(const CalibrationLog& of) {
  test::Random random(13);
  const test::Cell cell = test::puma_cell(random);
  if (of.points_per_sweep > 0) {
    test::add_sweeps(cell, test::cell_configuration(), kPi, of.points_per_sweep, 0, random, log_);
  }
  test::add_poses(cell, of.mixed_rows, 0, random, log_);
  for (auto& row : log_) {
    Vector3 noise = random.normal_vector(kSigma_m);
    const double most = 3 * kSigma_m;
    if (noise.norm() > most) noise *= most / noise.norm();
    row.p_S += noise;
  }
  const Arm drawing = test::puma();
  Target target;
  target.link = drawing.joints.size();
  const auto fitted = calibration::fit_base_and_tool(drawing, log_, {&target, 1});
  if (!fitted) std::abort();
  *start_ = calibration::model_of(drawing, fitted->X_SB);
  start_p_L_ = fitted->p_LT[0];
  targets_[0].link = target.link;
  const auto types = types_of(drawing.joints);
  rows_.resize(log_.size());
  cache_.resize(log_.size());
  for (std::size_t k = 0; k < log_.size(); ++k) {
    rows_[k].readings = log_[k].readings;
    rows_[k].p_S = log_[k].p_S;
    rows_[k].sweep = static_cast<std::uint8_t>(log_[k].sweep);
    rows_[k].index = static_cast<std::uint32_t>(k);
  }
  calibration::group_poses(rows_, types);
  matrix_.resize(calibration::matrix_size(calibration::Engine::columns(*start_, 1)));
}

void CalibrationWork::fit() {
  *model_ = *start_;
  targets_[0].p_L = start_p_L_;
  calibration::Engine engine(*model_, targets_, rows_, cache_, matrix_, *work_);
  if (!engine.run({.gravity = false, .maps = false})) std::abort();
  scales_ = engine.scales();
}

namespace {

struct CalibrationRows {
  CalibrationRows() {
    for (const CalibrationLog& of : kCalibrationLogs) {
      const Row row(
          of.path, "armsig",
          [of] {
            return [work = std::make_shared<CalibrationWork>(of)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) {
                work->fit();
                keep(work->found());
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
