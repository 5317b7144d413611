// SPDX-License-Identifier: MIT
#include "hal/linux/point_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Eigenvalues>

namespace armsig::linux_hal {
namespace {

// In the order in which they are used below.
constexpr std::array<std::string_view, 11> kPointKeys{"x_mm",    "y_mm",    "z_mm",    "sigma_mm",
                                                      "cxx_mm2", "cxy_mm2", "cxz_mm2", "cyy_mm2",
                                                      "cyz_mm2", "czz_mm2", "seq"};
constexpr LineForm kPointForm{"point", "does not begin with point", kPointKeys};
constexpr std::size_t kSigma = 3;
constexpr std::size_t kCovariance = 4;
constexpr std::size_t kSequence = 10;
constexpr double kSquare_m2 = 1e-6;  // of a millimetre

using Checked = std::expected<void, LineProblem>;
using Values = std::array<std::optional<double>, kPointKeys.size()>;

Checked take_place(const Values& values, PointLine& line) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!values[axis]) return line_problem(kPointKeys[axis], "is missing");
    if (std::abs(*values[axis]) > kFarthest_mm) {
      return line_problem(kPointKeys[axis], "is farther away than 100 m");
    }
    line.p_S[static_cast<Eigen::Index>(axis)] = 1e-3 * *values[axis];
  }
  return {};
}

bool is_sigma(double sigma_mm) {
  return sigma_mm >= kLeastPointSigma_mm && sigma_mm <= kLargestPointSigma_mm;
}

// Of six values, all of which are told.
Checked take_covariance(std::span<const std::optional<double>> told, PointLine& line) {
  const auto c = [&](std::size_t i) { return told[i].value_or(0); };
  const Matrix3 covariance_mm2{{c(0), c(1), c(2)}, {c(1), c(3), c(4)}, {c(2), c(4), c(5)}};
  Eigen::SelfAdjointEigenSolver<Matrix3> axes;
  axes.computeDirect(covariance_mm2, Eigen::EigenvaluesOnly);
  for (const double square : axes.eigenvalues()) {
    if (!(square > 0 && is_sigma(std::sqrt(square)))) {
      return line_problem("the covariance", "has a sigma that is not between 0.001 and 50 mm");
    }
  }
  line.covariance_m2 = kSquare_m2 * covariance_mm2;
  return {};
}

Checked take_error(const Values& values, PointLine& line) {
  const auto told = std::span(values).subspan(kCovariance, kSequence - kCovariance);
  const auto count = std::ranges::count_if(told, [](const auto& value) { return bool(value); });
  const auto& sigma_mm = values[kSigma];
  if (count > 0 && sigma_mm) return line_problem("sigma_mm", "stands beside a covariance");
  if (count > 0 && count < std::ssize(told)) return line_problem("the covariance", "is not whole");
  if (count > 0) return take_covariance(told, line);
  if (!sigma_mm) return {};
  if (!is_sigma(*sigma_mm)) return line_problem("sigma_mm", "is not between 0.001 and 50");
  line.covariance_m2 = kSquare_m2 * *sigma_mm * *sigma_mm * Matrix3::Identity();
  return {};
}

}  // namespace

std::expected<PointLine, LineProblem> PointLine::parse(std::string_view text) {
  Values values;
  if (auto read = read_keyed_line(text, kPointForm, values); !read) {
    return std::unexpected(read.error());
  }
  PointLine line;
  for (const auto take : {take_place, take_error}) {
    if (auto taken = take(values, line); !taken) return std::unexpected(taken.error());
  }
  const auto sequence = sequence_in(values[kSequence]);
  if (!sequence) return std::unexpected(sequence.error());
  line.sequence = *sequence;
  return line;
}

}  // namespace armsig::linux_hal
