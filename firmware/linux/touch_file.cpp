// SPDX-License-Identifier: MIT
#include "firmware/linux/touch_file.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/touches.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::daemon {
namespace {

using tool::Touch;
template <typename T>
using Touched = std::expected<T, TouchRefusal>;

std::unexpected<TouchRefusal> refused(Error error, std::string why) {
  std::ranges::replace(why, '"', '\'');
  std::ranges::replace(why, '\n', ' ');
  return std::unexpected(TouchRefusal{error, std::move(why)});
}

std::unexpected<TouchRefusal> refused(const tool::Problem& problem) {
  return refused(Error::kStorageFault, tool::render(problem));
}

// Of which every place is one: a wire has a length in every row, which no joint reads.
const tool::InstrumentDescription& sockets() {
  static const tool::InstrumentDescription description{
      .name = {}, .instruments = {tool::Instrument{}}, .place_instruments = {}, .lengths = {}};
  return description;
}

struct Kept {
  std::string text;  // of the file, with its header, to the end of a line
  std::vector<Touch> touches;
};

// Whether touches are few enough, at places that a reply can name.
Touched<void> check_touches(const std::string& path, const std::vector<Touch>& touches) {
  if (touches.size() > kMostTouches) {
    return refused(Error::kCapacityExceeded,
                   fmt::format("{}: {} touches, at most {}", path, touches.size(), kMostTouches));
  }
  std::vector<std::string_view> places;
  for (const Touch& touch : touches) {
    if (!is_place_name(touch.place)) {
      return refused(Error::kOutOfRange, fmt::format("{}: line {}: the name of a place needs {}",
                                                     path, touch.line, kPlaceExpected));
    }
    if (std::ranges::find(places, touch.place) == places.end()) places.emplace_back(touch.place);
  }
  if (places.size() <= kMostPlaces) return {};
  return refused(Error::kCapacityExceeded,
                 fmt::format("{}: {} places, at most {}", path, places.size(), kMostPlaces));
}

Touched<Kept> read_kept(const std::string& path, const JointTypes& types) {
  const std::string header = fmt::format("place,{}\n", tool::joint_header(types));
  std::error_code failed;
  const auto there = std::filesystem::status(path, failed);
  if (there.type() == std::filesystem::file_type::not_found) return Kept{header, {}};
  if (!std::filesystem::is_regular_file(there)) {
    return refused(Error::kStorageFault, path + ": no file that can be read");
  }
  auto text = tool::read_text_file(path);
  if (!text) return refused(text.error());
  if (!text->empty() && text->back() != '\n') *text += '\n';
  if (!text->empty() && !text->starts_with(header)) {
    return refused(Error::kStorageFault,
                   fmt::format("{}: its first line is not {}", path,
                               std::string_view(header).substr(0, header.size() - 1)));
  }
  if (text->size() <= header.size()) return Kept{header, {}};
  auto touches = tool::parse_touches(*text, path, types, sockets());
  if (!touches) return refused(touches.error());
  if (auto good = check_touches(path, *touches); !good) return std::unexpected(good.error());
  return Kept{std::move(*text), std::move(*touches)};
}

// Nothing where there is no plan.
Touched<std::vector<Touch>> read_plan(const std::string& path, const JointTypes& types) {
  if (path.empty()) return std::vector<Touch>();
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) {
    return refused(Error::kStorageFault, path + ": no file that can be read");
  }
  auto plan = tool::read_touches(path, types, sockets());
  if (!plan) return refused(plan.error());
  if (auto good = check_touches(path, *plan); !good) return std::unexpected(good.error());
  return std::move(*plan);
}

std::size_t count_at(const std::vector<Touch>& touches, std::string_view place) {
  return static_cast<std::size_t>(std::ranges::count(touches, place, &Touch::place));
}

// ` left=67 next=B2`, of a plan whose rows at one place are made in their order.
std::string left_of(const std::vector<Touch>& plan, const std::vector<Touch>& made) {
  std::size_t left = 0;
  std::string_view next;
  std::vector<std::string_view> planned;
  for (const Touch& touch : plan) {
    planned.emplace_back(touch.place);
    const auto here = static_cast<std::size_t>(std::ranges::count(planned, touch.place));
    if (here <= count_at(made, touch.place)) continue;
    ++left;
    if (next.empty()) next = touch.place;
  }
  if (plan.empty()) return {};
  return left == 0 ? " left=0" : fmt::format(" left={} next={}", left, next);
}

std::string row_of(std::string_view place, const JointVector& readings, const JointTypes& types) {
  std::string row(place);
  for (std::size_t i = 0; i < types.size(); ++i) {
    const tool::Unit unit = tool::unit_of(types[i]);
    fmt::format_to(std::back_inserter(row), ",{:.5f}", readings[i] * unit.divide / unit.multiply);
  }
  return row + "\n";
}

// The first `lines` lines of `text`.
std::string first_lines(const std::string& text, std::size_t lines) {
  std::size_t end = 0;
  for (std::size_t line = 0; line < lines; ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

}  // namespace

Told TouchFile::add(std::string_view place, const JointVector& readings) const {
  if (!is_place_name(place)) {
    return refused(Error::kOutOfRange, fmt::format("place needs {}", kPlaceExpected));
  }
  ARMSIG_TRY(plan, read_plan(files_.plan, types_));
  if (!plan.empty() && count_at(plan, place) == 0) {
    return refused(Error::kOutOfRange, fmt::format("{} is no place of {}", place, files_.plan));
  }
  ARMSIG_TRY(kept, read_kept(files_.file, types_));
  kept.touches.push_back({.place = std::string(place), .q = readings});
  if (auto good = check_touches(files_.file, kept.touches); !good) {
    return std::unexpected(good.error());
  }
  const auto written =
      tool::write_text_file(files_.file, kept.text + row_of(place, readings, types_));
  if (!written) return refused(written.error());
  return fmt::format(" place={} at_place={} touches={}{}", place, count_at(kept.touches, place),
                     kept.touches.size(), left_of(plan, kept.touches));
}

Told TouchFile::drop() const {
  ARMSIG_TRY(plan, read_plan(files_.plan, types_));
  ARMSIG_TRY(kept, read_kept(files_.file, types_));
  if (kept.touches.empty()) return refused(Error::kWrongMode, "there is no touch to drop");
  const Touch last = std::move(kept.touches.back());
  kept.touches.pop_back();
  // With the last touch go remarks of a person behind it, and of a file without any all remarks.
  const std::size_t lines = kept.touches.empty() ? 1 : last.line - 1;
  const auto written = tool::write_text_file(files_.file, first_lines(kept.text, lines));
  if (!written) return refused(written.error());
  return fmt::format(" place={} at_place={} touches={}{}", last.place,
                     count_at(kept.touches, last.place), kept.touches.size(),
                     left_of(plan, kept.touches));
}

Told TouchFile::tell() const {
  ARMSIG_TRY(plan, read_plan(files_.plan, types_));
  ARMSIG_TRY(kept, read_kept(files_.file, types_));
  std::vector<std::string_view> places;
  std::string by_place;
  for (const std::vector<Touch>* touches : {&plan, &kept.touches}) {
    for (const Touch& touch : *touches) {
      if (std::ranges::find(places, touch.place) != places.end()) continue;
      places.emplace_back(touch.place);
      by_place += fmt::format("{}{}:{}", by_place.empty() ? " places=" : ",", touch.place,
                              count_at(kept.touches, touch.place));
      if (!plan.empty()) by_place += fmt::format("/{}", count_at(plan, touch.place));
    }
  }
  return fmt::format(" touches={}{}{}", kept.touches.size(), left_of(plan, kept.touches), by_place);
}

}  // namespace armsig::daemon
