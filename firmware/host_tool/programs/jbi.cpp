// SPDX-License-Identifier: MIT
// Targets of Yaskawa's jobs (.jbi): positions C00000=x,y,z,Rx,Ry,Rz (mm, degrees) of the base, the
// robot or a user frame, with the number of their tool. Pulses are counts of the encoders.
#include <algorithm>
#include <map>
#include <set>
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
    std::vector<Bytes> positions;
    bool instructions = false;
    for (std::size_t begin = 0; begin < text_.size();) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      const Bytes line = trimmed_bytes(text_, {begin, end});
      if (text_at(text_, line) == "//INST") instructions = true;
      if (instructions) {
        find_uses(line);
      } else {
        positions.push_back(line);
      }
      begin = end + 1;
    }
    for (const Bytes& line : positions) take_line(line);
    return std::move(program_);
  }

 private:
  // What instructions do with a position variable.
  struct Uses {
    bool gone_to = false;
    bool gone_by = false;  // IMOV
    bool other_group = false;
    int changed = 0;  // line
  };

  // The number of P001, LP001 or PX001; nothing of other words.
  static std::optional<int> variable_number(std::string_view word) {
    if (!word.starts_with('P')) return std::nullopt;
    word.remove_prefix(word.starts_with("PX") ? 2 : 1);
    return word.empty() ? std::nullopt : parse_integer(word);
  }

  // The place of "+MOVL", behind which another group moves; `end` where there is none.
  [[nodiscard]] std::size_t other_group_in(Bytes line) const {
    std::size_t at = line.begin;
    for (; at < line.end; ++at) {
      if (text_[at] != '+') continue;
      ProgramScanner scanner(std::string_view(text_).substr(0, line.end), at + 1);
      if (scanner.word().contains("MOV")) break;
    }
    return at;
  }

  void find_other_group(Bytes motion) {
    ProgramScanner scanner(std::string_view(text_).substr(0, motion.end), motion.begin);
    while (scanner.next_word()) {
      const std::string_view word = scanner.word();
      const auto number = word.starts_with('C') ? parse_integer(word.substr(1)) : std::nullopt;
      if (number) steps_of_others_.insert(*number);
      if (const auto variable = variable_number(word)) uses_[*variable].other_group = true;
    }
  }

  void find_uses(Bytes line) {
    const std::string_view text = text_at(text_, line);
    if (text.starts_with('\'') || text.starts_with('/')) return;
    std::size_t end = line.begin + std::min(text.find("//"), text.size());
    const std::size_t other = other_group_in({line.begin, end});
    find_other_group({other, end});
    end = other;
    ProgramScanner scanner(std::string_view(text_).substr(0, end), line.begin);
    const std::string_view instruction = scanner.word();
    const std::size_t first = trimmed_bytes(text_, {scanner.at(), end}).begin;
    const int number_of_line = lines_.line_of(line.begin);
    if (instruction == "SFTON") {
      program_.left.push_back(
          {number_of_line, "SFTON: it moves targets; they are corrected for where they are written",
           true});
    }
    const bool by = instruction.contains("IMOV");
    const bool to = !by && instruction.contains("MOV");
    scanner.go_to(first);
    for (bool more = !scanner.at_end(); more; more = scanner.next_word()) {
      const std::size_t at = scanner.at();
      const auto number = variable_number(scanner.word());
      if (!number) continue;
      Uses& uses = uses_[*number];
      uses.gone_to = uses.gone_to || to;
      uses.gone_by = uses.gone_by || by;
      if (!to && !by && at == first) uses.changed = number_of_line;
    }
  }

  // Why a position variable is no target as it is written; empty where it is one.
  [[nodiscard]] std::string no_target(std::string_view name) const {
    constexpr const char* kOther = "another group of the job moves to it";
    const auto number = variable_number(name);
    if (!number) {
      const auto step = parse_integer(name.substr(1));
      return step && steps_of_others_.contains(*step) ? kOther : "";
    }
    const auto found = uses_.find(*number);
    if (found == uses_.end()) return "no motion of this job goes to it";
    const Uses& uses = found->second;
    if (uses.other_group) return kOther;
    if (uses.gone_by) return "a motion goes by it, not to it (IMOV)";
    if (uses.changed > 0) return fmt::format("line {} gives it another value", uses.changed);
    return uses.gone_to ? "" : "no motion of this job goes to it";
  }

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
    if (type_.empty()) {
      leave(line.begin, target.name + ": the job does not say its ///POSTYPE");
      return;
    }
    if (type_ == "PULSE" || type_ == "ANGLE") {
      leave(line.begin,
            target.name + ": it has " + (type_ == "PULSE" ? "pulses" : "angles") + ", not a pose");
      return;
    }
    if (const std::string why = no_target(target.name); !why.empty()) {
      leave(line.begin, target.name + ": " + why);
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
  std::map<int, Uses> uses_;
  std::set<int> steps_of_others_;  // C... that another group moves to
  Program program_;
};

}  // namespace

Program read_jbi(std::string_view text, const ProgramFrames& frames) {
  return JbiReader(text, frames).read();
}

}  // namespace armsig::tool
