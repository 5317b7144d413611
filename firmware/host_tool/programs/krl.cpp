// SPDX-License-Identifier: MIT
// Targets of KRL: poses {X, Y, Z, A, B, C, S, T} and readings {A1 ... A6} in motions of a .src, and
// those that a .dat declares, whose tool and base its FDAT of the same name has.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/programs/krl_aggregate.hpp"
#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 7> kKrlMotions{"PTP",  "LIN",   "CIRC", "SPTP",
                                                      "SLIN", "SCIRC", "SPL"};
class KrlReader {
 public:
  KrlReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_comments(text, {.to_end_of_line = ';'}))),
        original_(text),
        lines_(text),
        frames_(frames) {}

  Program read() {
    find_declarations();
    std::vector<Bytes> lines;
    for (std::size_t begin = 0; begin < text_.size();) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      lines.push_back({begin, end});
      begin = end + 1;
    }
    for (const Bytes& line : lines) find_change(line);
    bool any_motion = false;
    for (const Bytes& line : lines) any_motion = take_line(line) || any_motion;
    if (!any_motion) take_declared();
    leave_the_rest();
    return std::move(program_);
  }

 private:
  struct Declared {
    KrlAggregate value;
    std::string name;  // as written
    bool used = false;
    std::optional<Pose> X_FT, X_BW;
  };
  struct Frame {
    std::optional<Pose> X;
    std::string why_not;
  };
  struct Frames {
    Frame tool;
    Frame base;
    bool standing_tool = false;  // the robot holds the work piece: #TCP
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
      if (declared_.contains(key)) changed_[key] = lines_.line_of(at);
      const bool first = declared_
                             .try_emplace(key, Declared{krl_aggregate_at(text_, at),
                                                        std::string(text_at(original_, name)),
                                                        false,
                                                        {},
                                                        {}})
                             .second;
      if (first) order_.push_back(key);
    }
  }

  // "NAME", "NAME[3]"; "NAME" of an index that is computed.
  static std::string indexed_name(ProgramScanner& scanner) {
    std::string key(scanner.word());
    if (!scanner.accept('[')) return key;
    const std::string index(scanner.word());
    if (!scanner.accept(']') || !parse_integer(index)) return key + "[?]";
    return key + "[" + index + "]";
  }

  // A value or a component that the program computes while it runs: "XP1.X = ...", "P = Q".
  void find_change(Bytes line) {
    ProgramScanner scanner(std::string_view(text_).substr(0, line.end), line.begin);
    std::string key = indexed_name(scanner);
    if (key.starts_with('$')) return;
    if (key == "GLOBAL") key = scanner.word();
    if (key == "DECL") {
      key = scanner.word();
      if (key == "GLOBAL") scanner.word();
      key = indexed_name(scanner);
    }
    const bool component = scanner.accept('.');
    while (component && (!scanner.word().empty() || scanner.accept('.'))) continue;
    if (key.empty() || !scanner.accept('=') || scanner.accept('=')) return;
    if (!component && scanner.accept('{')) return;
    changed_.try_emplace(key, lines_.line_of(line.begin));
  }

  // The line that changes a name while the program runs; 0 of none.
  [[nodiscard]] int changed_in(const std::string& key) const {
    const auto found = changed_.find(key);
    if (found != changed_.end()) return found->second;
    const std::size_t bracket = key.find('[');
    const auto any = bracket == std::string::npos ? changed_.end()
                                                  : changed_.find(key.substr(0, bracket) + "[?]");
    return any != changed_.end() ? any->second : 0;
  }

  // A motion in the line? Frames that the line sets are set.
  bool take_line(Bytes line) {
    const std::string_view upto = std::string_view(text_).substr(0, line.end);
    ProgramScanner scanner(upto, line.begin);
    const std::string word(scanner.word());
    if (word == "$TOOL" || word == "$BASE" || word == "$IPO_MODE") {
      set_frame(word, scanner);
    } else if (word == "FDAT_ACT" && scanner.accept('=')) {
      set_by_point(scanner);
    } else if (word == "BAS" && scanner.accept('(') && scanner.accept('#')) {
      const std::string_view what = scanner.word();
      if ((what == "TOOL" || what == "BASE") && scanner.accept(',')) {
        set_numbered("$" + std::string(what), scanner.number());
      }
    } else if (word == "SPLINE" || word == "PTP_SPLINE") {
      outside_ = now_;
      set_with(line);
    } else if (word == "ENDSPLINE") {
      now_ = outside_;
    } else if (word.ends_with("_REL")) {
      leave(line.begin, std::string(trimmed(text_at(original_, line))) + ": it is relative");
      return true;
    } else if (std::ranges::find(kKrlMotions, word) != kKrlMotions.end()) {
      take_motion(line, word, scanner.at());
      return true;
    }
    return false;
  }

  void take_motion(Bytes line, std::string_view word, std::size_t behind) {
    const Frames before = now_;
    set_with(line);
    const bool linear = word != "PTP" && word != "SPTP";
    const std::size_t count = word.ends_with("CIRC") ? 2 : 1;
    const auto arguments =
        arguments_from(std::string_view(text_).substr(0, line.end), behind, '\n');
    for (std::size_t k = 0; k < count && k < arguments.size(); ++k) {
      take_argument(arguments[k], linear);
    }
    now_ = before;
  }

  // Tool and base of one motion or spline: "... WITH $TOOL = TOOL_DATA[2], $BASE = ...".
  void set_with(Bytes line) {
    const std::string_view text = std::string_view(text_).substr(0, line.end);
    const std::size_t with = text.find(" WITH ", line.begin);
    if (with == std::string_view::npos) return;
    for (const char* which : {"$TOOL", "$BASE", "$IPO_MODE"}) {
      const std::size_t at = text.find(which, with);
      if (at == std::string_view::npos) continue;
      ProgramScanner scanner(text, at);
      const std::string word(scanner.word());
      if (word == which) set_frame(word, scanner);
    }
  }

  // `scanner`: behind $TOOL, $BASE or $IPO_MODE.
  void set_frame(const std::string& which, ProgramScanner& scanner) {
    Frame& frame = which == "$BASE" ? now_.base : now_.tool;
    const bool whole = scanner.accept('=');
    scanner.skip_blanks();
    if (which == "$IPO_MODE") {
      now_.standing_tool = scanner.accept('#') && scanner.word() == "TCP";
      return;
    }
    frame = {std::nullopt, which + " is computed"};
    if (!whole) return;
    Frame read;
    if (scanner.peek() == '{') {
      const KrlAggregate aggregate = krl_aggregate_at(text_, scanner.at());
      taken_.insert(aggregate.at);
      read = frame_in(aggregate, which);
      scanner.go_to(aggregate.end + 1);
    } else {
      read = frame_named(which, scanner);
    }
    scanner.skip_blanks();
    if (scanner.at_end() || scanner.peek() == ',') frame = read;
  }

  // $NULLFRAME, TOOL_DATA[2] and the like, or those of a point's FDAT.
  Frame frame_named(const std::string& which, ProgramScanner& scanner) {
    const std::string_view word = scanner.word();
    if (word == "$NULLFRAME") return {Pose{}, ""};
    if ((word == "TOOL_DATA" || word == "BASE_DATA") && scanner.accept('[')) {
      const auto number = scanner.number();
      if (number && scanner.accept(']')) return numbered(which, number);
    }
    if ((word == "STOOL2" || word == "SBASE") && scanner.accept('(')) {
      const auto fdat = declared_.find(std::string(scanner.word()));
      const char* const key = which == "$TOOL" ? "TOOL_NO" : "BASE_NO";
      scanner.go_to(std::min(text_.find(')', scanner.at()), text_.size()));
      scanner.accept(')');
      if (fdat == declared_.end() || !fdat->second.value.numbers.contains(key)) return {};
      return numbered(which, fdat->second.value.numbers.at(key));
    }
    return {std::nullopt, which + " is computed"};
  }

  [[nodiscard]] Frame frame_in(const KrlAggregate& aggregate, const std::string& which) const {
    const auto numbers = aggregate.all(kPoseNames);
    if (!numbers) return {std::nullopt, which + " is not written with all of X to C"};
    return {pose_of(values_at(text_, *numbers), kKrlWriting), ""};
  }

  // TOOL_DATA[n] or BASE_DATA[n]: of this text, 0, or given.
  [[nodiscard]] Frame numbered(const std::string& which, std::optional<Bytes> number) const {
    const bool tool = which == "$TOOL";
    const std::string n(number ? text_at(text_, *number) : std::string_view("?"));
    const std::string data = (tool ? "TOOL_DATA[" : "BASE_DATA[") + n + "]";
    const auto declared = declared_.find(data);
    const Pose* const given = (tool ? frames_.tools : frames_.frames).find(n);
    if (!number) return {std::nullopt, which + " is computed"};
    if (const int line = changed_in(data); line > 0) {
      return {std::nullopt, fmt::format("{} is changed in line {}", data, line)};
    }
    if (declared != declared_.end()) return frame_in(declared->second.value, data);
    if (n == "0") return {Pose{}, ""};
    if (given != nullptr) return {*given, ""};
    return {std::nullopt,
            fmt::format("{} is not here: {} {}=...", data, tool ? "--tool" : "--frame", n)};
  }
  void set_numbered(const std::string& which, std::optional<Bytes> number) {
    (which == "$TOOL" ? now_.tool : now_.base) = numbered(which, number);
  }

  void set_by_point(ProgramScanner& scanner) {
    scanner.skip_blanks();
    if (scanner.peek() == '{') {
      const KrlAggregate written = krl_aggregate_at(text_, scanner.at());
      set_by_numbers(&written);
      return;
    }
    const auto fdat = declared_.find(std::string(scanner.word()));
    set_by_numbers(fdat == declared_.end() ? nullptr : &fdat->second.value);
  }

  void set_by_numbers(const KrlAggregate* fdat) {
    now_ = {};
    if (fdat == nullptr) return;
    for (const auto& [which, key] : {std::pair{"$TOOL", "TOOL_NO"}, {"$BASE", "BASE_NO"}}) {
      if (fdat->numbers.contains(key)) set_numbered(which, fdat->numbers.at(key));
    }
    now_.standing_tool = text_at(text_, {fdat->at, fdat->end}).contains("#TCP");
  }

  void take_argument(Bytes argument, bool linear) {
    if (argument.begin < argument.end && text_[argument.begin] == '{') {
      const KrlAggregate aggregate = krl_aggregate_at(text_, argument.begin);
      add("target", aggregate, linear);
      return;
    }
    ProgramScanner scanner(std::string_view(text_).substr(0, argument.end), argument.begin);
    const std::string key = indexed_name(scanner);
    const std::string name(
        text_at(original_, trimmed_bytes(text_, {argument.begin, scanner.at()})));
    scanner.skip_blanks();
    const bool alone = !std::string_view(":.[+-*/").contains(scanner.peek()) || scanner.at_end();
    const auto declared = declared_.find(key);
    const int changed = changed_in(key);
    if (key.empty() || !alone || key.ends_with("[?]")) {
      leave(argument.begin, std::string(text_at(original_, argument)) + ": it is computed");
    } else if (key == "$AXIS_ACT" || key == "$POS_ACT") {
      leave(argument.begin, name + ": it is where the arm stands");
    } else if (declared == declared_.end() && changed == 0) {
      leave(argument.begin, name + ": it is declared elsewhere, in a .dat: correct that one too");
    } else if (changed > 0) {
      leave_changed(argument.begin, name, key, changed);
    } else {
      use(declared->second, argument.begin, linear);
    }
  }

  void leave_changed(std::size_t at, const std::string& name, const std::string& key, int line) {
    const auto declared = declared_.find(key);
    if (declared != declared_.end()) taken_.insert(declared->second.value.at);
    leave(at, fmt::format("{}: it gets several values, or a computed one, in line {}", name, line));
  }

  static bool same(const std::optional<Pose>& one, const std::optional<Pose>& other) {
    if (!one || !other) return one.has_value() == other.has_value();
    return one->p == other->p && one->R == other->R;
  }

  void use(Declared& declared, std::size_t at, bool linear) {
    const auto X_FT = pose_now(now_.tool, frames_.tools);
    const auto X_BW = pose_now(now_.base, frames_.frames);
    if (declared.used) {
      if (!same(declared.X_FT, X_FT) || !same(declared.X_BW, X_BW)) {
        program_.left.push_back(
            {lines_.line_of(at),
             declared.name + ": it is used with another tool or base than before", true});
      }
      return;
    }
    declared.used = true;
    declared.X_FT = X_FT;
    declared.X_BW = X_BW;
    add(declared.name, declared.value, linear);
  }

  // Tools, bases and system variables.
  [[nodiscard]] bool is_frame(std::string_view key) const {
    return key.starts_with("TOOL_DATA") || key.starts_with("BASE_DATA") || key.starts_with('$');
  }

  // A .dat has no motions: each declared target by itself.
  void take_declared() {
    for (const std::string& key : order_) {
      const Declared& declared = declared_[key];
      if (!declared.value.is_target() || is_frame(key)) continue;
      const std::size_t line = text_.rfind('\n', declared.value.at) + 1;
      if (const int changed = changed_in(key); changed > 0) {
        leave_changed(declared.value.at, declared.name, key, changed);
      } else if (text_at(text_, {line, declared.value.at}).contains(" FRAME ")) {
        taken_.insert(declared.value.at);
        leave(declared.value.at, declared.name + ": it is a frame, and may be no target");
      } else {
        const auto fdat = key[0] == 'X' ? declared_.find("F" + key.substr(1)) : declared_.end();
        set_by_numbers(fdat == declared_.end() ? nullptr : &fdat->second.value);
        // Which motion goes to it is not known here.
        add(declared.name, declared.value, true);
      }
    }
  }

  // Targets in places where no motion goes to them.
  void leave_the_rest() {
    for (std::size_t at = text_.find('{'); at != std::string::npos; at = text_.find('{', at + 1)) {
      const std::size_t line = text_.rfind('\n', at) + 1;
      const Bytes before = trimmed_bytes(text_, {line, at});
      const Bytes name = name_before(at);
      const int number = lines_.line_of(at);
      const bool named =
          std::ranges::find(program_.left, number, &LeftAsItIs::line) != program_.left.end();
      // CM is the centre of a load.
      if (taken_.contains(at) || named || text_[before.begin] == '$' ||
          is_frame(text_at(text_, name)) || text_at(text_, before).ends_with(" CM") ||
          text_at(text_, before).ends_with(",CM") || !krl_aggregate_at(text_, at).is_target()) {
        continue;
      }
      const std::string_view written = text_at(original_, name);
      if (const int changed = changed_in(std::string(text_at(text_, name))); changed > 0) {
        leave_changed(at, std::string(written), "", changed);
      } else {
        leave(at,
              std::string(written.empty() ? "target" : written) + ": no motion here goes to it");
      }
    }
  }

  static std::optional<Pose> pose_now(const Frame& frame, const GivenFrames& given) {
    if (frame.X || !frame.why_not.empty()) return frame.X;
    const Pose* const X = given.find("");
    return X != nullptr ? std::optional(*X) : std::nullopt;
  }

  void add(const std::string& name, const KrlAggregate& aggregate, bool linear) {
    taken_.insert(aggregate.at);
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
    target.external = external_axes(aggregate);
    if (!axes && !place(target, name, aggregate.at)) return;
    if (!axes) take_words(target, aggregate);
    program_.targets.push_back(std::move(target));
  }

  [[nodiscard]] std::vector<double> external_axes(const KrlAggregate& aggregate) const {
    std::vector<double> all;
    for (const char* const axis : {"E1", "E2", "E3", "E4", "E5", "E6"}) {
      const auto number = aggregate.numbers.find(axis);
      if (number == aggregate.numbers.end()) break;
      all.push_back(values_at(text_, {number->second})[0]);
    }
    return all;
  }

  // S and T, where both are written.
  void take_words(ProgramTarget& target, const KrlAggregate& aggregate) const {
    for (const char* const name : {"S", "T"}) {
      const bool decimal = aggregate.numbers.contains(name);
      if (!decimal && !aggregate.bits.contains(name)) {
        target.words.clear();
        target.configuration.clear();
        return;
      }
      const Bytes bytes = decimal ? aggregate.numbers.at(name) : aggregate.bits.at(name);
      target.words.push_back(bytes);
      target.configuration.push_back(
          decimal ? std::lround(std::clamp(values_at(text_, {bytes})[0], -1e6, 1e6))
                  : krl_bits(text_at(text_, bytes)));
    }
  }

  bool place(ProgramTarget& target, const std::string& name, std::size_t at) {
    if (now_.standing_tool) {
      leave(at, name + ": the robot holds the work piece there (#TCP)");
      return false;
    }
    const auto X_FT = pose_now(now_.tool, frames_.tools);
    const auto X_BW = pose_now(now_.base, frames_.frames);
    if (!X_FT || !X_BW) {
      const std::string& said = X_FT ? now_.base.why_not : now_.tool.why_not;
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
  std::map<std::string, int> changed_;  // with the line
  std::set<std::size_t> taken_;         // braces of targets, and of frames
  Frames now_;
  Frames outside_;  // of the spline that is read
  Program program_;
};

}  // namespace

Program read_krl(std::string_view text, const ProgramFrames& frames) {
  return KrlReader(text, frames).read();
}

}  // namespace armsig::tool
