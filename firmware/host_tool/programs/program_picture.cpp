// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/program_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {
namespace {

constexpr double kWidth = 960;
constexpr double kHeight = 640;
constexpr double kLargestArrow = 45;  // of the picture, for the largest miss
constexpr double kLeastExtent_m = 1e-2;

constexpr std::string_view kStyle =
    "text{font:14px system-ui,\"DejaVu Sans\",sans-serif;fill:#1f2328}.title{font-weight:600;"
    "font-size:16px}.soft{fill:#59636e;font-size:12px}.paper{fill:#fff}.path{fill:none;stroke:"
    "#818b98;stroke-width:1}.axis{stroke:#d1d9e0;stroke-width:1}.before{stroke:#bc4c00;"
    "stroke-width:2;stroke-linecap:round}.after{stroke:#0969da;stroke-width:2;stroke-linecap:round}"
    ".target{fill:#1f2328}@media(prefers-color-scheme:dark){text{fill:#e6edf3}.soft{fill:#9198a1}"
    ".paper{fill:#0d1117}.path{stroke:#7d8590}.axis{stroke:#30363d}.before{stroke:#f0883e}.after{"
    "stroke:#4493f8}.target{fill:#e6edf3}}";

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

// The largest of 1, 2, 5 times a power of ten that is not above `value`.
double round_below(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double digit = value / power;
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

struct Panel {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// A view of the base along one axis: across and up are indices of coordinates.
class View {
 public:
  View(const Panel& panel, const Eigen::AlignedBox3d& box, std::array<Eigen::Index, 2> axes)
      : across_(axes[0]),
        up_(axes[1]),
        centre_(box.center()),
        middle_x_(panel.x + panel.width / 2),
        middle_y_(panel.y + panel.height / 2) {
    const double margin = 1.5 * kLargestArrow;
    const Vector3 size = box.sizes().cwiseMax(kLeastExtent_m);
    scale = std::min((panel.width - margin) / size[across_], (panel.height - margin) / size[up_]);
  }

  [[nodiscard]] std::array<double, 2> at(const Vector3& p_C) const {
    const Vector3 off = scale * (p_C - centre_);
    return {middle_x_ + off[across_], middle_y_ - off[up_]};
  }

  double scale = 1;  // units of the picture a metre: the largest with which the box fits in

 private:
  Eigen::Index across_;
  Eigen::Index up_;
  Vector3 centre_;
  double middle_x_;
  double middle_y_;
};

void line(std::string& svg, std::string_view kind, std::array<double, 2> from,
          std::array<double, 2> to) {
  fmt::format_to(std::back_inserter(svg),
                 "<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", kind, from[0],
                 from[1], to[0], to[1]);
}

void words(std::string& svg, std::string_view kind, double x, double y, std::string_view text) {
  fmt::format_to(std::back_inserter(svg),
                 "<text class=\"{}\" x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", kind, x, y,
                 markup_text(text));
}

void draw_view(std::string& svg, const Panel& panel, const std::vector<Miss>& misses,
               const View& view, double magnified) {
  svg += R"(<path class="path" d=")";
  for (std::size_t k = 0; k < misses.size(); ++k) {
    const auto at = view.at(misses[k].p_C);
    fmt::format_to(std::back_inserter(svg), "{}{:.1f} {:.1f}", k == 0 ? "M" : "L", at[0], at[1]);
  }
  svg += "\"/>\n";
  for (const Miss& miss : misses) {
    const auto at = view.at(miss.p_C);
    line(svg, "before", at, view.at(miss.p_C + magnified * miss.before));
    if (miss.after) line(svg, "after", at, view.at(miss.p_C + magnified * *miss.after));
    fmt::format_to(std::back_inserter(svg),
                   "<circle class=\"target\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/>\n", at[0],
                   at[1]);
  }
  const double length_m = round_below(0.3 * panel.width / view.scale);
  const double foot = panel.y + panel.height + 12;
  line(svg, "path", {panel.x, foot}, {panel.x + length_m * view.scale, foot});
  words(svg, "soft", panel.x, foot + 16, fmt::format("{:g} mm", 1e3 * length_m));
}

void draw_bars(std::string& svg, const Panel& panel, const std::vector<Miss>& misses,
               double largest_m) {
  const double step_m = round_below(largest_m / 2);
  const double top_m = step_m * std::ceil(largest_m / step_m);
  const double foot = panel.y + panel.height;
  for (int k = 0; k * step_m <= top_m * (1 + 1e-9); ++k) {
    const double y = foot - panel.height * k * step_m / top_m;
    line(svg, "axis", {panel.x, y}, {panel.x + panel.width, y});
    words(svg, "soft", 24, y + 4, fmt::format("{:g} mm", 1e3 * k * step_m));
  }
  const double place = panel.width / static_cast<double>(misses.size());
  const double beside = std::min(2.0, place / 4);
  for (std::size_t k = 0; k < misses.size(); ++k) {
    const double x = panel.x + place * (static_cast<double>(k) + 0.5);
    const auto bar = [&](std::string_view kind, double at, double miss_m) {
      line(svg, kind, {at, foot}, {at, foot - panel.height * miss_m / top_m});
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
  View from_above(above, box, {0, 1});
  View from_side(side, box, {0, 2});
  from_above.scale = from_side.scale = std::min(from_above.scale, from_side.scale);
  const double magnified =
      round_below(std::max(1.0, kLargestArrow / (from_above.scale * largest_m)));
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" role=\"img\" aria-labelledby=\"t\">\n<title id=\"t\">{2}</title>\n"
      "<style>{3}</style>\n<rect class=\"paper\" width=\"{0:g}\" height=\"{1:g}\"/>\n",
      kWidth, kHeight, markup_text(title), kStyle);
  words(svg, "title", 24, 30, title);
  line(svg, "before", {24, 49}, {44, 49});
  words(svg, "", 52, 54, missed_in_words("As it is", *before));
  if (after) {
    line(svg, "after", {24, 71}, {44, 71});
    words(svg, "", 52, 76, missed_in_words("Corrected", *after));
  }
  const std::string how = fmt::format("misses {:g} times as long", magnified);
  words(svg, "soft", above.x, 100, "From above: x to the right, y up; " + how);
  words(svg, "soft", side.x, 100, "From the side: x to the right, z up; " + how);
  draw_view(svg, above, misses, from_above, magnified);
  draw_view(svg, side, misses, from_side, magnified);
  words(svg, "soft", bars.x, bars.y - 16, "Miss at each target, in the order of the program");
  draw_bars(svg, bars, misses, largest_m);
  return svg += "</svg>\n";
}

}  // namespace armsig::tool
