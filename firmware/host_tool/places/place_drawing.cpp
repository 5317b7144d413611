// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_drawing.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/svg_picture.hpp"

namespace armsig::tool {
namespace {

constexpr double kSheetWidth = 960;
constexpr double kSheetMargin = 60;
constexpr double kLine = 20;
constexpr double kColumn = 300;  // of the list of places
constexpr std::size_t kColumns = 3;
constexpr Panel kAbove{40, 80, 440, 400};
constexpr Panel kSide{520, 80, 400, 400};
constexpr double kListTop = kAbove.y + kAbove.height + 70;

void draw_places(SvgPicture& picture, const PlaceLayout& layout, const TouchSearch& search,
                 const Panel& panel, const View& view) {
  for (const TouchSearch::Stand& stand : search.stands()) {
    picture.circle("reach", view.at(stand.p_B), 1.5);
  }
  const auto base = view.at(Vector3::Zero());
  picture.circle("target", base, 5);
  picture.words("soft", base[0] + 8, base[1] + 16, "base");
  for (const SocketLength& bar : layout.task.lengths) {
    picture.line("after", view.at(layout.middle_B[bar.from]), view.at(layout.middle_B[bar.to]));
  }
  for (std::size_t k = 0; k < layout.middle_B.size(); ++k) {
    const auto at = view.at(layout.middle_B[k]);
    picture.circle("target", at, 4);
    picture.words("", at[0] + 6, at[1] - 6, layout.task.places[k].name);
  }
  picture.scale_bar(panel, view);
}

}  // namespace

std::string place_drawing(const PlaceLayout& layout, const TouchSearch& search,
                          std::string_view title) {
  Eigen::AlignedBox3d box;
  box.extend(Vector3::Zero());
  for (const TouchSearch::Stand& stand : search.stands()) box.extend(stand.p_B);
  for (const Vector3& middle_B : layout.middle_B) box.extend(middle_B);
  View above(kAbove, box, {0, 1}, kSheetMargin);
  View side(kSide, box, {0, 2}, kSheetMargin);
  above.scale = side.scale = std::min(above.scale, side.scale);
  const std::size_t lines = (layout.middle_B.size() + kColumns - 1) / kColumns;
  SvgPicture picture(kSheetWidth, kListTop + kLine * (static_cast<double>(lines) + 1), title);
  picture.words("soft", kAbove.x, 64,
                "From above: x to the right, y up; dots: reached by the tool");
  picture.words("soft", kSide.x, 64, "From the side: x to the right, z up");
  draw_places(picture, layout, search, kAbove, above);
  draw_places(picture, layout, search, kSide, side);
  picture.words("soft", kAbove.x, kListTop - kLine, "x, y, z in mm of the base frame");
  for (std::size_t k = 0; k < layout.middle_B.size(); ++k) {
    const Vector3 mm = 1e3 * layout.middle_B[k];
    const std::size_t column = k / lines;
    picture.words("", kAbove.x + kColumn * static_cast<double>(column),
                  kListTop + kLine * static_cast<double>(k % lines),
                  fmt::format("{}: {:.0f}, {:.0f}, {:.0f}", layout.task.places[k].name, mm.x(),
                              mm.y(), mm.z()));
  }
  return picture.text();
}

}  // namespace armsig::tool
