// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/tolerances_option.hpp"

#include <string_view>

#include <fmt/core.h>

#include "core/base/pose.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

std::unexpected<Problem> wrong(std::string_view text) {
  return std::unexpected(Problem{
      "--tolerances", 0, 0, fmt::format("{} is no tolerance", in_quotes(text)),
      "a factor such as 1, or a list of alpha_deg=, theta_deg=, a_mm=, d_mm= (or _rad, _m) with "
      "numbers that are not negative"});
}

// Where a tolerance called `name` goes, and what one of its unit is in SI.
struct Destination {
  double* value = nullptr;
  double unit = 1;
};

Destination destination(std::string_view name, simulated::Tolerances& tolerances) {
  constexpr double kDegree = radians(1.0);
  if (name == "alpha_deg") return {&tolerances.alpha_rad, kDegree};
  if (name == "alpha_rad") return {&tolerances.alpha_rad, 1};
  if (name == "theta_deg") return {&tolerances.theta_rad, kDegree};
  if (name == "theta_rad") return {&tolerances.theta_rad, 1};
  if (name == "a_mm") return {&tolerances.a_m, 1e-3};
  if (name == "a_m") return {&tolerances.a_m, 1};
  if (name == "d_mm") return {&tolerances.d_m, 1e-3};
  if (name == "d_m") return {&tolerances.d_m, 1};
  return {};
}

}  // namespace

Read<simulated::Tolerances> parse_tolerances(const std::string& text) {
  if (const auto factor = parse_number(text)) {
    if (*factor < 0) return wrong(text);
    simulated::Tolerances tolerances;
    tolerances.alpha_rad *= *factor;
    tolerances.theta_rad *= *factor;
    tolerances.a_m *= *factor;
    tolerances.d_m *= *factor;
    return tolerances;
  }
  simulated::Tolerances tolerances{.alpha_rad = 0, .theta_rad = 0, .a_m = 0, .d_m = 0};
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) return wrong(item);
    const Destination to = destination(trimmed(item.substr(0, equals)), tolerances);
    const auto number = parse_number(trimmed(item.substr(equals + 1)));
    if (to.value == nullptr || !number || *number < 0) return wrong(item);
    *to.value = *number * to.unit;
  }
  return tolerances;
}

}  // namespace armsig::tool
