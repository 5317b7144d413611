// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/near_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

#include "core/base/links.hpp"
#include "firmware/host_tool/diagnosis/base_search.hpp"

namespace armsig::tool {
namespace {

constexpr double kRejected = 10.0;  // sigmas per axis from which on nothing is believed
constexpr int kGentleSteps = 3;     // in which no row is given up yet
constexpr double kLeastDamping = 1e-9;
constexpr double kClip = 0.1;
constexpr double kOutvoted = 10;      // what all rows miss by, of what seven tenths do
constexpr double kWorthAStep = 5e-3;  // share of cost and scale that a step must save

class Fit {
 public:
  Fit(const Evidence& evidence, const ArmLimits& limits)
      : evidence_(evidence), chain_(evidence, limits) {}

  void start(const BasePlace& place) { chain_.place(place.X_SB, place.p_LT); }

  enum class Rows { kMost, kAll };

  void descend(int steps, Rows of = Rows::kMost) {
    residuals_ = chain_.residuals(evidence_);
    double damping = 1e-4;
    // Between a factor and many deviations only their priors choose: damping holds them apart.
    const bool free_factor = evidence_.free_scale || evidence_.free_gain != 0;
    const double settled_below = free_factor ? kLeastDamping : 1;
    for (int step = 0; step < steps; ++step) {
      const double sigma_before_m = sigma_m_;
      weigh(of == Rows::kAll      ? Weighing::kAlike
            : step < kGentleSteps ? Weighing::kGentle
                                  : Weighing::kStrict);
      const double cost = cost_of(residuals_, chain_);
      const DeviatingChain::Normal normal = chain_.normal(evidence_, residuals_, weights_);
      bool better = false;
      bool settled = false;
      for (int attempt = 0; attempt < 4 && !better; ++attempt) {
        Eigen::MatrixXd H = normal.H;
        H.diagonal() += damping * normal.H.diagonal();
        H.diagonal().array() += 1e-9;
        const Eigen::VectorXd x = H.ldlt().solve(normal.g);
        if (!x.allFinite()) return;
        DeviatingChain next = chain_;
        next.move(x);
        std::vector<Vector3> there = next.residuals(evidence_);
        const double reached = cost_of(there, next);
        better = reached <= cost * (1 + 1e-12);
        settled = step > kGentleSteps && better && damping <= settled_below &&
                  reached > cost * (1 - kWorthAStep) &&
                  sigma_m_ > (1 - kWorthAStep) * sigma_before_m;
        if (better) {
          chain_ = std::move(next);
          residuals_ = std::move(there);
          damping = std::max(kLeastDamping, 0.1 * damping);
        } else {
          damping *= 30;
        }
      }
      if (!better || settled) return;
    }
  }

  [[nodiscard]] const DeviatingChain& chain() const { return chain_; }

  [[nodiscard]] NearFit result() const {
    NearFit fit;
    fit.joints = chain_.deviations();
    fit.residuals_S = residuals_;
    fit.reach_m = chain_.reach_m();
    fit.scale = chain_.scale();
    fit.gain = chain_.gain();
    fit.X_SB = chain_.X_SB();
    fit.X_SM = chain_.X_SM();
    std::vector<double> lengths;
    for (const Vector3& residual : residuals_) lengths.push_back(residual.norm());
    fit.clipped_m = clipped_rms(lengths, fit.reach_m);
    fit.sigma_m = sigma_by_median(lengths);
    fit.best_rms_m = trimmed_rms(std::move(lengths));
    return fit;
  }

 private:
  enum class Weighing { kAlike, kGentle, kStrict };

  void weigh(Weighing how) {
    std::vector<double> lengths;
    double squares = 0;
    for (const Vector3& residual : residuals_) {
      lengths.push_back(residual.norm());
      squares += residual.squaredNorm();
    }
    if (how == Weighing::kAlike) {
      sigma_m_ =
          std::max(kLeastSigma_m, std::sqrt(squares / (3 * static_cast<double>(lengths.size()))));
      weights_.assign(lengths.size(), 1 / (sigma_m_ * sigma_m_));
      return;
    }
    sigma_m_ = std::max(kLeastSigma_m, sigma_by_median(lengths));
    weights_.assign(lengths.size(), 0);
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      const double in_sigma = lengths[k] / (sigma_m_ * std::numbers::sqrt3);
      if (how == Weighing::kStrict && in_sigma > kRejected) continue;
      weights_[k] = huber_weight(lengths[k], sigma_m_);
    }
  }

  [[nodiscard]] double cost_of(const std::vector<Vector3>& residuals,
                               const DeviatingChain& chain) const {
    double cost = chain.prior_squares();
    for (std::size_t k = 0; k < residuals.size(); ++k) {
      cost += weights_[k] * residuals[k].squaredNorm();
    }
    return cost;
  }

  const Evidence& evidence_;
  DeviatingChain chain_;
  std::vector<Vector3> residuals_;
  std::vector<double> weights_;
  double sigma_m_ = 0;  // by which the rows are weighed
};

std::vector<BasePlace> places_of(const Evidence& evidence) {
  const std::vector<SeenTarget> targets = seen_targets(evidence);
  std::vector<PlacedRow> rows;
  for (const EvidenceRow& row : evidence.rows) {
    if (row.moved) continue;
    const auto target = std::ranges::find(targets, row.target, &SeenTarget::number);
    const auto frames = dh_frames(evidence.arm.joints, effective_readings(evidence.arm, row.q));
    rows.push_back(
        {frames[target->link], row.p_S, static_cast<std::size_t>(target - targets.begin())});
  }
  return find_base(rows, targets.size());
}

}  // namespace

double NearFit::farthest(const ArmLimits& limits, const Arm& arm) const {
  const double shift_m = std::max(limits.least_shift_m, limits.shift_share * reach_m);
  double farthest = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double zero = arm.joints[j].type == JointType::kRevolute
                            ? limits.zero_rad
                            : std::max(limits.least_shift_m, limits.zero_share * reach_m);
    farthest = std::max({farthest, joints[j].tilt_rad / limits.tilt_rad,
                         joints[j].shift_m / shift_m, std::abs(joints[j].zero) / zero});
  }
  return farthest;
}

double NearFit::strangeness(const ArmLimits& limits) const {
  const double shift_m = std::max(limits.least_shift_m, limits.shift_share * reach_m);
  double squares = 0;
  for (const Deviation& joint : joints) {
    squares += std::pow(3 * joint.tilt_rad / limits.tilt_rad, 2) +
               std::pow(3 * joint.shift_m / shift_m, 2);
  }
  return squares / static_cast<double>(2 * joints.size());
}

double drawn_misfit(const Evidence& evidence) {
  if (evidence.rows.empty()) return std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (const BasePlace& place : places_of(evidence)) {
    Fit fit(evidence, {});
    fit.start(place);
    fit.descend(0);
    const NearFit found = fit.result();
    least = std::min(least, found.best_rms_m / found.reach_m);
  }
  return least;
}

double clipped_rms(const std::vector<double>& lengths_m, double reach_m) {
  double squares = 0;
  for (const double length_m : lengths_m) {
    squares += std::pow(std::min(length_m, kClip * reach_m), 2);
  }
  return std::sqrt(squares / static_cast<double>(lengths_m.size()));
}

std::optional<NearestArm> nearest_arm(const Evidence& evidence, const ArmLimits& limits,
                                      int steps) {
  if (evidence.rows.empty()) return std::nullopt;
  std::optional<NearestArm> best;
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const Fit& fit) {
    NearFit found = fit.result();
    const double score = found.best_rms_m * (1 + found.farthest(limits, evidence.arm));
    if (!(score < least)) return;
    least = score;
    best.emplace(std::move(found), fit.chain());
  };
  for (const BasePlace& place : places_of(evidence)) {
    Fit fit(evidence, limits);
    fit.start(place);
    fit.descend(steps);
    take(fit);
    // Rows that all but agree soon outvote a sweep that alone would have shown the way.
    const NearFit found = fit.result();
    if (found.clipped_m < kOutvoted * found.best_rms_m) continue;
    Fit of_all(evidence, limits);
    of_all.start(place);
    of_all.descend(steps, Fit::Rows::kAll);
    of_all.descend(steps);
    take(of_all);
  }
  return best;
}

std::optional<NearFit> fit_near(const Evidence& evidence, const ArmLimits& limits, int steps) {
  auto nearest = nearest_arm(evidence, limits, steps);
  if (!nearest) return std::nullopt;
  return std::move(nearest->fit);
}

}  // namespace armsig::tool
