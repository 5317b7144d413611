// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Dense>

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestForNoise = 8;
constexpr double kTrimmedShare = 0.7;
constexpr double kMedianLengthOf3 = 1.538;  // of three unit normal errors
constexpr double kBlunder = 3.8;            // medians
constexpr double kHuber = 2.5;              // in sigmas per axis

// What is left of positions about a + b f + c g, per axis, by the median of the lengths.
double left_about(const std::vector<const EvidenceRow*>& rows, const Eigen::MatrixX3d& regressors) {
  Eigen::MatrixX3d positions(regressors.rows(), 3);
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    positions.row(k) = rows[static_cast<std::size_t>(k)]->p_S.transpose();
  }
  const Eigen::MatrixX3d left =
      positions - regressors * regressors.colPivHouseholderQr().solve(positions);
  std::vector<double> lengths;
  for (Eigen::Index k = 0; k < left.rows(); ++k) lengths.push_back(left.row(k).norm());
  return sigma_by_median(std::move(lengths));
}

double left_by_reading(const std::vector<const EvidenceRow*>& rows, JointType type,
                       std::size_t joint) {
  Eigen::MatrixX3d regressors(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double q = rows[k]->q[joint];
    const auto row = static_cast<Eigen::Index>(k);
    regressors(row, 0) = 1;
    regressors(row, 1) = type == JointType::kRevolute ? std::cos(q) : q;
    regressors(row, 2) = type == JointType::kRevolute ? std::sin(q) : 0;
  }
  return left_about(rows, regressors);
}

// Third differences of an even motion are noise alone, of variance 20.
double left_by_order(const std::vector<const EvidenceRow*>& rows) {
  std::vector<double> lengths;
  for (std::size_t k = 3; k < rows.size(); ++k) {
    const Vector3 third =
        rows[k]->p_S - 3 * rows[k - 1]->p_S + 3 * rows[k - 2]->p_S - rows[k - 3]->p_S;
    lengths.push_back(third.norm() / std::sqrt(20.0));
  }
  return sigma_by_median(std::move(lengths));
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
    if (row.sigma_m > 0) stated.push_back(row.sigma_m);
  }
  return stated.size() * 2 < evidence.rows.size() || stated.empty() ? 0
                                                                    : median_of(std::move(stated));
}

double noise_of_sweeps_m(const Evidence& evidence) {
  std::map<std::pair<std::size_t, int>, std::vector<const EvidenceRow*>> paths;
  for (const EvidenceRow& row : evidence.rows) {
    if (row.sweep != 0) paths[{row.sweep, row.target}].push_back(&row);
  }
  std::vector<double> noises;
  for (const auto& [path, rows] : paths) {
    if (rows.size() < kFewestForNoise) continue;
    const std::size_t joint = path.first - 1;
    noises.push_back(std::min(left_by_reading(rows, evidence.arm.joints[joint].type, joint),
                              left_by_order(rows)));
  }
  return noises.empty() ? 0 : median_of(std::move(noises));
}

}  // namespace armsig::tool
