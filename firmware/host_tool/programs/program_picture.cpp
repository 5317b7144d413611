// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/program_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "firmware/formats/svg_picture.hpp"

namespace armsig::tool {
namespace {

constexpr double kWidth = 960;
constexpr double kHeight = 640;
constexpr double kLargestArrow = 45;  // of the picture, for the largest miss
constexpr double kMargin = 1.5 * kLargestArrow;

// A target, and how far the tool is from it in both programs.
struct Miss {
  Vector3 p_C;
  Vector3 before;
  std::optional<Vector3> after;
};

// Targets are in the same order in both programs; of those that only one reaches the other says
// nothing.
std::vector<Miss> misses_of(const RunProgram& run) {
  std::vector<Miss> misses;
  auto next = run.after == nullptr ? run.before.arrivals.end() : run.after->arrivals.begin();
  for (const Arrival& one : run.before.arrivals) {
    Miss miss{one.X_CT.p, one.X_CA.p - one.X_CT.p, {}};
    if (run.after != nullptr) {
      const auto end = run.after->arrivals.end();
      const auto other = std::find_if(next, end, [&](const Arrival& candidate) {
        return candidate.line == one.line && candidate.name == one.name;
      });
      if (other != end) {
        miss.after = other->X_CA.p - one.X_CT.p;
        next = other + 1;
      }
    }
    misses.push_back(miss);
  }
  return misses;
}

void draw_view(SvgPicture& picture, const Panel& panel, const std::vector<Miss>& misses,
               const View& view, double magnified) {
  std::vector<std::array<double, 2>> targets;
  for (const Miss& miss : misses) targets.push_back(view.at(miss.p_C));
  picture.path("path", targets);
  for (const Miss& miss : misses) {
    const auto at = view.at(miss.p_C);
    picture.line("before", at, view.at(miss.p_C + magnified * miss.before));
    if (miss.after) picture.line("after", at, view.at(miss.p_C + magnified * *miss.after));
    picture.circle("target", at, 2);
  }
  picture.scale_bar(panel, view);
}

void draw_bars(SvgPicture& picture, const Panel& panel, const std::vector<Miss>& misses,
               double largest_m) {
  const double step_m = round_below(largest_m / 2);
  const double top_m = step_m * std::ceil(largest_m / step_m);
  const double foot = panel.y + panel.height;
  for (int k = 0; k * step_m <= top_m * (1 + 1e-9); ++k) {
    const double y = foot - panel.height * k * step_m / top_m;
    picture.line("axis", {panel.x, y}, {panel.x + panel.width, y});
    picture.words("soft", 24, y + 4, fmt::format("{:g} mm", 1e3 * k * step_m));
  }
  const double place = panel.width / static_cast<double>(misses.size());
  const double beside = std::min(2.0, place / 4);
  for (std::size_t k = 0; k < misses.size(); ++k) {
    const double x = panel.x + place * (static_cast<double>(k) + 0.5);
    const auto bar = [&](std::string_view kind, double at, double miss_m) {
      picture.line(kind, {at, foot}, {at, foot - panel.height * miss_m / top_m});
    };
    bar("before", x - beside, misses[k].before.norm());
    if (misses[k].after) bar("after", x + beside, misses[k].after->norm());
  }
}

struct Misses {
  double mean_m = 0;
  double largest_m = 0;
};

template <typename MissOf>
std::optional<Misses> sizes(const std::vector<Miss>& misses, MissOf of) {
  Misses sizes;
  double count = 0;
  for (const Miss& miss : misses) {
    const std::optional<Vector3> by = of(miss);
    if (!by) continue;
    ++count;
    sizes.mean_m += by->norm();
    sizes.largest_m = std::max(sizes.largest_m, by->norm());
  }
  if (count == 0) return std::nullopt;
  sizes.mean_m /= count;
  return sizes;
}

std::string missed_in_words(std::string_view what, const Misses& sizes) {
  return fmt::format("{}: missed by {:.3f} mm in the mean, {:.3f} mm at most", what,
                     1e3 * sizes.mean_m, 1e3 * sizes.largest_m);
}

}  // namespace

std::string program_picture(const RunProgram& run, std::string_view title) {
  const std::vector<Miss> misses = misses_of(run);
  const auto before = sizes(misses, [](const Miss& miss) { return std::optional(miss.before); });
  const auto after = sizes(misses, [](const Miss& miss) { return miss.after; });
  const double largest_m =
      std::max({1e-9, before ? before->largest_m : 0, after ? after->largest_m : 0});
  const Panel above{40, 110, 420, 260};
  const Panel side{520, 110, 400, 260};
  const Panel bars{90, 480, 830, 130};
  Eigen::AlignedBox3d box;
  for (const Miss& miss : misses) box.extend(miss.p_C);
  View from_above(above, box, {0, 1}, kMargin);
  View from_side(side, box, {0, 2}, kMargin);
  from_above.scale = from_side.scale = std::min(from_above.scale, from_side.scale);
  const double magnified =
      round_below(std::max(1.0, kLargestArrow / (from_above.scale * largest_m)));
  SvgPicture picture(kWidth, kHeight, title);
  picture.line("before", {24, 49}, {44, 49});
  picture.words("", 52, 54, missed_in_words("As it is", *before));
  if (after) {
    picture.line("after", {24, 71}, {44, 71});
    picture.words("", 52, 76, missed_in_words("Corrected", *after));
  }
  const std::string how = fmt::format("misses {:g} times as long", magnified);
  picture.words("soft", above.x, 100, "From above: x to the right, y up; " + how);
  picture.words("soft", side.x, 100, "From the side: x to the right, z up; " + how);
  draw_view(picture, above, misses, from_above, magnified);
  draw_view(picture, side, misses, from_side, magnified);
  picture.words("soft", bars.x, bars.y - 16, "Miss at each target, in the order of the program");
  draw_bars(picture, bars, misses, largest_m);
  return picture.text();
}

}  // namespace armsig::tool
