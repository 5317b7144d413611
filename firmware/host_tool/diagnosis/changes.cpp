// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/changes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "core/base/low_discrepancy.hpp"
#include "firmware/host_tool/diagnosis/gravity_columns.hpp"

namespace armsig::tool {

Matrix3 strain_of(const Strains& e) {
  Matrix3 strain;
  strain << e[0], e[2], e[3], e[2], e[1], e[4], e[3], e[4], -e[0] - e[1];
  return strain;
}

namespace {

constexpr std::size_t kFewestRows = 24;
constexpr std::size_t kFewestOfPart = 4;  // rows before and after
constexpr double kFarthest = 30;
constexpr int kJudged = 200;         // configurations, as uncertainty::predicted_rms()
constexpr double kUsualSize = 0.03;  // of a change, 1 sigma: metres, radians, a share

struct Candidate {
  Change::Of of;
  std::size_t index;
  DeviatingChain::Columns columns;
};

std::vector<Candidate> candidates_of(const Evidence& evidence, const DeviatingChain& chain) {
  std::vector<Candidate> all{{Change::Of::kSensor, 0, chain.of_base()},
                             {Change::Of::kLengths, 0, chain.of_lengths()}};
  for (std::size_t j = 0; j < evidence.arm.joints.size(); ++j) {
    all.push_back({Change::Of::kZero, j, chain.of_zero(j)});
    if (j + 1 < evidence.arm.joints.size()) {
      all.push_back({Change::Of::kLink, j, chain.of_link(j)});
    }
  }
  for (std::size_t t = 0; t < chain.targets().size(); ++t) {
    all.push_back({Change::Of::kTarget, static_cast<std::size_t>(chain.targets()[t].number),
                   chain.of_target(t)});
  }
  return all;
}

Eigen::Matrix<double, 3, kStrains> moved_by_strains(const Vector3& p) {
  Eigen::Matrix<double, 3, kStrains> moved;
  for (Eigen::Index i = 0; i < kStrains; ++i) moved.col(i) = strain_of(Strains::Unit(i)) * p;
  return moved;
}

// The inverse of a matrix of normal equations; what the rows do not tell is left as it is. Beyond
// this part of what `scale` has on its diagonal only rounding is left.
constexpr double kTold = 1e-9;

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal, const Eigen::VectorXd& scale) {
  if (normal.size() == 0) return normal;  // an arm on which gravity has no lever
  const Eigen::VectorXd unit =
      scale.unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> in(unit.asDiagonal() * normal *
                                                          unit.asDiagonal());
  const Eigen::VectorXd inverse =
      in.eigenvalues().unaryExpr([](double x) { return x > kTold ? 1 / x : 0.0; });
  return unit.asDiagonal() * in.eigenvectors() * inverse.asDiagonal() *
         in.eigenvectors().transpose() * unit.asDiagonal();
}

// Sums over the rows, each weighed by its share of the change.
struct Sums {
  explicit Sums(Eigen::Index size)
      : once(Eigen::MatrixXd::Zero(size, size)),
        twice(Eigen::MatrixXd::Zero(size, size)),
        score(Eigen::VectorXd::Zero(size)) {}

  void add(const Eigen::Matrix3Xd& J, const Vector3& residual, double weight, double share) {
    once.noalias() += weight * share * (J.transpose() * J);
    twice.noalias() += weight * share * share * (J.transpose() * J);
    score.noalias() += weight * share * (J.transpose() * residual);
  }

  Eigen::MatrixXd once;
  Eigen::MatrixXd twice;
  Eigen::VectorXd score;
};

class ScoreTest {
 public:
  ScoreTest(const Evidence& evidence, const DeviatingChain& chain,
            const std::vector<Vector3>& residuals_S)
      : evidence_(evidence), chain_(chain), residuals_(residuals_S), size_(chain.all().count) {
    weigh();
    const auto normal = chain.normal(evidence, residuals_S, weights_);
    inverse_ = inverse_of(normal.H, normal.H.diagonal());
    Eigen::Matrix3Xd J(3, size_);
    Sums whole(size_);
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      chain.derivatives(evidence.rows[k], J);
      derivatives_.push_back(J);
      whole.add(J, residuals_S[k], weights_[k], 1);
      squares_ += weights_[k] * residuals_S[k].squaredNorm();
    }
    // The lengths are no unknown of an unchanging arm.
    inverse_.row(chain.of_lengths().first).setZero();
    inverse_.col(chain.of_lengths().first).setZero();
    step_ = inverse_ * whole.score;
    squares_ -= whole.score.dot(step_);
  }

  void consider(const std::vector<Candidate>& candidates, const Sums& sums, bool slow,
                std::size_t from) {
    for (const Candidate& candidate : candidates) {
      const auto [first, count] = candidate.columns;
      const Eigen::MatrixXd across = sums.once.middleCols(first, count);
      Scored scored{.across = across,
                    .usual = sums.twice.block(first, first, count, count),
                    .left = sums.twice.block(first, first, count, count) -
                            across.transpose() * inverse_ * across,
                    .score = sums.score.segment(first, count) - across.transpose() * step_,
                    .squares = squares_};
      score_of(scored, candidates.size());
      if (best_ && scored.evidence <= best_->evidence) continue;
      const double shift_m = moved_by(candidate, scored.size, from);
      if (!is_told(shift_m)) continue;
      best_ = change_of(scored);
      best_->of = candidate.of;
      best_->index = candidate.index;
      best_->slow = slow;
      best_->first_line = evidence_.rows[from].line;
      best_->shift_m = shift_m;
      best_->after_it.segment(first, count) -= scored.size;
    }
  }

  // A strain is no unknown of the arm: rows know it by where they are. What gravity bends looks
  // like one, and is taken out first.
  [[nodiscard]] Change strain() const {
    const GravityColumns gravity(evidence_.arm);
    Vector3 middle = Vector3::Zero();
    for (const EvidenceRow& row : evidence_.rows) middle += row.p_S;
    middle /= static_cast<double>(evidence_.rows.size());
    const Eigen::Index bent = gravity.count();
    const Eigen::Index count = bent + kStrains;
    Eigen::MatrixXd across = Eigen::MatrixXd::Zero(size_, count);
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(count);
    Eigen::Matrix3Xd E(3, count);
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      E.leftCols(bent) = gravity.of(evidence_.rows[k], chain_, derivatives_[k]);
      E.rightCols<kStrains>() = moved_by_strains(evidence_.rows[k].p_S - middle);
      across.noalias() += weights_[k] * (derivatives_[k].transpose() * E);
      own.noalias() += weights_[k] * (E.transpose() * E);
      score.noalias() += weights_[k] * (E.transpose() * residuals_[k]);
    }
    const Eigen::MatrixXd left = own - across.transpose() * inverse_ * across;
    score -= across.transpose() * step_;
    const Eigen::MatrixXd by_gravity =
        inverse_of(left.topLeftCorner(bent, bent), own.diagonal().head(bent));
    // What gravity makes of the residuals, and of each strain.
    const Eigen::VectorXd sag = by_gravity * score.head(bent);
    const Eigen::MatrixXd sags = by_gravity * left.topRightCorner(bent, kStrains);
    Scored scored{.across = across.rightCols<kStrains>() - across.leftCols(bent) * sags,
                  .usual = own.bottomRightCorner<kStrains, kStrains>(),
                  .left = left.bottomRightCorner<kStrains, kStrains>() -
                          left.bottomLeftCorner(kStrains, bent) * sags,
                  .score = score.tail<kStrains>() - left.bottomLeftCorner(kStrains, bent) * sag,
                  .squares = squares_ - score.head(bent).dot(sag)};
    score_of(scored, 1);
    double squares = 0;
    for (const EvidenceRow& row : evidence_.rows) {
      squares += (strain_of(scored.size) * (row.p_S - middle)).squaredNorm();
    }
    Change found = change_of(scored);
    found.of = Change::Of::kStrain;
    found.first_line = evidence_.rows.front().line;
    found.shift_m = std::sqrt(squares / static_cast<double>(evidence_.rows.size()));
    return found;
  }

  std::optional<Change> run(const std::vector<Candidate>& candidates) {
    Sums sums(size_);
    const std::size_t rows = weights_.size();
    for (std::size_t k = rows; k-- > kFewestOfPart;) {
      sums.add(derivatives_[k], residuals_[k], weights_[k], 1);
      if (k + kFewestOfPart <= rows) consider(candidates, sums, false, k);
    }
    Sums growing(size_);
    for (std::size_t k = 0; k < rows; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(rows - 1);
      growing.add(derivatives_[k], residuals_[k], weights_[k], share);
    }
    consider(candidates, growing, true, 0);
    return best_;
  }

 private:
  // A candidate: what the rows say of it, and what that makes of it.
  struct Scored {
    Eigen::MatrixXd across;  // with the unknowns of an unchanging arm
    Eigen::MatrixXd usual;   // of its own
    Eigen::MatrixXd left;    // of that, what an unchanging arm can not do
    Eigen::VectorXd score;   // and of the residuals
    double squares = 0;      // left of them without it
    Eigen::VectorXd size = {};
    double gain = 0;
    double evidence = 0;
  };

  void score_of(Scored& scored, std::size_t candidates) const {
    constexpr double kWeight = 1 / (kUsualSize * kUsualSize);
    scored.usual.diagonal().array() += kWeight;
    scored.left.diagonal().array() += kWeight;
    scored.size = inverse_of(scored.left, scored.usual.diagonal()) * scored.score;
    scored.gain = std::clamp(scored.score.dot(scored.size), 0.0, (1 - 1e-12) * scored.squares);
    const double freedom = 3 * static_cast<double>(weights_.size()) - static_cast<double>(size_);
    const double tried = static_cast<double>(candidates * weights_.size());
    scored.evidence = -0.5 * freedom * std::log1p(-scored.gain / scored.squares) -
                      0.5 * static_cast<double>(scored.size.size()) * std::log(freedom) -
                      std::log(tried);
  }

  // What moves the rows by far more than they miss is hardly told from the arm itself.
  [[nodiscard]] bool is_told(double shift_m) const {
    return shift_m <= kFarthest * std::sqrt(squares_ / weight_);
  }

  [[nodiscard]] Change change_of(const Scored& scored) const {
    Change change;
    change.last_line = evidence_.rows.back().line;
    change.size = scored.size;
    change.before_m = std::sqrt(scored.squares / weight_);
    change.after_m = std::sqrt((scored.squares - scored.gain) / weight_);
    change.evidence = scored.evidence;
    change.before_it = inverse_ * (scored.across * scored.size);
    change.after_it = change.before_it;
    return change;
  }

  void weigh() {
    std::vector<double> lengths;
    for (const Vector3& residual : residuals_) lengths.push_back(residual.norm());
    const double sigma_m = std::max(kLeastSigma_m, sigma_by_median(lengths));
    for (const double length : lengths) {
      weights_.push_back(huber_weight(length, sigma_m));
      weight_ += weights_.back();
    }
  }

  [[nodiscard]] double moved_by(const Candidate& candidate, const Eigen::VectorXd& size,
                                std::size_t from) const {
    double squares = 0;
    for (std::size_t k = from; k < derivatives_.size(); ++k) {
      squares +=
          (derivatives_[k].middleCols(candidate.columns.first, candidate.columns.count) * size)
              .squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(derivatives_.size() - from));
  }

  const Evidence& evidence_;
  const DeviatingChain& chain_;
  const std::vector<Vector3>& residuals_;
  Eigen::Index size_;
  std::vector<double> weights_;
  double weight_ = 0;  // of all rows
  std::vector<Eigen::Matrix3Xd> derivatives_;
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd step_;  // what an unchanging arm would still do about the residuals
  double squares_ = 0;    // weighted, that left out
  std::optional<Change> best_;
};

}  // namespace

std::optional<Change> likeliest_change(const Evidence& evidence, const DeviatingChain& chain,
                                       const std::vector<Vector3>& residuals_S) {
  if (evidence.rows.size() < kFewestRows) return std::nullopt;
  ScoreTest test(evidence, chain, residuals_S);
  auto change = test.run(candidates_of(evidence, chain));
  const Change strain = test.strain();
  if (!change || strain.evidence > change->evidence) change = strain;
  if (!change || !(change->evidence > 0)) return std::nullopt;
  return change;
}

double moved_by_change_m(const Change& change, const Evidence& evidence,
                         const DeviatingChain& chain) {
  const auto tool =
      std::ranges::find(chain.targets(), evidence.arm.joints.size(), &SeenTarget::link);
  if (tool == chain.targets().end()) return 0;
  JointTypes types;
  for (const DhJoint& joint : evidence.arm.joints) types.push_back(joint.type);
  EvidenceRow row;
  row.target = tool->number;
  Eigen::Matrix3Xd J(3, chain.all().count);
  double before = 0;
  double after = 0;
  for (int k = 1; k <= kJudged; ++k) {
    row.q = work_configuration(types, evidence.arm.limits, k);
    chain.derivatives(row, J);
    before += (J * change.before_it).squaredNorm();
    after += (J * change.after_it).squaredNorm();
  }
  return std::sqrt(std::max(before, after) / kJudged);
}

}  // namespace armsig::tool
