// SPDX-License-Identifier: MIT
// Targets of KRL: poses {X, Y, Z, A, B, C, S, T} and readings {A1 ... A6} in motions of a .src, and
// those that a .dat declares, whose tool and base its FDAT of the same name has.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 7> kKrlMotions{"PTP",  "LIN",   "CIRC", "SPTP",
                                                      "SLIN", "SCIRC", "SPL"};
constexpr std::array<std::string_view, 6> kPoseNames{"X", "Y", "Z", "A", "B", "C"};
constexpr std::array<std::string_view, 6> kAxisNames{"A1", "A2", "A3", "A4", "A5", "A6"};

// {NAME number, ...}; what is no number is not among them.
struct Aggregate {
  std::size_t at = 0;
  std::size_t end = 0;
  std::map<std::string, Bytes> numbers;

  [[nodiscard]] std::optional<std::vector<Bytes>> all(
      std::span<const std::string_view> names) const {
    std::vector<Bytes> found;
    for (const std::string_view name : names) {
      const auto number = numbers.find(std::string(name));
      if (number == numbers.end()) return std::nullopt;
      found.push_back(number->second);
    }
    return found;
  }
};

// `at`: of the brace. It ends with its line at the latest.
Aggregate aggregate_at(std::string_view text, std::size_t at) {
  Aggregate aggregate{at, std::min(text.find_first_of("}\n", at), text.size()), {}};
  ProgramScanner scanner(text.substr(0, aggregate.end), at + 1);
  std::string name(scanner.word());
  if (scanner.accept(':')) name = scanner.word();
  while (!name.empty()) {
    // Without a blank before it another number could run into the name.
    const auto number = scanner.number();
    if (number && !is_word(text[number->begin - 1])) aggregate.numbers[name] = *number;
    const std::size_t comma = text.substr(0, aggregate.end).find(',', scanner.at());
    if (comma == std::string_view::npos) break;
    scanner.go_to(comma + 1);
    name = scanner.word();
  }
  return aggregate;
}

class KrlReader {
 public:
  KrlReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_comments(text, {.to_end_of_line = ';'}))),
        original_(text),
        lines_(text),
        frames_(frames) {}

  Program read() {
    find_declarations();
    bool any_motion = false;
    std::size_t begin = 0;
    while (begin < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      any_motion = take_line({begin, end}) || any_motion;
      begin = end + 1;
    }
    if (!any_motion) take_declared();
    return std::move(program_);
  }

 private:
  struct Declared {
    Aggregate value;
    std::string name;  // as written
    bool used = false;
    std::optional<Pose> X_FT, X_BW;
  };
  struct Frame {
    std::optional<Pose> X;
    std::string why_not;
  };

  // The name before an assignment to the brace at `at`: "XP1" or "TOOL_DATA[1]"; else empty.
  [[nodiscard]] Bytes name_before(std::size_t at) const {
    Bytes before = trimmed_bytes(text_, {text_.rfind('\n', at) + 1, at});
    if (before.end == before.begin || text_[before.end - 1] != '=') return {at, at};
    before = trimmed_bytes(text_, {before.begin, before.end - 1});
    std::size_t begin = before.end;
    while (begin > before.begin &&
           (is_word(text_[begin - 1]) || text_[begin - 1] == '[' || text_[begin - 1] == ']')) {
      --begin;
    }
    return {begin, before.end};
  }

  void find_declarations() {
    for (std::size_t at = text_.find('{'); at != std::string::npos; at = text_.find('{', at + 1)) {
      const Bytes name = name_before(at);
      if (name.begin == name.end) continue;
      const std::string key(text_at(text_, name));
      const bool again = declared_.contains(key);
      declared_[key] = {
          aggregate_at(text_, at), std::string(text_at(original_, name)), false, {}, {}};
      (again ? changed_ : order_).push_back(key);
    }
  }

  // A motion in the line? Frames that the line sets are set.
  bool take_line(Bytes line) {
    const std::string_view upto = std::string_view(text_).substr(0, line.end);
    ProgramScanner scanner(upto, line.begin);
    const std::string word(scanner.word());
    if (word == "$TOOL" || word == "$BASE") {
      if (scanner.accept('=')) set_frame(word, scanner);
      return false;
    }
    if (word == "FDAT_ACT" && scanner.accept('=')) {
      const auto fdat = declared_.find(std::string(scanner.word()));
      set_by_numbers(fdat == declared_.end() ? nullptr : &fdat->second.value);
      return false;
    }
    if (word == "BAS" && scanner.accept('(') && scanner.accept('#')) {
      const std::string_view what = scanner.word();
      if ((what == "TOOL" || what == "BASE") && scanner.accept(',')) {
        set_numbered("$" + std::string(what), scanner.number());
      }
      return false;
    }
    if (word.ends_with("_REL")) {
      leave(line.begin, std::string(trimmed(text_at(original_, line))) + ": it is relative");
      return true;
    }
    if (std::ranges::find(kKrlMotions, word) == kKrlMotions.end()) return false;
    const bool linear = word != "PTP" && word != "SPTP";
    const std::size_t count = word.ends_with("CIRC") ? 2 : 1;
    const auto arguments = arguments_from(upto, scanner.at(), '\n');
    for (std::size_t k = 0; k < count && k < arguments.size(); ++k) {
      take_argument(arguments[k], linear);
    }
    return true;
  }

  void set_frame(const std::string& which, ProgramScanner& scanner) {
    Frame& frame = which == "$TOOL" ? tool_ : base_;
    scanner.skip_blanks();
    if (scanner.peek() == '{') {
      frame = frame_in(aggregate_at(text_, scanner.at()), which);
      return;
    }
    const std::string_view word = scanner.word();
    if (word == "$NULLFRAME") {
      frame = {Pose{}, ""};
    } else if ((word == "TOOL_DATA" || word == "BASE_DATA") && scanner.accept('[')) {
      set_numbered(which, scanner.number());
    } else {
      frame = {std::nullopt, which + " is computed"};
    }
  }

  [[nodiscard]] Frame frame_in(const Aggregate& aggregate, const std::string& which) const {
    const auto numbers = aggregate.all(kPoseNames);
    if (!numbers) return {std::nullopt, which + " is not written with all of X to C"};
    return {pose_of(values_at(text_, *numbers), kKrlWriting), ""};
  }

  // TOOL_DATA[n] or BASE_DATA[n]: of this text, 0, or given.
  void set_numbered(const std::string& which, std::optional<Bytes> number) {
    const bool tool = which == "$TOOL";
    Frame& frame = tool ? tool_ : base_;
    const std::string n(number ? text_at(text_, *number) : std::string_view("?"));
    const std::string data = (tool ? "TOOL_DATA[" : "BASE_DATA[") + n + "]";
    const auto declared = declared_.find(data);
    const Pose* const given = (tool ? frames_.tools : frames_.frames).find(n);
    if (declared != declared_.end()) {
      frame = frame_in(declared->second.value, data);
    } else if (n == "0") {
      frame = {Pose{}, ""};
    } else if (given != nullptr) {
      frame = {*given, ""};
    } else {
      frame = {std::nullopt,
               fmt::format("{} is not here: {} {}=...", data, tool ? "--tool" : "--frame", n)};
    }
  }

  void set_by_numbers(const Aggregate* fdat) {
    const auto set = [&](const char* which, const char* key, Frame& frame) {
      frame = {};
      if (fdat != nullptr && fdat->numbers.contains(key)) {
        set_numbered(which, fdat->numbers.at(key));
      }
    };
    set("$TOOL", "TOOL_NO", tool_);
    set("$BASE", "BASE_NO", base_);
  }

  void take_argument(Bytes argument, bool linear) {
    if (argument.begin < argument.end && text_[argument.begin] == '{') {
      const Aggregate aggregate = aggregate_at(text_, argument.begin);
      add("target", aggregate, linear);
      return;
    }
    ProgramScanner scanner(std::string_view(text_).substr(0, argument.end), argument.begin);
    const std::string key(scanner.word());
    scanner.skip_blanks();
    const bool alone = !std::string_view(":.[+-*/").contains(scanner.peek()) || scanner.at_end();
    const std::string name(text_at(original_, {argument.begin, argument.begin + key.size()}));
    const auto declared = declared_.find(key);
    if (key.empty() || !alone) {
      leave(argument.begin, std::string(text_at(original_, argument)) + ": it is computed");
    } else if (declared == declared_.end()) {
      leave(argument.begin, name + ": it is declared elsewhere, in a .dat: correct that one too");
    } else if (std::ranges::find(changed_, key) != changed_.end()) {
      leave(argument.begin, name + ": it gets several values");
    } else {
      use(declared->second, argument.begin, linear);
    }
  }

  static bool same(const std::optional<Pose>& one, const std::optional<Pose>& other) {
    if (!one || !other) return one.has_value() == other.has_value();
    return one->p == other->p && one->R == other->R;
  }

  void use(Declared& declared, std::size_t at, bool linear) {
    const auto X_FT = pose_now(tool_, frames_.tools);
    const auto X_BW = pose_now(base_, frames_.frames);
    if (declared.used) {
      if (!same(declared.X_FT, X_FT) || !same(declared.X_BW, X_BW)) {
        leave(at, declared.name + ": it is used with another tool or base than before");
      }
      return;
    }
    declared.used = true;
    declared.X_FT = X_FT;
    declared.X_BW = X_BW;
    add(declared.name, declared.value, linear);
  }

  // A .dat has no motions: each declared target by itself.
  void take_declared() {
    for (const std::string& key : order_) {
      const Declared& declared = declared_[key];
      const bool target = declared.value.all(kPoseNames) || declared.value.all(kAxisNames);
      const bool frame =
          key.starts_with("TOOL_DATA") || key.starts_with("BASE_DATA") || key[0] == '$';
      if (!target || frame) continue;
      if (std::ranges::find(changed_, key) != changed_.end()) {
        leave(declared.value.at, declared.name + ": it gets several values");
        continue;
      }
      const auto fdat = key[0] == 'X' ? declared_.find("F" + key.substr(1)) : declared_.end();
      set_by_numbers(fdat == declared_.end() ? nullptr : &fdat->second.value);
      // Which motion goes to it is not known here.
      add(declared.name, declared.value, true);
    }
  }

  static std::optional<Pose> pose_now(const Frame& frame, const GivenFrames& given) {
    if (frame.X || !frame.why_not.empty()) return frame.X;
    const Pose* const X = given.find("");
    return X != nullptr ? std::optional(*X) : std::nullopt;
  }

  void add(const std::string& name, const Aggregate& aggregate, bool linear) {
    ProgramTarget target;
    target.line = lines_.line_of(aggregate.at);
    target.name = name;
    target.linear = linear;
    const auto axes = aggregate.all(kAxisNames);
    const auto pose = aggregate.all(kPoseNames);
    target.joints = axes.has_value();
    if (!axes && !pose) {
      leave(aggregate.at, name + ": it is not written with all of X to C, or A1 to A6");
      return;
    }
    target.numbers = axes ? *axes : *pose;
    target.values = values_at(text_, target.numbers);
    if (!axes && !place(target, name, aggregate.at)) return;
    const std::array<std::string_view, 2> kWords{"S", "T"};
    const auto words = axes ? std::nullopt : aggregate.all(kWords);
    if (words) {
      target.words = *words;
      for (const double value : values_at(text_, *words)) {
        target.configuration.push_back(std::lround(std::clamp(value, -1e6, 1e6)));
      }
    }
    program_.targets.push_back(std::move(target));
  }

  bool place(ProgramTarget& target, const std::string& name, std::size_t at) {
    const auto X_FT = pose_now(tool_, frames_.tools);
    const auto X_BW = pose_now(base_, frames_.frames);
    if (!X_FT || !X_BW) {
      const std::string& said = X_FT ? base_.why_not : tool_.why_not;
      leave(at, name + ": " + (said.empty() ? (X_FT ? kNoFrame : kNoTool) : said));
      return false;
    }
    target.X_FT = *X_FT;
    target.X_BW = *X_BW;
    return true;
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }

  std::string text_;
  std::string_view original_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  std::map<std::string, Declared> declared_;
  std::vector<std::string> order_;
  std::vector<std::string> changed_;
  Frame tool_;
  Frame base_;
  Program program_;
};

}  // namespace

Program read_krl(std::string_view text, const ProgramFrames& frames) {
  return KrlReader(text, frames).read();
}

}  // namespace armsig::tool
