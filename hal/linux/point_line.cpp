// SPDX-License-Identifier: MIT
#include "hal/linux/point_line.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <span>
#include <system_error>

#include <Eigen/Eigenvalues>

namespace armsig::linux_hal {
namespace {

constexpr std::string_view kWord = "point";
// In the order in which they are used below.
constexpr std::array<std::string_view, 11> kKeys{"x_mm",    "y_mm",    "z_mm",    "sigma_mm",
                                                 "cxx_mm2", "cxy_mm2", "cxz_mm2", "cyy_mm2",
                                                 "cyz_mm2", "czz_mm2", "seq"};
constexpr std::size_t kSigma = 3;
constexpr std::size_t kCovariance = 4;
constexpr std::size_t kSequence = 10;
constexpr double kSquare_m2 = 1e-6;  // of a millimetre

using Checked = std::expected<void, PointLineProblem>;
using Values = std::array<std::optional<double>, kKeys.size()>;

std::unexpected<PointLineProblem> problem(std::string_view key, std::string_view what) {
  return std::unexpected(PointLineProblem{key, what});
}

bool is_printed(char c) { return c >= 0x20 && c < 0x7F; }

// The next word of `rest`, which it is taken from; empty: there is none.
std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = std::min(rest.find_first_not_of(' '), rest.size());
  const std::size_t end = std::min(rest.find(' ', begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

Checked take_word(std::string_view word, Values& values) {
  const std::size_t equals = word.find('=');
  const auto* const known = std::ranges::find(kKeys, word.substr(0, equals));
  if (equals == std::string_view::npos || known == kKeys.end()) {
    return problem("a key", "is unknown");
  }
  auto& value = values[static_cast<std::size_t>(known - kKeys.begin())];
  if (value) return problem(*known, "is there twice");
  const std::string_view text = word.substr(equals + 1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    return problem(*known, "is not a number");
  }
  value = number;
  return {};
}

Checked take_place(const Values& values, PointLine& line) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!values[axis]) return problem(kKeys[axis], "is missing");
    if (std::abs(*values[axis]) > kFarthestPoint_mm) {
      return problem(kKeys[axis], "is farther away than 100 m");
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
      return problem("the covariance", "has a sigma that is not between 0.001 and 50 mm");
    }
  }
  line.covariance_m2 = kSquare_m2 * covariance_mm2;
  return {};
}

Checked take_error(const Values& values, PointLine& line) {
  const auto told = std::span(values).subspan(kCovariance, kSequence - kCovariance);
  const auto count = std::ranges::count_if(told, [](const auto& value) { return bool(value); });
  const auto& sigma_mm = values[kSigma];
  if (count > 0 && sigma_mm) return problem("sigma_mm", "stands beside a covariance");
  if (count > 0 && count < std::ssize(told)) return problem("the covariance", "is not whole");
  if (count > 0) return take_covariance(told, line);
  if (!sigma_mm) return {};
  if (!is_sigma(*sigma_mm)) return problem("sigma_mm", "is not between 0.001 and 50");
  line.covariance_m2 = kSquare_m2 * *sigma_mm * *sigma_mm * Matrix3::Identity();
  return {};
}

Checked take_sequence(const Values& values, PointLine& line) {
  const auto& number = values[kSequence];
  if (!number) return {};
  if (!(*number >= 0 && *number <= UINT32_MAX && *number == std::floor(*number))) {
    return problem("seq", "is not a whole number of 32 bits");
  }
  line.sequence = static_cast<std::uint32_t>(*number);
  return {};
}

}  // namespace

std::expected<PointLine, PointLineProblem> parse_point_line(std::string_view text) {
  if (!std::ranges::all_of(text, is_printed)) return problem("the line", "is not text");
  if (next_word(text) != kWord) return problem("the line", "does not begin with point");
  Values values;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
    if (auto taken = take_word(word, values); !taken) return std::unexpected(taken.error());
  }
  PointLine line;
  for (const auto take : {take_place, take_error, take_sequence}) {
    if (auto taken = take(values, line); !taken) return std::unexpected(taken.error());
  }
  return line;
}

}  // namespace armsig::linux_hal
