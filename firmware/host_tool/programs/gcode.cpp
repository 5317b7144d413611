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
constexpr std::array<double, 7> kNoPlace{10, 28, 30, 52, 53, 92, 92.3};

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
  };

  void take_line(Bytes bytes) {
    Line line;
    for (std::size_t at = bytes.begin; at < bytes.end; ++at) {
      const char letter = text_[at];
      if (letter == 'O' || letter == '#') return;  // flow of the program, and parameters
      if (letter < 'A' || letter > 'Z') continue;
      ProgramScanner scanner(std::string_view(text_).substr(0, bytes.end), at + 1);
      const std::size_t axis = kGcodeAxes.find(letter);
      const auto number = word_number(scanner);
      if (letter == 'G' && number) take_code(*number, line);
      if (axis == std::string_view::npos) continue;
      line.any_axis = true;
      line.computed = line.computed || !number;
      if (number) line.axes[axis] = *number;
      if (!number) break;
      at = number->end - 1;
    }
    if (line.any_axis) take_move(bytes, line);
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
    if (code == 33 || code == 38.2 || (code >= 73 && code <= 89)) motion_ = code;
    if (code == 20 || code == 21) inches_ = code == 20;
    if (code == 90 || code == 91) incremental_ = code == 91;
    line.no_place = line.no_place || std::ranges::find(kNoPlace, code) != kNoPlace.end();
  }

  void take_move(Bytes bytes, const Line& line) {
    const bool whole =
        std::ranges::all_of(line.axes, [](const auto& axis) { return axis.has_value(); });
    const char* why = nullptr;
    if (line.no_place) {
      why = "its code sets or goes by other coordinates";
    } else if (line.computed) {
      why = "it is computed";
    } else if (motion_ != 0 && motion_ != 1) {
      why = "it is no straight move";
    } else if (incremental_) {
      why = "it is relative (G91)";
    } else if (inches_) {
      why = "it is in inches (G20)";
    } else if (!whole) {
      why = "it has not all of X, Y, Z, A, B, C";
    }
    const Pose* const X_FT = frames_.tools.find("");
    const Pose* const X_BW = frames_.frames.find("");
    if (why == nullptr && X_FT == nullptr) why = kNoTool;
    if (why == nullptr && X_BW == nullptr) why = kNoFrame;
    if (why != nullptr) {
      program_.left.push_back({lines_.line_of(bytes.begin), std::string("move: ") + why});
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
  Program program_;
};

}  // namespace

Program read_gcode(std::string_view text, const ProgramFrames& frames) {
  return GcodeReader(text, frames).read();
}

}  // namespace armsig::tool
