// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/grid_task.hpp"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "firmware/library/estimate.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kDrawnArms = 15;

double median(const std::vector<evaluation::Indices>& all, double evaluation::Indices::* index) {
  std::vector<double> values;
  values.reserve(all.size());
  for (const evaluation::Indices& indices : all) values.push_back(indices.*index);
  std::ranges::sort(values);
  return values[values.size() / 2];
}

evaluation::Indices median(const std::vector<evaluation::Indices>& all) {
  using evaluation::Indices;
  return {.normal_deviation_m = median(all, &Indices::normal_deviation_m),
          .perpendicular_deviation_rad = median(all, &Indices::perpendicular_deviation_rad),
          .radial_deviation_m = median(all, &Indices::radial_deviation_m),
          .orientation_deviation_rad = median(all, &Indices::orientation_deviation_rad)};
}

}  // namespace

std::optional<GridTask> grid_task(const SignatureRecord& record,
                                  const calibration::Refined* estimate,
                                  const std::optional<SignatureRecord>& truth) {
  const calibration::ReadingModel readings = record.readings();
  const evaluation::Turning turning{&readings, record.signature.configuration};
  if (truth) {
    const calibration::ReadingModel true_readings = truth->readings();
    const auto comparison =
        evaluation::compare(record.nominal, record.signature, truth->signature, {}, turning,
                            {&true_readings, truth->signature.configuration});
    if (!comparison) return std::nullopt;
    return GridTask{.comparison = *comparison};
  }
  if (estimate == nullptr) return std::nullopt;
  const Eigen::MatrixXd half = Eigen::LLT<Eigen::MatrixXd>(covariance_of(*estimate)).matrixL();
  simulated::Random random(1);
  std::vector<evaluation::Indices> ideal;
  std::vector<evaluation::Indices> with_signature;
  GridTask task;
  for (std::size_t k = 0; k < kDrawnArms; ++k) {
    const Eigen::VectorXd step =
        half * Eigen::VectorXd::NullaryExpr(half.rows(), [&] { return random.normal(); });
    const auto comparison =
        evaluation::compare(record.nominal, record.signature,
                            moved(*estimate, record.nominal, step), {}, turning, turning);
    if (!comparison) continue;
    ideal.push_back(comparison->ideal);
    with_signature.push_back(comparison->with_signature);
    task.comparison.grid = comparison->grid;
  }
  if (ideal.empty()) return std::nullopt;
  task.comparison.ideal = median(ideal);
  task.comparison.with_signature = median(with_signature);
  task.drawn_arms = ideal.size();
  return task;
}

}  // namespace armsig::tool
