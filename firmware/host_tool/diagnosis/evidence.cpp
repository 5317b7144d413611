// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Dense>

#include "core/calibration/standing_still.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestForNoise = 8;
constexpr double kTrimmedShare = 0.7;
constexpr double kMedianLengthOf3 = 1.538;  // of three unit normal errors
constexpr double kBlunder = 3.8;            // medians
constexpr double kHuber = 2.5;              // in sigmas per axis
constexpr double kCoordinates = 3;

// In which errors of rows are measured: metres, or the covariance that each row states. (A position
// from three ranges errs along one direction by far the most. The median of such lengths is not
// that of errors as large along all directions.)
enum class ErrorUnit : std::uint8_t { kMetre, kStated };

Matrix3 unit_of_error(const EvidenceRow& row, ErrorUnit unit) {
  return unit == ErrorUnit::kMetre ? Matrix3::Identity() : row.covariance_m2;
}

double length_in(const Matrix3& unit, const Vector3& error) {
  return unit.llt().matrixL().solve(error).norm();
}

// What is left of positions about a + b f + c g, per axis, by the median of the lengths.
double left_about(const std::vector<const EvidenceRow*>& rows, const Eigen::MatrixX3d& regressors,
                  ErrorUnit unit) {
  Eigen::MatrixX3d positions(regressors.rows(), 3);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    positions.row(k) = rows[static_cast<std::size_t>(k)]->p_S.transpose();
  }
  const Eigen::MatrixX3d left =
      positions - regressors * regressors.colPivHouseholderQr().solve(positions);
  std::vector<double> lengths;
  for (Eigen::Index k = 0; k < left.rows(); ++k) {
    lengths.push_back(length_in(unit_of_error(*rows[static_cast<std::size_t>(k)], unit),
                                left.row(k).transpose()));
  }
  return sigma_by_median(std::move(lengths));
}

double left_by_reading(const std::vector<const EvidenceRow*>& rows, JointType type,
                       std::size_t joint, ErrorUnit unit) {
  Eigen::MatrixX3d regressors(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double q = rows[k]->q[joint];
    const auto row = static_cast<Eigen::Index>(k);
    regressors(row, 0) = 1;
    regressors(row, 1) = type == JointType::kRevolute ? std::cos(q) : q;
    regressors(row, 2) = type == JointType::kRevolute ? std::sin(q) : 0;
  }
  return left_about(rows, regressors, unit);
}

// Third differences of an even motion are noise alone: of four rows, 1, 9, 9 and 1 times their
// variances.
double left_by_order(const std::vector<const EvidenceRow*>& rows, ErrorUnit unit) {
  std::vector<double> lengths;
  for (std::size_t k = 3; k < rows.size(); ++k) {
    const Vector3 third =
        rows[k]->p_S - 3 * rows[k - 1]->p_S + 3 * rows[k - 2]->p_S - rows[k - 3]->p_S;
    const auto of = [&](std::size_t back) { return unit_of_error(*rows[k - back], unit); };
    lengths.push_back(length_in(of(0) + 9 * of(1) + 9 * of(2) + of(3), third));
  }
  return sigma_by_median(std::move(lengths));
}

// The noise of the rows of sweeps, per axis and in that unit; 0 without a sweep of eight rows.
double noise_of_sweeps(const Evidence& evidence, ErrorUnit unit) {
  std::map<std::pair<std::size_t, int>, std::vector<const EvidenceRow*>> paths;
  for (const EvidenceRow& row : evidence.rows) {
    if (row.sweep != 0) paths[{row.sweep, row.target}].push_back(&row);
  }
  std::vector<double> noises;
  for (const auto& [path, rows] : paths) {
    if (rows.size() < kFewestForNoise) continue;
    const std::size_t joint = path.first - 1;
    noises.push_back(std::min(left_by_reading(rows, evidence.arm.joints[joint].type, joint, unit),
                              left_by_order(rows, unit)));
  }
  return noises.empty() ? 0 : median_of(std::move(noises));
}

}  // namespace

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double sigma_by_median(std::vector<double> lengths) {
  return median_of(std::move(lengths)) / kMedianLengthOf3;
}

double rms_length(const std::vector<Vector3>& vectors) {
  double squares = 0;
  for (const Vector3& v : vectors) squares += v.squaredNorm();
  return std::sqrt(squares / static_cast<double>(vectors.size()));
}

double blunder_gate_m(std::vector<double> lengths_m) {
  return kBlunder * median_of(std::move(lengths_m));
}

double huber_weight(double length_m, double sigma_m) {
  const double in_sigma = length_m / (sigma_m * std::numbers::sqrt3);
  return std::min(1.0, kHuber / in_sigma) / (sigma_m * sigma_m);
}

double trimmed_rms(std::vector<double> lengths) {
  std::ranges::sort(lengths);
  const auto best =
      static_cast<std::size_t>(std::ceil(kTrimmedShare * static_cast<double>(lengths.size())));
  double squares = 0;
  for (std::size_t k = 0; k < best; ++k) squares += lengths[k] * lengths[k];
  return std::sqrt(squares / static_cast<double>(best));
}

double EvidenceRow::sigma_m() const { return std::sqrt(covariance_m2.trace() / kCoordinates); }

std::vector<SeenTarget> seen_targets(const Evidence& evidence) {
  std::map<int, std::size_t> links;
  for (const EvidenceRow& row : evidence.rows) {
    std::size_t& link = links[row.target];
    link = std::max(link, row.sweep == 0 ? evidence.arm.joints.size() : row.sweep);
  }
  std::vector<SeenTarget> targets;
  for (const auto& [number, link] : links) targets.push_back({number, link});
  return targets;
}

bool has_moved(const Evidence& evidence, std::size_t joint) {
  return !calibration::stood_still(
      evidence.rows, [](const EvidenceRow& row) { return row.q; }, joint,
      evidence.arm.joints[joint].type);
}

Evidence thinned(const Evidence& evidence, std::size_t most) {
  if (evidence.rows.size() <= most) return evidence;
  Evidence few = evidence;
  few.rows.clear();
  const double share = static_cast<double>(most) / static_cast<double>(evidence.rows.size());
  // By a sequence of low discrepancy, so that no period of the rows (one target of three, one
  // sweep of six) is met by it.
  double phase = 0;
  for (const EvidenceRow& row : evidence.rows) {
    phase = std::fmod(phase + kGoldenShare, 1.0);
    if (phase < share) few.rows.push_back(row);
  }
  return few;
}

double stated_sigma_m(const Evidence& evidence) {
  std::vector<double> stated;
  for (const EvidenceRow& row : evidence.rows) {
    if (const double sigma_m = row.sigma_m(); sigma_m > 0) stated.push_back(sigma_m);
  }
  return stated.size() * 2 < evidence.rows.size() || stated.empty() ? 0
                                                                    : median_of(std::move(stated));
}

double noise_of_sweeps_m(const Evidence& evidence) {
  return noise_of_sweeps(evidence, ErrorUnit::kMetre);
}

RowNoise::RowNoise(const Evidence& evidence) {
  Evidence swept{.arm = evidence.arm, .rows = {}};
  bool stated = true;
  for (const EvidenceRow& row : evidence.rows) {
    if (row.sweep == 0) continue;
    swept.rows.push_back(row);
    stated = stated && row.sigma_m() > 0;
  }
  const double stated_m = stated ? stated_sigma_m(swept) : 0;
  if (stated_m > 0) over_stated_ = noise_of_sweeps(swept, ErrorUnit::kStated);
  of_sweeps_m_ = stated_m > 0 ? stated_m * over_stated_ : noise_of_sweeps(swept, ErrorUnit::kMetre);
}

double RowNoise::mean_square(const EvidenceRow& row) const {
  const double stated_m = row.sigma_m();
  const double sigma_m = stated_m > 0 && over_stated_ > 0 ? stated_m * over_stated_ : of_sweeps_m_;
  return kCoordinates * sigma_m * sigma_m;
}

}  // namespace armsig::tool
