// SPDX-License-Identifier: MIT
#include <array>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/foreign_mapping.hpp"
#include "firmware/formats/table_numbers.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/joining/logs.hpp"

namespace armsig::tool {
namespace {

// Hours of a controller's log, a tracker's stream of half an hour.
constexpr ForeignTable::Bounds kBounds{.bytes = std::size_t{64} << 20U, .rows = 1'000'000};

// One table whose rows are read by quantity.
class LogReader {
 public:
  static Read<LogReader> open(const std::string& path, const TableNeed& need) {
    ARMSIG_TRY(table, ForeignTable::open(path, kBounds));
    if (auto text = table.check_text(); !text) return std::unexpected(std::move(text).error());
    ARMSIG_TRY(layout, layout_of(table, need));
    return LogReader(std::move(table), std::move(layout));
  }

  // Moves to the next row; false at the end of the table.
  Read<bool> next() {
    const std::size_t from = begun_ ? row_ + 1 : layout_.first_row;
    begun_ = true;
    row_ = table_.row_from(from);
    if (row_ >= table_.size()) return false;
    ARMSIG_TRY(cells, row_cells(table_, layout_, row_));
    cells_ = std::move(cells);
    return true;
  }

  [[nodiscard]] std::size_t line() const { return table_.line(row_).number; }
  [[nodiscard]] const TableLayout& layout() const { return layout_; }

  // Empty where there is no such column.
  [[nodiscard]] std::string_view text(std::string_view quantity) const {
    const MappedColumn* column = layout_.find(quantity);
    if (column == nullptr) return {};
    if (!column->place) return std::string_view(column->theirs).substr(1);
    return cells_[*column->place];
  }

  // In SI; nothing where the column is absent or, if it `may_be_empty`, the cell is empty.
  Read<std::optional<double>> number(std::string_view quantity, bool may_be_empty = false) {
    const MappedColumn* column = layout_.find(quantity);
    if (column == nullptr) return std::nullopt;
    const std::string_view cell = text(quantity);
    if (cell.empty() && may_be_empty) return std::nullopt;
    ARMSIG_TRY(spelt, in_file(table_.file(), numbers_.plain(cell, column->theirs, line())));
    const auto value = parse_number(spelt);
    if (!value) {
      return table_.at(row_, fmt::format("{}: {}", column->theirs, why_not_a_number(spelt)),
                       "a number");
    }
    return unit_of_column(*column).to_si(*value);
  }

  // The name in its group and collection.
  [[nodiscard]] std::string name() const {
    std::string whole;
    for (const char* part : {"collection", "group", "name"}) {
      const std::string_view piece = text(part);
      if (piece.empty()) continue;
      if (!whole.empty()) whole += "::";
      whole += piece;
    }
    return whole;
  }

  // A time that nobody asks for may be anything: what it means is found out by who does.
  LoggedTime time() {
    LoggedTime time{.text = std::string(text("time")), .seconds = {}, .has_unit = false};
    const MappedColumn* column = layout_.find("time");
    if (column == nullptr) return time;
    time.has_unit = column->ours != "time";
    if (const std::string_view date = text("date"); !date.empty()) {
      time.text = fmt::format("{} {}", date, time.text);
    }
    const auto spelt = times_.plain(time.text, column->theirs, line());
    const auto number = spelt ? parse_number(*spelt) : std::nullopt;
    if (number) time.seconds = unit_of_column(*column).to_si(*number);
    return time;
  }

  // The number of a reflector; nothing where none is told. Beside a name it must be a number.
  [[nodiscard]] Read<std::optional<int>> target() const {
    const std::string_view cell = text("target");
    const auto number = parse_integer(cell);
    if (number || cell.empty() || layout_.find("name") == nullptr) return number;
    return table_.at(row_, fmt::format("target {} is no number", in_quotes(cell)),
                     "the number of a reflector");
  }

  // After the last row. `expected`: what stands in each.
  Read<void> finish(bool any, const char* expected) {
    if (!any) {
      const std::size_t last = table_.size() - 1;
      return table_.at(last, "no rows below the header", expected);
    }
    return in_file(table_.file(), numbers_.finish());
  }

 private:
  LogReader(ForeignTable table, TableLayout layout)
      : table_(std::move(table)),
        layout_(std::move(layout)),
        numbers_(layout_.separator),
        times_(layout_.separator) {}

  static Unit unit_of_column(const MappedColumn& column) {
    const std::size_t underscore = column.ours.find('_');
    if (underscore == std::string::npos) return {};
    const std::string_view suffix = std::string_view(column.ours).substr(underscore + 1);
    for (const Unit& unit : kMicroAndNano) {
      if (unit.suffix == suffix) return unit;
    }
    for (const Dimension dimension :
         {Dimension::kAngle, Dimension::kLength, Dimension::kTemperature, Dimension::kTime}) {
      for (const Unit& unit : units_of(dimension)) {
        if (unit.suffix == suffix) return unit;
      }
    }
    return {};
  }

  // Of times only: no file of ours has them.
  static constexpr std::array<Unit, 2> kMicroAndNano{{{"us", 1, 1e6}, {"ns", 1, 1e9}}};

  ForeignTable table_;
  TableLayout layout_;
  TableNumbers numbers_;
  TableNumbers times_;  // whose decimal sign may be another
  std::size_t row_ = 0;
  bool begun_ = false;
  std::vector<std::string> cells_;
};

Read<LoggedPose> logged_pose(LogReader& reader, std::size_t joints) {
  LoggedPose pose{
      .line = reader.line(), .name = reader.name(), .time = reader.time(), .target = {}, .q = {}};
  ARMSIG_TRY(target, reader.target());
  pose.target = target;
  // A target that is no number is the name of the point.
  if (!target && pose.name.empty()) pose.name = reader.text("target");
  for (std::size_t j = 1; j <= joints; ++j) {
    ARMSIG_TRY(reading, reader.number(fmt::format("q{}", j)));
    pose.q.push_back(reading.value_or(0));
  }
  return pose;
}

Read<TrackedPoint> tracked_point(LogReader& reader) {
  TrackedPoint point{.line = reader.line(),
                     .name = reader.name(),
                     .time = reader.time(),
                     .target = {},
                     .air_c = {},
                     .sigma_m = {}};
  if (reader.layout().find("name") == nullptr) {
    // Where points have no other name, the target is what they are called.
    const std::string_view target = reader.text("target");
    if (!point.name.empty() && !target.empty()) point.name += "::";
    point.name += target;
  } else {
    ARMSIG_TRY(number, reader.target());
    point.target = number;
  }
  constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    ARMSIG_TRY(coordinate, reader.number(kAxes[i]));
    point.p_S[static_cast<Eigen::Index>(i)] = coordinate.value_or(0);
  }
  ARMSIG_TRY(air, reader.number("air", true));
  ARMSIG_TRY(sigma, reader.number("sigma", true));
  point.air_c = air;
  point.sigma_m = sigma;
  return point;
}

// A mapping by hand that leaves out what each row needs.
Read<void> check_columns(const TableLayout& layout, std::string_view option,
                         std::span<const std::string> quantities) {
  for (const std::string& quantity : quantities) {
    if (layout.find(quantity) != nullptr) continue;
    return std::unexpected(Problem{std::string(option), 0, 0, "no column for " + quantity,
                                   fmt::format("auto, or {}_UNIT=THEIR NAME too", quantity)});
  }
  return {};
}

}  // namespace

Read<JointLog> read_joint_log(const std::string& path, const NamedJoints& joints,
                              const StatedUnits& units, std::string_view columns) {
  constexpr std::string_view kOption = "--joint-columns";
  ARMSIG_TRY(wanted, wanted_of(kOption, columns));
  ARMSIG_TRY(reader,
             LogReader::open(path, {TableKind::kJointLog, joints, std::move(wanted), units}));
  std::vector<std::string> needed;
  for (std::size_t j = 1; j <= joints.types.size(); ++j) needed.push_back(fmt::format("q{}", j));
  if (auto all = check_columns(reader.layout(), kOption, needed); !all) {
    return std::unexpected(std::move(all).error());
  }
  JointLog log{.file = path, .poses = {}, .unused = words_of_unused(reader.layout())};
  for (;;) {
    ARMSIG_TRY(more, reader.next());
    if (!more) break;
    ARMSIG_TRY(pose, logged_pose(reader, joints.types.size()));
    log.poses.push_back(std::move(pose));
  }
  if (auto end =
          reader.finish(!log.poses.empty(), "a row for each pose, with the joints' readings");
      !end) {
    return std::unexpected(std::move(end).error());
  }
  return log;
}

Read<TrackedPoints> read_tracked_points(const std::string& path, const StatedUnits& units,
                                        std::string_view columns) {
  constexpr std::string_view kOption = "--point-columns";
  ARMSIG_TRY(wanted, wanted_of(kOption, columns));
  ARMSIG_TRY(reader, LogReader::open(path, {TableKind::kPoints, {}, std::move(wanted), units}));
  const std::vector<std::string> needed{"x", "y", "z"};
  if (auto all = check_columns(reader.layout(), kOption, needed); !all) {
    return std::unexpected(std::move(all).error());
  }
  TrackedPoints tracked{.file = path, .points = {}, .unused = words_of_unused(reader.layout())};
  for (;;) {
    ARMSIG_TRY(more, reader.next());
    if (!more) break;
    ARMSIG_TRY(point, tracked_point(reader));
    tracked.points.push_back(std::move(point));
  }
  if (auto end = reader.finish(!tracked.points.empty(), "a row for each point, with its position");
      !end) {
    return std::unexpected(std::move(end).error());
  }
  return tracked;
}

}  // namespace armsig::tool
