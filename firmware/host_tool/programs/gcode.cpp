// SPDX-License-Identifier: MIT
// Targets of LinuxCNC's G-code: straight moves (G0, G1) in millimetres with all of X, Y, Z and the
// fixed-axis angles A, B, C in degrees, as armsigkins and genserkins have them.
#include <algorithm>
#include <array>
#include <string>

#include <fmt/core.h>

#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kGcodeAxes = "XYZABC";
// Codes that make of the axes of their line something else than a place to go to.
constexpr std::array<double, 9> kNoPlace{10, 28, 28.1, 30, 30.1, 52, 53, 92, 92.3};
// Those that go on: the moves behind them are in coordinates that the program moves.
constexpr std::array<double, 4> kMovedOrigin{10, 52, 92, 92.3};

class GcodeReader {
 public:
  GcodeReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_comments(
            text, {.to_end_of_line = ';', .double_quotes = false, .parentheses = true}))),
        lines_(text),
        frames_(frames) {}

  Program read() {
    std::size_t begin = 0;
    while (begin < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      take_line({begin, end});
      begin = end + 1;
    }
    return std::move(program_);
  }

 private:
  struct Line {
    std::array<std::optional<Bytes>, 6> axes;
    bool any_axis = false;
    bool computed = false;  // an axis has an expression or a parameter
    bool no_place = false;
    bool moves_origin = false;
  };

  void take_line(Bytes bytes) {
    Line line;
    for (std::size_t at = bytes.begin; at < bytes.end; ++at) {
      const char letter = text_[at];
      if (letter == 'O' || letter == '#') break;  // flow of the program, and parameters
      if (letter < 'A' || letter > 'Z') continue;
      ProgramScanner scanner(std::string_view(text_).substr(0, bytes.end), at + 1);
      const std::size_t axis = kGcodeAxes.find(letter);
      const auto number = word_number(scanner);
      if (letter == 'G' && number) take_code(*number, line);
      if (letter == 'M' && number) take_function(*number);
      if (letter == 'L' && number) take_table(*number, line);
      if (axis != std::string_view::npos) {
        line.any_axis = true;
        line.computed = line.computed || !number;
        if (number) line.axes[axis] = *number;
      }
      if (number) at = number->end - 1;
      if (!number) at = end_of_expression(at + 1, bytes.end) - 1;
    }
    if (line.any_axis) {
      take_move(bytes, line);
    } else if (line.no_place) {
      moved_origin_ = line.moves_origin ? lines_.line_of(bytes.begin) : moved_origin_;
    }
  }

  // Behind "#<NAME>", "#12", "[1 + #2]" or "-[...]"; at least `at`.
  [[nodiscard]] std::size_t end_of_expression(std::size_t at, std::size_t end) const {
    int depth = 0;
    std::size_t behind = at;
    for (; behind < end; ++behind) {
      const char c = text_[behind];
      if (c == '[' || c == '<') ++depth;
      if (c == ']' || c == '>') --depth;
      const bool goes_on = depth > 0 || std::string_view(" \t-+#]>.0123456789").contains(c);
      if (!goes_on) break;
    }
    return behind;
  }

  // Digits alone: the next word may follow at once, as in X1.5Y2.
  std::optional<Bytes> word_number(ProgramScanner& scanner) const {
    scanner.skip_blanks();
    const std::size_t begin = scanner.at();
    std::size_t end = begin;
    while (end < text_.size() && std::string_view("+-.0123456789").contains(text_[end])) ++end;
    ProgramScanner alone(std::string_view(text_).substr(0, end), begin);
    const auto number = alone.number();
    return number && number->end == end ? number : std::nullopt;
  }

  void take_code(Bytes number, Line& line) {
    const double code = values_at(text_, {number})[0];
    if (code >= 0 && code <= 3) motion_ = code;
    // Splines, threads, probing, cycles; not the planes between.
    const bool other = (code >= 5 && code < 7) || (code >= 33 && code < 39) || code == 76 ||
                       (code >= 73 && code <= 89);
    if (other) motion_ = code;
    if (code >= 54 && code < 60) system_ = code;
    if (code == 92.1 || code == 92.2) moved_origin_ = 0;
    if (code == 20 || code == 21) inches_ = code == 20;
    if (code == 90 || code == 91) incremental_ = code == 91;
    line.no_place = line.no_place || std::ranges::find(kNoPlace, code) != kNoPlace.end();
    line.moves_origin =
        line.moves_origin || std::ranges::find(kMovedOrigin, code) != kMovedOrigin.end();
  }

  // G10 L1, L10 and L11 set tools, no coordinates.
  void take_table(Bytes number, Line& line) const {
    const double table = values_at(text_, {number})[0];
    if (table == 1 || table == 10 || table == 11) line.moves_origin = false;
  }

  // LinuxCNC's switch of kinematics: M428 is the first one; with the others axes may be joints.
  void take_function(Bytes number) {
    const double code = values_at(text_, {number})[0];
    if (code >= 428 && code <= 430) other_kinematics_ = code != 428;
  }

  // Why a move is no target; empty where it is one.
  [[nodiscard]] std::string no_target(const Line& line) const {
    const bool whole =
        std::ranges::all_of(line.axes, [](const auto& axis) { return axis.has_value(); });
    if (line.no_place) return "its code sets or goes by other coordinates";
    if (line.computed) return "it is computed";
    if (motion_ != 0 && motion_ != 1) return "it is no straight move";
    if (incremental_) return "it is relative (G91)";
    if (inches_) return "it is in inches (G20)";
    if (!whole) return "it has not all of X, Y, Z, A, B, C";
    if (other_kinematics_) return "the kinematics are switched there (M429, M430)";
    if (moved_origin_ > 0) return fmt::format("line {} moves the origin", moved_origin_);
    return {};
  }

  void take_move(Bytes bytes, const Line& line) {
    const Pose* const X_FT = frames_.tools.find("");
    const Pose* const X_BW = frames_.frames.find(fmt::format("G{}", system_));
    std::string why = no_target(line);
    if (why.empty() && X_FT == nullptr) why = kNoTool;
    if (why.empty() && X_BW == nullptr) why = kNoFrame;
    if (line.moves_origin) moved_origin_ = lines_.line_of(bytes.begin);
    if (!why.empty()) {
      program_.left.push_back({lines_.line_of(bytes.begin), "move: " + why});
      return;
    }
    ProgramTarget target;
    target.line = lines_.line_of(bytes.begin);
    target.name = "move";
    target.linear = motion_ == 1;
    for (const auto& axis : line.axes) target.numbers.push_back(*axis);
    target.values = values_at(text_, target.numbers);
    target.X_FT = *X_FT;
    target.X_BW = *X_BW;
    program_.targets.push_back(std::move(target));
  }

  std::string text_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  double motion_ = -1;
  bool inches_ = false;
  bool incremental_ = false;
  bool other_kinematics_ = false;
  double system_ = 54;    // of coordinates, G54 to G59.3
  int moved_origin_ = 0;  // line
  Program program_;
};

}  // namespace

Program read_gcode(std::string_view text, const ProgramFrames& frames) {
  return GcodeReader(text, frames).read();
}

}  // namespace armsig::tool
