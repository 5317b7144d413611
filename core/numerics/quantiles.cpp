// SPDX-License-Identifier: MIT
#include "core/numerics/quantiles.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::numerics {
namespace {

constexpr int kMostTerms = 2000;  // a million degrees of either kind take some 300
constexpr int kMostSteps = 60;    // two or three are usual
constexpr double kLastTerm = 1e-9;
constexpr double kLeastShrink = 0.05;  // of what is looked for, in a step
constexpr double kLastStep = 1e-4;     // relative; Newton's next one is of the order of its square

// The natural logarithm, by what the C library has without a table: its log would add 5 kB to an
// image. One function, that so many calls do not make it as large.
[[gnu::noinline]] double ln(double x) { return x < 1 ? -std::log1p(1 / x - 1) : std::log1p(x - 1); }

// ln of the gamma function of a > 0: Stirling's series (Abramowitz and Stegun, 6.1.41) from 8 on.
double log_gamma(double a) {
  double product = 1;
  while (a < 8) {
    product *= a;
    a += 1;
  }
  constexpr double kHalfLogTwoPi = 0.91893853320467274178;
  const double r = 1 / (a * a);
  const double series = (1.0 / 12 - r * (1.0 / 360 - r * (1.0 / 1260 - r / 1680))) / a;
  return (a - 0.5) * ln(a) - a + kHalfLogTwoPi + series - ln(product);
}

// A continued fraction 1 / (b0 + a1 / (b1 + ...)) from its front (Lentz, 1976).
class ContinuedFraction {
 public:
  explicit ContinuedFraction(double b0) : d_(1 / b0), value_(d_) {}

  // Takes a further a and b along; false where that changes nothing any more.
  bool take(double a, double b) {
    d_ = 1 / (b + a * d_);
    c_ = b + a / c_;
    value_ *= c_ * d_;
    return std::abs(c_ * d_ - 1) > kLastTerm;
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double c_ = 1e300;  // what stands for infinity
  double d_;
  double value_;
};

// Of the normal law, within 5e-4 (Abramowitz and Stegun, 26.2.23): a place to begin at.
double normal_quantile(double false_alarm) {
  const double t = std::sqrt(-2 * ln(false_alarm));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                 (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

// The cube root of the quantile over its degrees (Wilson and Hilferty, 1931; of Fisher's law
// Paulson, 1942: normal is ((1 - b) x - (1 - a)) / sqrt(b x^2 + a)); 0 where that is too rough.
double near_cube_root(double freedom, double sigmas, double noise_freedom) {
  const double a = 2 / (9 * freedom);
  const double b = noise_freedom > 0 ? 2 / (9 * noise_freedom) : 0;
  const double square = (1 - b) * (1 - b) - sigmas * sigmas * b;
  if (square <= 0.05) return 0;
  const double half = (1 - a) * (1 - b);
  const double constant = (1 - a) * (1 - a) - sigmas * sigmas * a;
  return (half + std::sqrt(std::max(0.0, half * half - square * constant))) / square;
}

// gamma(a, x) / (x^a e^-x).
double gamma_fraction(double a, double x) {
  ContinuedFraction fraction(x + 1 - a);
  for (int i = 1; i < kMostTerms; ++i) {
    if (!fraction.take(-i * (i - a), x + 1 - a + 2 * i)) break;
  }
  return fraction.value();
}

double chi_square(double freedom, double false_alarm) {
  const double a = freedom / 2;
  const double fixed = log_gamma(a) + ln(false_alarm);
  const double root = near_cube_root(freedom, normal_quantile(false_alarm), 0);
  double x = a * root * root * root;
  for (int k = 0; k < kMostSteps; ++k) {
    const double fraction = gamma_fraction(a, x);
    // The logarithm of the tail is nearly linear; its slope by ln x is -1 / fraction.
    const double step = (a * ln(x) - x + ln(fraction) - fixed) * fraction;
    x *= std::max(kLeastShrink, 1 + step);
    if (std::abs(step) < kLastStep) break;
  }
  return 2 * x;
}

// The incomplete beta function I_y(p, q), times p B(p, q) / (y^p (1 - y)^q).
double beta_fraction(double p, double q, double y) {
  ContinuedFraction fraction(1);
  fraction.take(-(p + q) * y / (p + 1), 1);
  for (int m = 1; m < kMostTerms; ++m) {
    const double n = p + 2 * m;
    fraction.take(m * (q - m) * y / ((n - 1) * n), 1);
    if (!fraction.take(-(p + m) * (p + q + m) * y / (n * (n + 1)), 1)) break;
  }
  return fraction.value();
}

// As y = n / (n + value), n the degrees of the noise.
double fisher(double freedom, double false_alarm, double noise_freedom) {
  const double p = noise_freedom / 2;
  const double q = freedom / 2;
  const double fixed = log_gamma(p) + log_gamma(q) - log_gamma(p + q) + ln(p) + ln(false_alarm);
  const double root = near_cube_root(freedom, normal_quantile(false_alarm), noise_freedom);
  // Otherwise from the mean: the logarithm is concave in ln y, so that the search comes from below.
  const double part = root > 0 ? root * root * root : 1;
  double y = noise_freedom / (noise_freedom + freedom * part);
  for (int k = 0; k < kMostSteps; ++k) {
    const double fraction = beta_fraction(p, q, y);
    const double slope = p / ((1 - y) * fraction);
    const double off = p * ln(y) + q * std::log1p(-y) + ln(fraction) - fixed;
    const double step = -off / slope;
    const double next = y * std::max(kLeastShrink, 1 + step);
    y = next < 1 ? next : (1 + y) / 2;
    if (std::abs(step) < kLastStep * (1 - y)) break;
  }
  return noise_freedom * (1 - y) / y;
}

}  // namespace

double chi_square_quantile(double freedom, double false_alarm, double noise_freedom) {
  if (!(freedom > 0)) return 0;
  return noise_freedom > 0 ? fisher(freedom, false_alarm, noise_freedom)
                           : chi_square(freedom, false_alarm);
}

}  // namespace armsig::numerics
