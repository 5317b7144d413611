// SPDX-License-Identifier: MIT
#include "firmware/host_tool/sweeps_alone/unseen_bending.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "core/base/low_discrepancy.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/diagnosis/triangle.hpp"
#include "firmware/host_tool/sweeps_alone/whole_model.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kMostRows = 300;
constexpr std::size_t kFewestRows = 12;
constexpr double kBlunderGate = 6;  // of the rows' own robust scale
constexpr int kScaleRounds = 25;
// Variance of the geometry about the estimate, over that about a drawing: says next to nothing.
constexpr double kGeometryVariance = 25;
constexpr double kQuickShare = 0.7;  // see engine_scales.cpp
constexpr double kLeastBlockScale = 1e-6;
// A block's variance may be anything over eight decades: natural logarithm of that.
constexpr double kScaleRange = 18.4;
// What gears and gravity that are not there have as evidence is less.
constexpr double kSpeaks = 1;

// tr(P C^T C), P symmetric: of the product one half is enough.
double trace_of(const Eigen::MatrixXd& P, const Eigen::Ref<const Eigen::MatrixXd>& C) {
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(P.rows(), P.cols());
  products.selfadjointView<Eigen::Lower>().rankUpdate(C.transpose());
  products.diagonal() /= 2;
  return 2 * P.cwiseProduct(products).sum();
}

// The rows: y = A x + e, every number of one variance.
struct LinearRows {
  Eigen::MatrixXd A;
  Eigen::VectorXd y;
};

struct Posterior {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  std::vector<double> scale;       // of every block
  std::vector<double> determined;  // columns of every block that the rows determine
  double variance = 0;             // of a row's number
  double log_evidence = 0;         // at these scales

  // With the scales integrated out, by Laplace's approximation: the more a block has to say, the
  // less of the range of its scale would do (MacKay, Bayesian interpolation, 1992). Without it
  // scales found from the rows would make noise look like maps.
  [[nodiscard]] double log_evidence_of_any_scale() const {
    double sum = log_evidence;
    for (const double own : determined) {
      if (own > 0) sum += std::min(0.0, std::log(4 * kPi / own) / 2 - std::log(kScaleRange));
    }
    return sum;
  }
};

// The columns of the first blocks, sigma and scales by the fixed points of the engine
// (MacKay, 1992; Dempster, Laird and Rubin, 1977), with the whole covariance.
class Fit {
 public:
  Fit(const WholeModel& model, const LinearRows& rows) : model_(model), rows_(rows) {}

  // Geometry, and so many blocks of the model.
  [[nodiscard]] Posterior operator()(std::size_t blocks) {
    const Eigen::Index size = model_.columns_before(blocks);
    const Eigen::MatrixXd A = rows_.A.leftCols(size);
    const Eigen::MatrixXd squares = A.transpose() * A;
    const Eigen::VectorXd gradient = A.transpose() * rows_.y;
    Posterior found;
    found.scale.assign(blocks, 1.0);
    found.determined.assign(blocks, 0.0);
    found.variance = rows_.y.squaredNorm() / static_cast<double>(rows_.y.size());
    for (int round = 0; round < kScaleRounds; ++round) {
      const Eigen::LLT<Eigen::MatrixXd> factor(information(squares, found));
      // C = root^T root; of a round only its blocks are needed.
      const Eigen::MatrixXd root = inverse_of_lower(factor.matrixLLT());
      found.x = factor.solve(gradient / found.variance);
      const double errors = (rows_.y - A * found.x).squaredNorm();
      found.log_evidence = log_evidence(found, errors, factor);
      if (round + 1 < kScaleRounds) {
        update(found, root, errors);
      } else {
        found.covariance = square_of_lower(root);
      }
    }
    return found;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd information(const Eigen::MatrixXd& squares,
                                            const Posterior& found) const {
    Eigen::MatrixXd H = squares / found.variance;
    H.diagonal().head(model_.geometry_columns()).array() += 1 / kGeometryVariance;
    for (std::size_t b = 0; b < found.scale.size(); ++b) {
      const PriorBlock& block = model_.blocks()[b];
      H.block(block.first, block.first, block.size(), block.size()) +=
          block.precision / found.scale[b];
    }
    return H;
  }

  void update(Posterior& found, const Eigen::MatrixXd& root, double errors) const {
    const Eigen::Index geometry = model_.geometry_columns();
    double determined =
        static_cast<double>(geometry) - root.leftCols(geometry).squaredNorm() / kGeometryVariance;
    for (std::size_t b = 0; b < found.scale.size(); ++b) {
      const PriorBlock& block = model_.blocks()[b];
      if (block.size() == 0) continue;
      const auto size = static_cast<double>(block.size());
      const auto x = found.x.segment(block.first, block.size());
      const double squares = x.dot(block.precision * x);
      const double trace = trace_of(  // of a lower triangular matrix
          block.precision,
          root.block(block.first, block.first, root.rows() - block.first, block.size()));
      const double own = std::clamp(size - trace / found.scale[b], 1e-3, size);
      found.determined[b] = own;
      determined += own;
      const double quick = std::max(squares, 1e-12) / (own + block.zeros);
      const double sure = (squares + trace) / (size + block.zeros);
      found.scale[b] = std::max(kLeastBlockScale, std::exp(kQuickShare * std::log(quick) +
                                                           (1 - kQuickShare) * std::log(sure)));
    }
    const auto numbers = static_cast<double>(rows_.y.size());
    found.variance = std::max(1e-14, errors / std::max(numbers - determined, 0.05 * numbers));
  }

  [[nodiscard]] double log_evidence(const Posterior& found, double errors,
                                    const Eigen::LLT<Eigen::MatrixXd>& factor) const {
    const Eigen::Index geometry = model_.geometry_columns();
    const auto d = found.x.head(geometry);
    double cost = errors / found.variance + d.squaredNorm() / kGeometryVariance;
    double log_determinants = static_cast<double>(rows_.y.size()) * std::log(found.variance) +
                              static_cast<double>(geometry) * std::log(kGeometryVariance);
    for (std::size_t b = 0; b < found.scale.size(); ++b) {
      const PriorBlock& block = model_.blocks()[b];
      const auto x = found.x.segment(block.first, block.size());
      cost += x.dot(block.precision * x) / found.scale[b];
      log_determinants +=
          static_cast<double>(block.size()) * std::log(found.scale[b]) - block.log_determinant;
    }
    for (Eigen::Index k = 0; k < found.x.size(); ++k) {
      log_determinants += 2 * std::log(factor.matrixLLT()(k, k));
    }
    return -(cost + log_determinants) / 2;
  }

  const WholeModel& model_;
  const LinearRows& rows_;
};

// The target of a row by its index, or nothing.
std::optional<std::size_t> index_of(const Signature& signature, int number) {
  const auto* target = std::ranges::find(signature.targets, number, &Target::number);
  if (target == signature.targets.end()) return std::nullopt;
  return static_cast<std::size_t>(target - signature.targets.begin());
}

// Rows of known targets that are no blunders.
std::vector<EvidenceRow> sound_rows(const Evidence& evidence,
                                    const calibration::Refined& estimate) {
  std::vector<EvidenceRow> rows;
  std::vector<double> lengths;
  for (const EvidenceRow& row : thinned(evidence, kMostRows).rows) {
    const auto target = index_of(estimate.signature, row.target);
    if (!target) continue;
    rows.push_back(row);
    lengths.push_back((row.p_S - uncertainty::tool_position(estimate, row.q, *target)).norm());
  }
  if (rows.size() < kFewestRows) return {};
  const double gate = kBlunderGate * sigma_by_median(lengths);
  std::vector<EvidenceRow> sound;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (lengths[k] <= gate) sound.push_back(rows[k]);
  }
  return sound;
}

// What makes the numbers of every row independent, of a variance that is one for all on average:
// the positions that ranges give are better along one direction than along another, and not as good
// everywhere. A row that states nothing counts as the average.
std::vector<Matrix3> whitening(std::span<const EvidenceRow> rows) {
  double sum = 0;
  double count = 0;
  for (const EvidenceRow& row : rows) {
    const double sigma_m = row.sigma_m();
    sum += sigma_m * sigma_m;
    count += sigma_m > 0 ? 1 : 0;
  }
  std::vector<Matrix3> whitening(rows.size(), Matrix3::Identity());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!(rows[k].sigma_m() > 0)) continue;
    const Matrix3 relative = rows[k].covariance_m2 * (count / sum);
    whitening[k] = relative.llt().matrixL().solve(Matrix3::Identity());
  }
  return whitening;
}

LinearRows linearised(const WholeModel& model, const calibration::Refined& estimate,
                      std::span<const EvidenceRow> from) {
  const auto numbers = 3 * static_cast<Eigen::Index>(from.size());
  LinearRows rows{.A = Eigen::MatrixXd(numbers, model.columns()), .y = Eigen::VectorXd(numbers)};
  const std::vector<Matrix3> whiten = whitening(from);
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto first = 3 * static_cast<Eigen::Index>(k);
    const WholeModel::At at = model.at(from[k].q, *index_of(estimate.signature, from[k].target));
    rows.A.middleRows<3>(first) = whiten[k] * at.columns;
    rows.y.segment<3>(first) = whiten[k] * (from[k].p_S - at.p_S + at.bent);
  }
  return rows;
}

// Mean square at the tool of what the estimate misses, by that posterior.
double expected_square(const WholeModel& model, const Posterior& posterior,
                       const calibration::Refined& estimate,
                       const FixedVector<JointLimits, kMaxJoints>& limits, std::size_t tool) {
  double sum = 0;
  for (int k = 1; k <= kJudgedConfigurations; ++k) {
    const JointVector q = work_configuration(estimate.signature.types, limits, k);
    const WholeModel::At at = model.at(q, tool);
    const Eigen::MatrixXd columns = at.columns.leftCols(posterior.x.size());
    sum += (columns * posterior.x - at.bent).squaredNorm() +
           (columns * posterior.covariance).cwiseProduct(columns).sum();
    for (std::size_t b = WholeModel::kMaps; b < posterior.scale.size(); ++b) {
      sum += posterior.scale[b] * at.open[b - WholeModel::kMaps];
    }
  }
  return sum / kJudgedConfigurations;
}

}  // namespace

std::optional<UnseenBending> judge_bending(const Evidence& evidence,
                                           const calibration::Refined& estimate,
                                           const FixedVector<JointLimits, kMaxJoints>& limits,
                                           std::size_t tool, bool tried) {
  const bool estimate_bends = estimate.readings.deflections != nullptr;
  const bool sweeps_alone =
      std::ranges::none_of(evidence.rows, [](const EvidenceRow& row) { return row.sweep == 0; });
  if (!sweeps_alone) return std::nullopt;
  const std::vector<EvidenceRow> from = sound_rows(evidence, estimate);
  if (from.empty()) return std::nullopt;
  const WholeModel model(evidence.arm, estimate, from, tool);
  const LinearRows rows = linearised(model, estimate, from);
  Fit fit(model, rows);
  const Posterior straight = fit(WholeModel::kGears);
  if (!estimate_bends && tried &&
      fit(WholeModel::kMaps).log_evidence < straight.log_evidence + kSpeaks) {
    return std::nullopt;
  }
  const Posterior bent = fit(model.blocks().size());
  UnseenBending found;
  found.stated_m = uncertainty::predicted_rms(estimate, limits, tool, kJudgedConfigurations);
  found.probability =
      1 / (1 + std::exp(straight.log_evidence_of_any_scale() - bent.log_evidence_of_any_scale()));
  const auto square_of = [&](const Posterior& posterior) {
    return expected_square(model, posterior, estimate, limits, tool);
  };
  // An estimate that bends is judged by itself, one that does not by what bending adds.
  const double without = estimate_bends ? found.stated_m * found.stated_m : square_of(straight);
  const double more = std::max(0.0, square_of(bent) - without);
  found.expected_m = std::sqrt(found.stated_m * found.stated_m + found.probability * more);
  // What is unexplained in every pose is no part of the covariance.
  const double axes = found.stated_m * found.stated_m -
                      3 * estimate.quality.unexplained_m * estimate.quality.unexplained_m;
  if (axes > 0) found.factor = std::sqrt(1 + found.probability * more / axes);
  return found;
}

}  // namespace armsig::tool
