// SPDX-License-Identifier: MIT
#include "firmware/formats/svg_picture.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {
namespace {

constexpr double kLeastExtent_m = 1e-2;

constexpr std::string_view kStyle =
    "text{font:14px system-ui,\"DejaVu Sans\",sans-serif;fill:#1f2328}.title{font-weight:600;"
    "font-size:16px}.soft{fill:#59636e;font-size:12px}.paper{fill:#fff}.path{fill:none;stroke:"
    "#818b98;stroke-width:1}.axis{stroke:#d1d9e0;stroke-width:1}.before{stroke:#bc4c00;"
    "stroke-width:2;stroke-linecap:round}.after{stroke:#0969da;stroke-width:2;stroke-linecap:round}"
    ".target{fill:#1f2328}.reach{fill:#d1d9e0}@media(prefers-color-scheme:dark){text{fill:#e6edf3}."
    "soft{fill:#9198a1}"
    ".paper{fill:#0d1117}.path{stroke:#7d8590}.axis{stroke:#30363d}.before{stroke:#f0883e}.after{"
    "stroke:#4493f8}.target{fill:#e6edf3}.reach{fill:#30363d}}";

}  // namespace

double round_below(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double digit = value / power;
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

View::View(const Panel& panel, const Eigen::AlignedBox3d& box, std::array<Eigen::Index, 2> axes,
           double margin)
    : across_(axes[0]),
      up_(axes[1]),
      centre_(box.center()),
      middle_x_(panel.x + panel.width / 2),
      middle_y_(panel.y + panel.height / 2) {
  const Vector3 size = box.sizes().cwiseMax(kLeastExtent_m);
  scale = std::min((panel.width - margin) / size[across_], (panel.height - margin) / size[up_]);
}

std::array<double, 2> View::at(const Vector3& p) const {
  const Vector3 off = scale * (p - centre_);
  return {middle_x_ + off[across_], middle_y_ - off[up_]};
}

SvgPicture::SvgPicture(double width, double height, std::string_view title)
    : svg_(fmt::format(
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
          "height=\"{1:g}\" role=\"img\" aria-labelledby=\"t\">\n<title id=\"t\">{2}</title>\n"
          "<style>{3}</style>\n<rect class=\"paper\" width=\"{0:g}\" height=\"{1:g}\"/>\n",
          width, height, markup_text(title), kStyle)) {
  words("title", 24, 30, title);
}

void SvgPicture::line(std::string_view kind, std::array<double, 2> from, std::array<double, 2> to) {
  path(kind, {from, to});
}

void SvgPicture::path(std::string_view kind, const std::vector<std::array<double, 2>>& points) {
  fmt::format_to(std::back_inserter(svg_), R"(<path class="{}" d=")", kind);
  for (std::size_t k = 0; k < points.size(); ++k) {
    fmt::format_to(std::back_inserter(svg_), "{}{:.1f} {:.1f}", k == 0 ? "M" : "L", points[k][0],
                   points[k][1]);
  }
  svg_ += "\"/>\n";
}

void SvgPicture::circle(std::string_view kind, std::array<double, 2> at, double radius) {
  fmt::format_to(std::back_inserter(svg_),
                 "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\"/>\n", kind, at[0],
                 at[1], radius);
}

void SvgPicture::words(std::string_view kind, double x, double y, std::string_view text) {
  fmt::format_to(std::back_inserter(svg_),
                 "<text class=\"{}\" x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", kind, x, y,
                 markup_text(text));
}

void SvgPicture::scale_bar(const Panel& panel, const View& view) {
  constexpr double kOfThePanel = 0.3;
  const double length_m = round_below(kOfThePanel * panel.width / view.scale);
  const double foot = panel.y + panel.height + 12;
  line("path", {panel.x, foot}, {panel.x + length_m * view.scale, foot});
  words("soft", panel.x, foot + 16, fmt::format("{:g} mm", 1e3 * length_m));
}

}  // namespace armsig::tool
