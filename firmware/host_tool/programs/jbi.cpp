// SPDX-License-Identifier: MIT
// Targets of Yaskawa's jobs (.jbi): positions C00000=x,y,z,Rx,Ry,Rz (mm, degrees) of the base, the
// robot or a user frame, with the number of their tool. Pulses are counts of the encoders.
#include <algorithm>
#include <string>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

class JbiReader {
 public:
  JbiReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(text)), lines_(text), frames_(frames) {}

  Program read() {
    std::size_t begin = 0;
    while (begin < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      const Bytes line = trimmed_bytes(text_, {begin, end});
      if (text_at(text_, line) == "//INST") break;
      take_line(line);
      begin = end + 1;
    }
    return std::move(program_);
  }

 private:
  void take_line(Bytes line) {
    const std::string_view text = text_at(text_, line);
    const std::size_t blank = std::min(text.find(' '), text.size());
    const std::string_view key = text.substr(0, blank);
    const std::string value(trimmed(text.substr(blank)));
    if (key == "///TOOL") tool_ = value;
    if (key == "///USER") user_ = value;
    if (key == "///POSTYPE") type_ = value;
    if (text.starts_with('C') || text.starts_with('P')) take_position(line);
    if (text.starts_with("BC") || text.starts_with("BP")) {
      leave(line.begin, name_at(line) + ": the robot stands on an axis of its own");
    }
  }

  [[nodiscard]] std::string name_at(Bytes line) const {
    ProgramScanner scanner(text_, line.begin);
    return std::string(scanner.word());
  }

  void take_position(Bytes line) {
    ProgramScanner scanner(std::string_view(text_).substr(0, line.end), line.begin);
    ProgramTarget target;
    target.name = scanner.word();
    target.line = lines_.line_of(line.begin);
    if (!scanner.accept('=')) return;
    if (type_ == "PULSE" || type_ == "ANGLE") {
      leave(line.begin,
            target.name + ": it has " + (type_ == "PULSE" ? "pulses" : "angles") + ", not a pose");
      return;
    }
    do {
      const auto number = scanner.number();
      if (!number) break;
      target.numbers.push_back(*number);
    } while (target.numbers.size() < 6 && scanner.accept(','));
    if (target.numbers.size() != 6) {
      leave(line.begin, target.name + ": it has not six numbers");
      return;
    }
    target.values = values_at(text_, target.numbers);
    if (place(target, line.begin)) program_.targets.push_back(std::move(target));
  }

  bool place(ProgramTarget& target, std::size_t at) {
    const Pose* const X_FT = frames_.tools.find(tool_);
    if (X_FT == nullptr) {
      leave(at, fmt::format("{}: tool {} is not here: --tool {}=...", target.name, tool_, tool_));
      return false;
    }
    target.X_FT = *X_FT;
    if (type_ == "BASE" || type_ == "ROBOT") return true;
    const Pose* const X_BW = type_ == "USER" ? frames_.frames.find(user_) : nullptr;
    if (X_BW == nullptr) {
      leave(at, type_ == "USER" ? fmt::format("{}: user frame {} is not here: --frame {}=...",
                                              target.name, user_, user_)
                                : fmt::format("{}: positions of type {} are not corrected",
                                              target.name, in_quotes(type_)));
      return false;
    }
    target.X_BW = *X_BW;
    return true;
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }

  std::string text_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  std::string tool_ = "0";
  std::string user_;
  std::string type_;
  Program program_;
};

}  // namespace

Program read_jbi(std::string_view text, const ProgramFrames& frames) {
  return JbiReader(text, frames).read();
}

}  // namespace armsig::tool
