// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/since_then.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Dense>
#include <fmt/core.h>

#include "core/calibration/row.hpp"
#include "core/calibration/standing_still.hpp"
#include "core/numerics/rotations.hpp"
#include "firmware/host_tool/diagnosis/explanation.hpp"

namespace armsig::tool {

using calibration::Observation;
using calibration::Refined;
using Of = SinceThen::Of;

namespace {

constexpr std::size_t kFewestLater = 6;
constexpr std::size_t kMostLater = 60;  // spread_rows over all of them
constexpr int kHistorySteps = 8;
constexpr double kHistorySettled = 1e-3;  // of the cost, in a step
// Simpler histories as good as the best but for this count as well (nats).
constexpr double kNearlyAsGood = 10;
// Of a hundred histories tried the luckiest gains half as much from noise.
constexpr double kBeyondNoise = 10;
// 1 sigma of what may have happened.
constexpr double kMovedTurn = 0.5;
constexpr double kMovedPlace_m = 1;
constexpr double kReseated_m = 5e-3;
constexpr double kMovedZero = radians(1);
constexpr double kMovedZero_m = 5e-3;
constexpr double kOtherGear = 1e-3;
constexpr double kBentTurn = radians(0.5);
constexpr double kBent_m = 2e-3;

struct Part {
  Of of;
  std::size_t index = 0;  // of the joint; a target's

  [[nodiscard]] Eigen::Index size() const {
    switch (of) {
      case Of::kPlace:
      case Of::kLink:
        return 6;
      case Of::kTarget:
        return 3;
      default:
        return 1;
    }
  }
};
using Parts = std::vector<Part>;

Eigen::Index numbers_of(const Parts& parts) {
  return std::accumulate(parts.begin(), parts.end(), Eigen::Index{0},
                         [](Eigen::Index sum, const Part& part) { return sum + part.size(); });
}

// How unusual it is that all of these have changed.
int strangeness(const Parts& parts) {
  int sum = 0;
  bool zeros = false;
  for (const Part& part : parts) {
    switch (part.of) {
      case Of::kPlace:
        sum += 1;
        break;
      case Of::kTarget:
        sum += 2;
        break;
      case Of::kZero:
        sum += zeros ? 1 : 3;
        zeros = true;
        break;
      case Of::kGear:
        sum += 5;
        break;
      case Of::kLink:
        sum += 8;
        break;
    }
  }
  return sum;
}

Eigen::VectorXd usual_sizes(const Parts& parts, const JointTypes& types) {
  Eigen::VectorXd sigmas(numbers_of(parts));
  Eigen::Index at = 0;
  for (const Part& part : parts) {
    auto own = sigmas.segment(at, part.size());
    at += part.size();
    switch (part.of) {
      case Of::kPlace:
        own << kMovedTurn, kMovedTurn, kMovedTurn, kMovedPlace_m, kMovedPlace_m, kMovedPlace_m;
        break;
      case Of::kLink:
        own << kBentTurn, kBentTurn, kBentTurn, kBent_m, kBent_m, kBent_m;
        break;
      case Of::kTarget:
        own.setConstant(kReseated_m);
        break;
      case Of::kZero:
        own.setConstant(types[part.index] == JointType::kRevolute ? kMovedZero : kMovedZero_m);
        break;
      case Of::kGear:
        own.setConstant(kOtherGear);
        break;
    }
  }
  return sigmas;
}

// A turn about `centre` and a shift.
Pose turned_about(const Eigen::VectorXd& x, const Vector3& centre) {
  const Matrix3 R = numerics::rotation_by(Vector3(x.head<3>()));
  return {.R = R, .p = centre + Vector3(x.segment<3>(3)) - R * centre};
}

// The arm as it would be, and where it would be seen.
struct ChangedArm {
  Signature signature;
  JointVector zeros;
  JointVector gears;
  Pose X_SS;  // of what is seen
};

ChangedArm changed_arm(const Refined& estimate, const Parts& parts, const Eigen::VectorXd& x,
                       const Pose& X_start, const Vector3& middle) {
  const std::size_t n = estimate.signature.joint_count();
  ChangedArm arm{.signature = estimate.signature,
                 .zeros = JointVector(n, 0.0),
                 .gears = JointVector(n, 0.0),
                 .X_SS = {}};
  Eigen::Index at = 0;
  for (const Part& part : parts) {
    const Eigen::VectorXd own = x.segment(at, part.size());
    at += part.size();
    if (part.of == Of::kPlace) arm.X_SS = turned_about(own, middle) * X_start;
    if (part.of == Of::kTarget) arm.signature.targets[part.index].p_S += Vector3(own);
    if (part.of == Of::kZero) arm.zeros[part.index] = own[0];
    if (part.of == Of::kGear) arm.gears[part.index] = own[0];
    if (part.of != Of::kLink) continue;
    const Pose X = turned_about(own, arm.signature.X_SL[part.index].p);
    for (std::size_t k = part.index; k < arm.signature.X_SL.size(); ++k) {
      arm.signature.X_SL[k] = X * arm.signature.X_SL[k];
    }
    for (Target& target : arm.signature.targets) {
      if (target.link > part.index) target.p_S = X * target.p_S;
    }
  }
  return arm;
}

// A history fitted to the rows.
struct FittedHistory {
  Parts parts;
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  double nats = 0;
  double left_m = 0;
};

class Histories {
 public:
  Histories(const Refined& estimate, std::vector<Observation> rows,
            const std::optional<Place>& place)
      : estimate_(estimate), rows_(std::move(rows)) {
    for (const Observation& row : rows_) middle_ += row.p_S / static_cast<double>(rows_.size());
    // Where rows were measured from another place, the arm is seen moved the other way.
    if (place) X_start_ = place->X_ON.inverse();
    whiten();
  }

  [[nodiscard]] std::vector<FittedHistory> all() const {
    std::vector<FittedHistory> found;
    for (const auto& [strange, parts] : histories()) {
      if (3 * rows_.size() > static_cast<std::size_t>(numbers_of(parts)))
        found.push_back(fit(parts));
    }
    return found;
  }
  [[nodiscard]] FittedHistory of_noise() const { return fit({}); }
  [[nodiscard]] const Vector3& middle() const { return middle_; }
  [[nodiscard]] const Pose& started_from() const { return X_start_; }

 private:
  // The rows' own errors and what is not known of the arm, as one factor.
  void whiten() {
    const auto numbers = 3 * static_cast<Eigen::Index>(rows_.size());
    const std::size_t unknowns = estimate_.layout.size();
    const calibration::PoeChain chain(estimate_.signature, estimate_.readings);
    Eigen::MatrixXd half(numbers, static_cast<Eigen::Index>(unknowns));
    calibration::RowBlock<3> block;
    Eigen::VectorXd own(numbers);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Observation& row = rows_[k];
      (void)calibration::position_rows(estimate_, chain, row.readings, row.target, block);
      const double sigma_m = std::hypot(row.sigma_m > 0 ? row.sigma_m : estimate_.quality.sigma_m,
                                        estimate_.quality.unexplained_m);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto at = static_cast<Eigen::Index>(3 * k + i);
        estimate_.information.solve_transposed(block.rows[i]);
        for (std::size_t c = 0; c < unknowns; ++c) {
          half(at, static_cast<Eigen::Index>(c)) = block.rows[i][c];
        }
        own[at] = sigma_m * sigma_m;
      }
    }
    Eigen::MatrixXd covariance = half * half.transpose();
    covariance.diagonal() += own;
    factor_.compute(covariance);
  }

  [[nodiscard]] Eigen::VectorXd residuals(const Parts& parts, const Eigen::VectorXd& x) const {
    const ChangedArm arm = changed_arm(estimate_, parts, x, X_start_, middle_);
    const calibration::PoeChain chain(arm.signature, estimate_.readings);
    Eigen::VectorXd left(3 * static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      JointVector q = rows_[k].readings;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += arm.zeros[j] + arm.gears[j] * q[j];
      const Vector3 p_S = chain.point(chain.motion(q), arm.signature.targets[rows_[k].target]);
      left.segment<3>(3 * static_cast<Eigen::Index>(k)) = rows_[k].p_S - arm.X_SS * p_S;
    }
    return left;
  }

  [[nodiscard]] Eigen::VectorXd whitened(const Parts& parts, const Eigen::VectorXd& x) const {
    return factor_.matrixL().solve(residuals(parts, x));
  }

  // By differences: the sizes are known.
  [[nodiscard]] Eigen::MatrixXd derivatives(const Parts& parts, const Eigen::VectorXd& x,
                                            const Eigen::VectorXd& sigmas) const {
    constexpr double kStep = 1e-3;
    Eigen::MatrixXd J(3 * static_cast<Eigen::Index>(rows_.size()), x.size());
    for (Eigen::Index c = 0; c < x.size(); ++c) {
      Eigen::VectorXd beyond = x;
      Eigen::VectorXd before = x;
      const double step = kStep * std::min(sigmas[c], kMovedZero);
      beyond[c] += step;
      before[c] -= step;
      J.col(c) = (whitened(parts, before) - whitened(parts, beyond)) / (2 * step);
    }
    return J;
  }

  // What is left, and beyond its numbers no more than larger noise would make of it.
  [[nodiscard]] static double likelihood(double squares, double numbers) {
    return -0.5 * (squares <= numbers ? squares : numbers * (1 + std::log(squares / numbers)));
  }

  // Of residuals, and of the history's size against what is usual.
  [[nodiscard]] static double cost(const Eigen::VectorXd& left, const Eigen::VectorXd& weights,
                                   const Eigen::VectorXd& x) {
    return left.squaredNorm() + (weights.array() * x.array().square()).sum();
  }

  [[nodiscard]] FittedHistory fit(const Parts& parts) const {
    const Eigen::VectorXd sigmas = usual_sizes(parts, estimate_.signature.types);
    const Eigen::VectorXd weights = sigmas.array().square().inverse();
    FittedHistory found{
        .parts = parts, .x = Eigen::VectorXd::Zero(sigmas.size()), .covariance = {}};
    Eigen::VectorXd e = whitened(parts, found.x);
    Eigen::MatrixXd H;
    for (int step = 0; step < kHistorySteps && sigmas.size() > 0; ++step) {
      const Eigen::MatrixXd J = derivatives(parts, found.x, sigmas);
      H = J.transpose() * J;
      H.diagonal() += weights;
      const Eigen::VectorXd x =
          found.x +
          H.ldlt().solve(J.transpose() * e - Eigen::VectorXd(weights.cwiseProduct(found.x)));
      const Eigen::VectorXd left = whitened(parts, x);
      const double before = cost(e, weights, found.x);
      const double after = cost(left, weights, x);
      if (!(after < before)) break;
      found.x = x;
      e = left;
      if (after > (1 - kHistorySettled) * before) break;
    }
    const auto numbers = static_cast<double>(e.size());
    found.left_m = std::sqrt(residuals(parts, found.x).squaredNorm() / (numbers / 3));
    const double squares = cost(e, weights, found.x);
    found.nats = likelihood(squares, numbers);
    if (sigmas.size() > 0) spread(H, weights, std::max(1.0, squares / numbers), found);
    return found;
  }

  // Noise that is larger by `excess` says less of the unknowns. `H` holds their weights as well.
  static void spread(Eigen::MatrixXd H, const Eigen::VectorXd& weights, double excess,
                     FittedHistory& found) {
    H.diagonal() -= weights;
    H /= excess;
    H.diagonal() += weights;
    const Eigen::LDLT<Eigen::MatrixXd> factor(H);
    found.nats -= 0.5 * (factor.vectorD().array().log().sum() - weights.array().log().sum());
    found.covariance = factor.solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
  }

  // From the most usual to the least; each alone, then with the place, the target, both.
  [[nodiscard]] std::multimap<int, Parts> histories() const {
    const std::size_t n = estimate_.signature.joint_count();
    Parts targets;
    for (const Observation& row : rows_) {
      const auto known = [&](const Part& part) { return part.index == row.target; };
      if (std::ranges::none_of(targets, known)) targets.push_back({Of::kTarget, row.target});
    }
    std::vector<Parts> inside{{}};
    for (std::size_t j = 0; j < n; ++j) inside.push_back({{Of::kZero, j}});
    for (std::size_t j = 0; j < n; ++j) {
      const auto readings = [](const Observation& row) { return row.readings; };
      if (calibration::stood_still(rows_, readings, j, estimate_.signature.types[j])) continue;
      inside.push_back({{Of::kGear, j}});
    }
    for (std::size_t j = 1; j < n; ++j) inside.push_back({{Of::kLink, j}});
    Parts zeros;
    for (std::size_t j = 0; j < n; ++j) zeros.push_back({Of::kZero, j});
    inside.push_back(zeros);
    std::multimap<int, Parts> all;
    const Parts place{{Of::kPlace, 0}};
    Parts both = place;
    both.insert(both.end(), targets.begin(), targets.end());
    for (const Parts& outside : {Parts{}, place, targets, both}) {
      for (const Parts& one : inside) {
        Parts parts = outside;
        parts.insert(parts.end(), one.begin(), one.end());
        if (!parts.empty()) all.emplace(strangeness(parts), std::move(parts));
      }
    }
    return all;
  }

  const Refined& estimate_;
  std::vector<Observation> rows_;
  Vector3 middle_ = Vector3::Zero();
  Pose X_start_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

// `middle`: of what was seen; `X_start`: how it was seen before anything was fitted.
void describe_changes(const FittedHistory& fitted, const Pose& X_start, const Vector3& middle,
                      SinceThen& found) {
  Eigen::Index at = 0;
  for (const Part& part : fitted.parts) {
    const Eigen::VectorXd own = fitted.x.segment(at, part.size());
    const double sigma = std::sqrt(fitted.covariance(at, at));
    at += part.size();
    SinceThen::Change change{.of = part.of, .joint = part.index};
    switch (part.of) {
      case Of::kPlace: {
        const Pose X_SS = turned_about(own, middle) * X_start;
        change.size = (X_SS.inverse() * middle - middle).norm();
        change.turn_rad = angle_between(X_SS.R, Matrix3::Identity());
        break;
      }
      case Of::kLink:
        change.size = own.segment<3>(3).norm();
        change.turn_rad = own.head<3>().norm();
        break;
      case Of::kTarget:
        change.size = own.norm();
        break;
      default:
        change.size = own[0];
        change.sigma = sigma;
        if (std::abs(change.size) < kCertainSigmas * sigma) continue;
    }
    found.changes.push_back(change);
  }
}

std::vector<Observation> spread_rows(std::span<const Observation> rows,
                                     std::span<const calibration::RowOutcome> outcomes) {
  std::vector<Observation> good;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].kind != calibration::ObservationKind::kPosition) return {};
    if (rows[k].use != calibration::RowUse::kIgnore && !outcomes[k].rejected) {
      good.push_back(rows[k]);
    }
  }
  std::vector<Observation> few;
  const std::size_t step = (good.size() + kMostLater - 1) / kMostLater;
  for (std::size_t k = 0; k < good.size(); k += step) few.push_back(good[k]);
  return few;
}

}  // namespace

bool SinceThen::has(Of of) const {
  return std::ranges::any_of(changes, [&](const Change& change) { return change.of == of; });
}

std::optional<SinceThen> since_then(const Refined& estimate, std::span<const Observation> rows,
                                    std::span<const calibration::RowOutcome> outcomes,
                                    const std::optional<Place>& place) {
  std::vector<Observation> few = spread_rows(rows, outcomes);
  if (few.size() < kFewestLater) return std::nullopt;
  const Histories search(estimate, std::move(few), place);
  const FittedHistory noise = search.of_noise();
  const std::vector<FittedHistory> all = search.all();
  if (all.empty()) return std::nullopt;
  const double best = std::ranges::max(all, {}, &FittedHistory::nats).nats;
  const auto taken = std::ranges::find_if(
      all, [&](const FittedHistory& one) { return one.nats > best - kNearlyAsGood; });
  if (taken->nats < noise.nats + kBeyondNoise) return std::nullopt;
  SinceThen found{.changes = {},
                  .before_m = noise.left_m,
                  .after_m = taken->left_m,
                  .nats = taken->nats - noise.nats};
  describe_changes(*taken, search.started_from(), search.middle(), found);
  if (found.changes.empty()) return std::nullopt;
  return found;
}

std::vector<std::string> in_words(const SinceThen& found, const Signature& signature) {
  std::vector<std::string> words;
  for (const SinceThen::Change& change : found.changes) {
    const bool turns =
        signature.types[std::min(change.joint, signature.types.size() - 1)] == JointType::kRevolute;
    switch (change.of) {
      case Of::kPlace:
        words.push_back(fmt::format("the sensor or the base stands elsewhere: {}, {:.2f}°",
                                    short_length(change.size), degrees(change.turn_rad)));
        break;
      case Of::kTarget:
        words.push_back(fmt::format("target {} is another point, {} away",
                                    signature.targets[change.joint].number,
                                    short_length(change.size)));
        break;
      case Of::kZero:
        words.push_back(
            turns ? fmt::format("the zero of joint {} has moved by {:+.3f} ± {:.3f}°",
                                change.joint + 1, degrees(change.size), degrees(change.sigma))
                  : fmt::format("the zero of joint {} has moved by {:+.3f} ± {:.3f} mm",
                                change.joint + 1, 1e3 * change.size, 1e3 * change.sigma));
        break;
      case Of::kGear:
        words.push_back(fmt::format("the reading of joint {} is off by {:+.0f} ± {:.0f} ppm",
                                    change.joint + 1, 1e6 * change.size, 1e6 * change.sigma));
        break;
      case Of::kLink:
        words.push_back(fmt::format("link {} was bent or displaced: {}, {:.3f}°", change.joint,
                                    short_length(change.size), degrees(change.turn_rad)));
        break;
    }
  }
  return words;
}

std::string mend_of(const SinceThen& found) {
  if (found.has(Of::kGear)) {
    return "look at the gear and the motor of that joint; then identify anew, with poses measured "
           "since only";
  }
  if (found.has(Of::kZero)) {
    return "put those zeros right in the controller, unless its offsets were changed on "
           "purpose; or identify anew, with poses measured since only";
  }
  if (found.has(Of::kLink)) return "identify anew, with poses measured since only";
  if (found.has(Of::kTarget)) {
    return "seat the target as it was, or identify anew with the target as it is now; the arm "
           "itself is as it was";
  }
  return "identify from there, or put the sensor back";
}

}  // namespace armsig::tool
