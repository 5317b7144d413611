// SPDX-License-Identifier: MIT
#include "firmware/analysis/evaluation/threshold.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/drift/cusum.hpp"

namespace armsig::drift {
namespace {

constexpr double kStep = 0.01;
constexpr std::size_t kSteps = 8'000;
constexpr int kArmsWatched = 20'000;
constexpr double kAlarmsCounted = 250;  // of which one sigma is a sixteenth
constexpr double kMostBaseline = 1'000;

// Normal variables by the method of Box and Muller over the generator splitmix64 (Steele, Lea,
// Flood 2014): the same on every machine, and three at a time.
class Normals {
 public:
  explicit Normals(std::uint64_t seed) : state_(seed) {}

  Vector3 next() {
    const double x = one();
    const double y = one();
    return {x, y, one()};
  }

 private:
  double uniform() {  // in (0, 1]
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    z ^= z >> 31U;
    return static_cast<double>((z >> 11U) + 1) * 0x1p-53;
  }
  double one() {
    if (kept_) {
      kept_ = false;
      return second_;
    }
    const double radius = std::sqrt(-2 * std::log(uniform()));
    const double angle = 2 * kPi * uniform();
    second_ = radius * std::sin(angle);
    kept_ = true;
    return radius * std::cos(angle);
  }

  std::uint64_t state_;
  double second_ = 0;
  bool kept_ = false;
};

// The checks of one arm from its baseline on, in sigma_c as told: first-order autoregressive.
class Checks {
 public:
  Checks(const Scatter& scatter, Normals& normals)
      : scatter_(scatter),
        fresh_(std::sqrt(1 - scatter.correlation * scatter.correlation)),
        normals_(normals),
        noise_(normals.next()) {
    for (int i = 0; i < scatter.baseline; ++i) reference_ += draw() / scatter.baseline;
  }

  Vector3 next() { return scatter_.sigma_ratio * (draw() - reference_); }

 private:
  Vector3 draw() {
    const Vector3 now = noise_;
    noise_ = scatter_.correlation * noise_ + fresh_ * normals_.next();
    return now;
  }

  const Scatter& scatter_;
  double fresh_;
  Normals& normals_;
  Vector3 noise_;
  Vector3 reference_ = Vector3::Zero();
};

bool is_good(double reference, const Scatter& scatter) {
  return std::isfinite(reference) && reference > 0 && scatter.baseline >= 0 &&
         scatter.baseline <= kMostBaseline && scatter.correlation >= 0 && scatter.correlation < 1 &&
         scatter.sigma_ratio >= 0.1 && scatter.sigma_ratio <= 10;
}

}  // namespace

Result<double> threshold(double reference, const Scatter& scatter, const FalseAlarms& allowed) {
  const double checks = std::round(allowed.checks_per_month * allowed.months);
  const double share = allowed.per_month * allowed.months;
  if (!is_good(reference, scatter) || !(checks >= 1 && checks <= 5'000) ||
      !(share >= 1e-3 && share <= 0.5)) {
    return std::unexpected(Error::kOutOfRange);
  }
  // The sum does not depend on the threshold until it is passed: one life of an arm, followed
  // without one, tells for every threshold whether the arm would have been named.
  const int arms = std::max(kArmsWatched, static_cast<int>(kAlarmsCounted / share));
  std::array<std::uint32_t, kSteps + 1> largest{};
  Normals normals(1);
  for (int arm = 0; arm < arms; ++arm) {
    Checks life(scatter, normals);
    Vector3 sum = Vector3::Zero();
    double square = 0;
    for (int check = 0; check < static_cast<int>(checks); ++check) {
      sum = crosier(sum, life.next(), reference);
      square = std::max(square, sum.squaredNorm());
    }
    const double steps = std::min(std::sqrt(square) / kStep, static_cast<double>(kSteps));
    ++largest[static_cast<std::size_t>(steps)];
  }
  const double named = share * arms;
  double above = 0;
  for (std::size_t step = kSteps + 1; step-- > 0;) {
    above += largest[step];
    if (above <= named) continue;
    if (step >= kSteps) break;
    return static_cast<double>(step + 1) * kStep;
  }
  return std::unexpected(Error::kNotConverged);
}

Result<Detection> detection(double reference, double threshold, double shift, int checks,
                            const Scatter& scatter) {
  if (!is_good(reference, scatter) || !(threshold > 0) || !std::isfinite(shift) || checks < 1 ||
      checks > 1'000) {
    return std::unexpected(Error::kOutOfRange);
  }
  Detection found;
  int named = 0;
  Normals normals(2);
  for (int arm = 0; arm < kArmsWatched; ++arm) {
    Checks life(scatter, normals);
    Vector3 sum = Vector3::Zero();
    for (int check = 1; check <= checks; ++check) {
      sum = crosier(sum, life.next() + shift * Vector3::UnitX(), reference);
      if (sum.norm() <= threshold) continue;
      ++named;
      found.mean_checks += check;
      break;
    }
  }
  found.within = static_cast<double>(named) / kArmsWatched;
  if (named > 0) found.mean_checks /= named;
  return found;
}

}  // namespace armsig::drift
