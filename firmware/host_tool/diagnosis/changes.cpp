// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/changes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/explanation.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestRows = 24;
constexpr std::size_t kFewestOfPart = 4;  // rows before and after
constexpr double kFarthest = 30;
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

// The inverse of a matrix of normal equations; what the rows do not tell is left as it is. Beyond
// this part of what `scale` has on its diagonal only rounding is left.
constexpr double kTold = 1e-9;

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal, const Eigen::VectorXd& scale) {
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
      : evidence_(evidence), residuals_(residuals_S), size_(chain.all().count) {
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
      Eigen::MatrixXd usual = sums.twice.block(first, first, count, count);
      usual.diagonal().array() += 1 / (kUsualSize * kUsualSize);
      const Eigen::MatrixXd left = usual - across.transpose() * inverse_ * across;
      const Eigen::VectorXd score = sums.score.segment(first, count) - across.transpose() * step_;
      const Eigen::VectorXd size = inverse_of(left, usual.diagonal()) * score;
      const double gain = std::clamp(score.dot(size), 0.0, (1 - 1e-12) * squares_);
      const double freedom = 3 * static_cast<double>(weights_.size()) - static_cast<double>(size_);
      const double tried = static_cast<double>(candidates.size() * weights_.size());
      const double evidence = -0.5 * freedom * std::log1p(-gain / squares_) -
                              0.5 * static_cast<double>(count) * std::log(freedom) -
                              std::log(tried);
      if (best_ && evidence <= best_->evidence) continue;
      const double before_m = std::sqrt(squares_ / weight_);
      const double shift_m = moved_by(candidate, size, from);
      // What moves the rows by far more than they miss is hardly told from the arm itself.
      if (shift_m > kFarthest * before_m) continue;
      best_ = Change{.of = candidate.of,
                     .index = candidate.index,
                     .slow = slow,
                     .first_line = evidence_.rows[from].line,
                     .last_line = evidence_.rows.back().line,
                     .size = size,
                     .shift_m = shift_m,
                     .before_m = before_m,
                     .after_m = std::sqrt((squares_ - gain) / weight_),
                     .evidence = evidence};
    }
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

std::string when(const Change& change) {
  if (!change.slow) return fmt::format("from line {} on", change.first_line);
  return fmt::format("from line {} to line {}", change.first_line, change.last_line);
}

std::string of_reading(const Change& change, const Arm& arm) {
  const double off = -change.size[0];
  if (arm.joints[change.index].type == JointType::kPrismatic) return short_length(off);
  return fmt::format("{:+.3f}°", degrees(off));
}

}  // namespace

std::optional<Change> likeliest_change(const Evidence& evidence, const DeviatingChain& chain,
                                       const std::vector<Vector3>& residuals_S) {
  if (evidence.rows.size() < kFewestRows) return std::nullopt;
  ScoreTest test(evidence, chain, residuals_S);
  auto change = test.run(candidates_of(evidence, chain));
  if (!change || !(change->evidence > 0)) return std::nullopt;
  return change;
}

std::string in_words(const Change& change, const Arm& arm) {
  const std::string by = short_length(change.shift_m);
  const std::string at = when(change);
  switch (change.of) {
    case Change::Of::kSensor:
      return change.slow ? fmt::format("the positions drift by {} {}", by, at)
                         : fmt::format("{} the positions are shifted by {}", at, by);
    case Change::Of::kTarget:
      return change.slow
                 ? fmt::format("target {} creeps by {} {}", change.index, by, at)
                 : fmt::format("{} target {} is another point, {} away", at, change.index, by);
    case Change::Of::kZero: {
      const std::string off = of_reading(change, arm);
      return change.slow
                 ? fmt::format("the reading of joint {} drifts by {} {}", change.index + 1, off, at)
                 : fmt::format("{} the reading of joint {} is off by {}", at, change.index + 1,
                               off);
    }
    case Change::Of::kLink:
      return change.slow
                 ? fmt::format("the axis after joint {} creeps, and the target with it by {}, {}",
                               change.index + 1, by, at)
                 : fmt::format("{} the axis after joint {} stands elsewhere, and the target by {}",
                               at, change.index + 1, by);
    case Change::Of::kLengths:
      return fmt::format("{} all lengths {} by {:.0f} ppm", at,
                         change.size[0] > 0 ? "grow" : "shrink", 1e6 * std::abs(change.size[0]));
  }
  return {};
}

std::string mend_of(const Change& change) {
  switch (change.of) {
    case Change::Of::kSensor:
      return "the sensor fixed to the ground that the arm stands on, and warm; the first pose "
             "measured once more at the end tells";
    case Change::Of::kTarget:
      return "a target that is fixed firmly; the first pose measured once more at the end tells";
    case Change::Of::kZero:
      return fmt::format("a look at the encoder of joint {} and how it is clamped",
                         change.index + 1);
    case Change::Of::kLink:
      return "an arm that carries the same load all along, and touched nothing";
    case Change::Of::kLengths:
      return "arm and sensor warm before the first row is measured";
  }
  return {};
}

}  // namespace armsig::tool
