// SPDX-License-Identifier: MIT
// A picture for the eye: an SVG that stands alone, light and dark, and views of a frame in it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/pose.hpp"

namespace armsig::tool {

// The largest of 1, 2, 5 times a power of ten that is not above `value`.
[[nodiscard]] double round_below(double value);

struct Panel {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// A view of a frame along one of its axes: across and up are indices of coordinates. `margin` of
// the panel stays free.
class View {
 public:
  View(const Panel& panel, const Eigen::AlignedBox3d& box, std::array<Eigen::Index, 2> axes,
       double margin);

  [[nodiscard]] std::array<double, 2> at(const Vector3& p) const;

  double scale = 1;  // units of the picture a metre: the largest with which the box fits in

 private:
  Eigen::Index across_;
  Eigen::Index up_;
  Vector3 centre_;
  double middle_x_;
  double middle_y_;
};

// `kind` is a class of the style: title, soft, path, axis, before, after, target, reach, or none.
class SvgPicture {
 public:
  SvgPicture(double width, double height, std::string_view title);

  void line(std::string_view kind, std::array<double, 2> from, std::array<double, 2> to);
  // Through these points, open.
  void path(std::string_view kind, const std::vector<std::array<double, 2>>& points);
  void circle(std::string_view kind, std::array<double, 2> at, double radius);
  void words(std::string_view kind, double x, double y, std::string_view text);
  // A line of a round length, with the length that it stands for, below a panel.
  void scale_bar(const Panel& panel, const View& view);

  [[nodiscard]] std::string text() const { return svg_ + "</svg>\n"; }

 private:
  std::string svg_;
};

}  // namespace armsig::tool
