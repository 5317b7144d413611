// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/pose_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/analysis/uncertainty/tool_covariance.hpp"

namespace armsig::tool {
namespace {

// The gate of the fit (core/calibration/outliers.cpp): in sigma by the median of all lengths.
constexpr double kGateOfOutliers = 6;
constexpr double kMedianOfLengths = 1.538;
constexpr std::size_t kBins = 36;
// Beside the axis of a joint the way of a target has no direction that means anything.
constexpr double kLeastLever_m = 1e-6;

double share_below(std::vector<double> values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

std::size_t target_index(const Signature& signature, int number) {
  const auto found = std::ranges::find(signature.targets, number, &Target::number);
  return static_cast<std::size_t>(found - signature.targets.begin());
}

// 1 sigma per axis of what a row is measured with, and of what the arm does beyond its model.
double scatter_m(const SignatureRecord& record, const MeasuredPose& row) {
  const double stated_m2 = row.covariance_m2.trace() / 3;
  const double sensor_m = stated_m2 > 0 ? std::sqrt(stated_m2) : record.sigma_m.value_or(0);
  return std::hypot(sensor_m, record.unexplained_m);
}

struct JudgedRow {
  const MeasuredPose* row = nullptr;
  PoseResidual residual;
  double sigmas = 0;  // length of the residual by scatter_m()
};

void add_directions(const calibration::PoeChain& chain, const Target& target,
                    PoseResidual& residual) {
  calibration::PointJacobian jacobian;
  const calibration::JointMotion motion = chain.motion(residual.q);
  chain.point_and_jacobian(motion, target, jacobian);
  for (std::size_t i = 0; i < residual.q.size(); ++i) {
    std::optional<double> along;
    if (i < target.link && motion.joints[i].moved != 0) {
      const double lever_m = jacobian.motion[i].norm();
      if (lever_m > kLeastLever_m) along = residual.error_S.dot(jacobian.motion[i]) / lever_m;
    }
    residual.along_m.push_back(along);
  }
}

// 1 sigma of the length of a residual: what the signature leaves open, and the sensor.
double stated_length_m(const SignatureRecord& record, const calibration::Refined& estimate,
                       const MeasuredPose& row, std::size_t target) {
  const double of_signature_m2 = uncertainty::tool_covariance(estimate, row.q, target).trace();
  const double stated_m2 = row.covariance_m2.trace();
  const double sensor_m = record.sigma_m.value_or(0);
  return std::sqrt(of_signature_m2 + (stated_m2 > 0 ? stated_m2 : 3 * sensor_m * sensor_m));
}

// All rows of the signature's targets: which of them are outliers, they decide together.
std::vector<JudgedRow> judged_rows(const SignatureRecord& record, const MeasuredSweeps& measured,
                                   const calibration::Refined* estimate) {
  std::vector<JudgedRow> judged;
  const calibration::PoeChain chain(record.signature, record.readings());
  for (const MeasuredPose& row : measured.rows_located) {
    const std::size_t index = target_index(record.signature, row.target);
    if (index == record.signature.targets.size()) continue;
    const Target& target = record.signature.targets[index];
    JudgedRow one{.row = &row, .residual = {}, .sigmas = 0};
    one.residual.line = row.line;
    one.residual.target = row.target;
    one.residual.q = row.q;
    one.residual.p_S = row.p_S;
    one.residual.error_S = row.p_S - chain.point(chain.motion(row.q), target);
    const double scatter = scatter_m(record, row);
    one.sigmas = one.residual.length_m() / (scatter > 0 ? scatter : 1);
    if (row.sweep == 0) {
      add_directions(chain, target, one.residual);
      if (estimate != nullptr) {
        one.residual.stated_m = stated_length_m(record, *estimate, row, index);
      }
    }
    judged.push_back(std::move(one));
  }
  return judged;
}

// Of rows that were fitted, as many as the fit rejected, the furthest. Of others, those beyond the
// fit's gate.
void mark_outliers(const SignatureRecord& record, bool fitted, std::vector<JudgedRow>& judged) {
  if (judged.empty()) return;
  if (fitted && record.fit) {
    std::vector<JudgedRow*> furthest;
    for (JudgedRow& row : judged) furthest.push_back(&row);
    std::ranges::sort(furthest, std::greater{}, &JudgedRow::sigmas);
    const std::size_t count = std::min(record.fit->rows_rejected, furthest.size());
    for (std::size_t k = 0; k < count; ++k) furthest[k]->residual.outlier = true;
    return;
  }
  std::vector<double> lengths;
  for (const JudgedRow& row : judged) lengths.push_back(row.sigmas);
  const double gate = kGateOfOutliers * share_below(std::move(lengths), 0.5) / kMedianOfLengths;
  for (JudgedRow& row : judged) row.residual.outlier = row.sigmas > gate;
}

ResidualSummary summary_of(const std::vector<PoseResidual>& poses) {
  ResidualSummary summary{.rows = poses.size()};
  for (const PoseResidual& pose : poses) {
    summary.mean_m += pose.length_m();
    summary.rms_m += pose.error_S.squaredNorm();
    summary.largest_m = std::max(summary.largest_m, pose.length_m());
  }
  const auto count = static_cast<double>(poses.size());
  summary.mean_m /= count;
  summary.rms_m = std::sqrt(summary.rms_m / count);
  return summary;
}

std::optional<ResidualSummary> nominal_summary(const SignatureRecord& record,
                                               const std::vector<JudgedRow>& judged) {
  std::vector<calibration::Observation> log;
  std::vector<calibration::RowOutcome> outcomes;
  for (const JudgedRow& one : judged) {
    if (one.row->sweep != 0) continue;
    calibration::Observation row;
    row.target = target_index(record.signature, one.row->target);
    row.readings = one.row->q;
    row.p_S = one.row->p_S;
    log.push_back(row);
    outcomes.push_back({.residual_m = 0, .weight = 1, .rejected = one.residual.outlier});
  }
  return nominal_residuals(record.nominal, log, log, record.signature.targets, {}, outcomes);
}

ResidualHistogram histogram_of(const std::vector<PoseResidual>& poses) {
  std::vector<double> lengths;
  bool stated = true;
  for (const PoseResidual& pose : poses) {
    lengths.push_back(pose.length_m());
    stated = stated && pose.stated_m > 0;
  }
  // Outliers are few: bins for them would leave nothing to see of the others.
  const double edge_m = std::max(1e-9, 1.5 * share_below(lengths, 0.99));
  ResidualHistogram histogram{.bin_m = edge_m / kBins,
                              .counts = std::vector<double>(kBins + 1, 0.0),
                              .expected = std::vector<double>(stated ? kBins + 1 : 0, 0.0)};
  for (const PoseResidual& pose : poses) {
    const double bin = std::min<double>(kBins, std::floor(pose.length_m() / histogram.bin_m));
    ++histogram.counts[static_cast<std::size_t>(bin)];
    if (!stated) continue;
    const double sigma_m = pose.stated_m / std::numbers::sqrt3;
    double below = 0;
    for (std::size_t k = 0; k <= kBins; ++k) {
      const double end_m = static_cast<double>(k + 1) * histogram.bin_m;
      const double up_to = k == kBins ? 1 : length_probability(end_m / sigma_m);
      histogram.expected[k] += up_to - below;
      below = up_to;
    }
  }
  return histogram;
}

}  // namespace

double length_probability(double sigmas) {
  if (sigmas <= 0) return 0;
  return std::erf(sigmas / std::numbers::sqrt2) -
         std::sqrt(2 / kPi) * sigmas * std::exp(-sigmas * sigmas / 2);
}

std::optional<PoseResiduals> pose_residuals(const SignatureRecord& record,
                                            const MeasuredSweeps& measured,
                                            const calibration::Refined* estimate) {
  PoseResiduals all;
  all.fitted = measured.match.is_origin() && record.method == "refined";
  std::vector<JudgedRow> judged = judged_rows(record, measured, estimate);
  mark_outliers(record, all.fitted, judged);
  for (const JudgedRow& one : judged) {
    if (one.row->sweep == 0) all.poses.push_back(one.residual);
  }
  if (all.poses.empty()) return std::nullopt;
  all.signature = summary_of(all.poses);
  all.nominal = nominal_summary(record, judged);
  double squares_m2 = 0;
  for (const PoseResidual& pose : all.poses) {
    all.outliers += pose.outlier;
    squares_m2 += pose.stated_m * pose.stated_m;
  }
  all.stated_rms_m = std::sqrt(squares_m2 / static_cast<double>(all.poses.size()));
  all.histogram = histogram_of(all.poses);
  return all;
}

}  // namespace armsig::tool
