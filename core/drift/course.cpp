// SPDX-License-Identifier: MIT
#include "core/drift/course.hpp"

#include <cmath>

namespace armsig::drift {
namespace {

constexpr double kDecided = 3.0;  // ln 20

}  // namespace

std::string_view describe(Course course) {
  switch (course) {
    case Course::kUndecided:
      return "undecided";
    case Course::kStep:
      return "step";
    case Course::kRamp:
      return "ramp";
  }
  return "unknown";
}

// Least squares of both courses for every check at which they may have begun, newest first. With m
// checks since: a step explains |sum e|^2 / m of the squares, a ramp |sum u e|^2 / sum u^2, where
// u counts from 1 at the beginning; adding an older check raises every u by one.
Result<CourseReport> course_of(std::span<const Vector3> residuals_m, double sigma_m) {
  if (residuals_m.size() < 3) return std::unexpected(Error::kTooFewPoints);
  if (!(sigma_m > 0)) return std::unexpected(Error::kNotPositive);
  CourseReport report;
  Vector3 sum = Vector3::Zero();
  Vector3 weighted = Vector3::Zero();
  double best_step = -1;
  double best_ramp = -1;
  for (std::size_t back = 0; back < residuals_m.size(); ++back) {
    const Vector3& e = residuals_m[residuals_m.size() - 1 - back];
    if (!e.allFinite()) return std::unexpected(Error::kNotFinite);
    const auto m = static_cast<double>(back + 1);
    sum += e;
    weighted += sum;
    const double squares = m * (m + 1) * (2 * m + 1) / 6;
    if (const double step = sum.squaredNorm() / m; step > best_step) {
      best_step = step;
      report.step_checks = static_cast<int>(m);
      report.step_m = sum / m;
    }
    if (const double ramp = weighted.squaredNorm() / squares; ramp > best_ramp) {
      best_ramp = ramp;
      report.ramp_checks = static_cast<int>(m);
      report.ramp_m_per_check = weighted / squares;
    }
  }
  report.evidence = (best_step - best_ramp) / (2 * sigma_m * sigma_m);
  if (std::abs(report.evidence) >= kDecided) {
    report.course = report.evidence > 0 ? Course::kStep : Course::kRamp;
  }
  return report;
}

}  // namespace armsig::drift
