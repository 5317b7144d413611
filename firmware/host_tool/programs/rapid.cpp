// SPDX-License-Identifier: MIT
// Targets of RAPID: robtargets and jointtargets that a module declares or an instruction holds. The
// instruction that goes to one names its tool and work object, which are declared in the module or
// given.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/rapid_data.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

// Instructions that go to a target begin with one of these.
constexpr std::array<std::string_view, 9> kRapidMoves{"MOVE", "ARC",   "TRIGG", "SPOT",   "SEARCH",
                                                      "DISP", "PAINT", "CAP",   "CONTACT"};

// Names belong to their routine, or to their module where `routine` is 0.
struct RapidScope {
  int module = 0;
  int routine = 0;
};
struct RapidStatement {
  Bytes bytes;
  RapidScope scope;
};

std::string scoped(const RapidScope& scope, std::string_view name) {
  return fmt::format("{}/{}/{}", scope.module, scope.routine, name);
}

class RapidReader {
 public:
  RapidReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_comments(text, {.to_end_of_line = '!'}))),
        original_(text),
        lines_(text),
        frames_(frames) {}

  Program read() {
    const std::vector<RapidStatement> all = statements();
    for (const RapidStatement& one : all) take_declaration(one);
    for (const RapidStatement& one : all) take_change(one);
    for (const RapidStatement& one : all) take_instruction(one);
    name_offsets();
    for (const auto& [name, declared] : targets_) {
      if (declared.used || declared.data.empty()) continue;
      taken_.insert(declared.data[0].lists[0][0].begin);
      leave(declared.at, as_written(declared.name) + ": no instruction here goes to it");
    }
    leave_the_rest();
    return std::move(program_);
  }

 private:
  struct Declared {
    std::size_t at = 0;
    Bytes name;
    std::vector<RapidData> data;  // none of what is computed, several of an array
    bool used = false;
    int changed = 0;        // line, where the program gives it another value
    std::string tool = {};  // NOLINT(readability-redundant-member-init)
    std::string wobj = {};  // NOLINT(readability-redundant-member-init)
  };
  struct DeclaredFrame {
    std::optional<Pose> X;
    std::string why_not;
  };

  // With their scopes; parameters of routines are declared by the way.
  std::vector<RapidStatement> statements() {
    std::vector<RapidStatement> all;
    RapidScope scope;
    std::size_t begin = 0;
    for (std::size_t at = text_.find(';'); at != std::string::npos; at = text_.find(';', begin)) {
      const Bytes bytes = trimmed_bytes(text_, {begin, at});
      const std::size_t behind = enter_scopes(bytes, scope);
      all.push_back({{behind, bytes.end}, scope});
      begin = at + 1;
    }
    return all;
  }

  // Modules and routines that begin or end in the statement; returns where the rest begins.
  std::size_t enter_scopes(Bytes bytes, RapidScope& scope) {
    std::size_t behind = bytes.begin;
    ProgramScanner scanner(std::string_view(text_).substr(0, bytes.end), bytes.begin);
    if (scanner.at_end()) return behind;
    do {
      const std::string_view word = scanner.word();
      if (word == "MODULE") scope = {++modules_, 0};
      if (word == "ENDPROC" || word == "ENDFUNC" || word == "ENDTRAP") scope.routine = 0;
      if (word != "PROC" && word != "FUNC" && word != "TRAP") continue;
      scope.routine = ++routines_;
      const std::size_t open = text_.find('(', scanner.at());
      if (word == "TRAP" || open >= bytes.end) continue;
      const auto parameters =
          arguments_from(std::string_view(text_).substr(0, bytes.end), open + 1, ')');
      for (const Bytes& parameter : parameters) take_declaration({parameter, scope});
      behind = std::min(parameters.back().end + 1, bytes.end);
      scanner.go_to(behind);
    } while (scanner.next_word());
    return behind;
  }

  [[nodiscard]] std::string as_written(Bytes bytes) const {
    return std::string(text_at(original_, bytes));
  }

  // What a name means in a scope: of the routine, of the module, or of another module of the text.
  template <typename Meaning>
  Meaning* find_in(std::map<std::string, Meaning>& all, std::string_view name,
                   const RapidScope& scope) const {
    std::vector<RapidScope> scopes{scope, {scope.module, 0}};
    for (int module = 0; module <= modules_; ++module) scopes.push_back({module, 0});
    for (const RapidScope& one : scopes) {
      const auto found = all.find(scoped(one, name));
      if (found != all.end()) return &found->second;
    }
    return nullptr;
  }

  // The name declared, and where its value begins; type is one of RAPID's.
  void take_declaration(const RapidStatement& statement) {
    const std::size_t end = statement.bytes.end;
    ProgramScanner scanner(std::string_view(text_).substr(0, end), statement.bytes.begin);
    if (scanner.at_end()) return;
    do {
      const std::string_view type = scanner.word();
      const bool target = type == "ROBTARGET" || type == "JOINTTARGET";
      if (!target && type != "TOOLDATA" && type != "WOBJDATA") continue;
      scanner.skip_blanks();
      const std::size_t begin = scanner.at();
      const std::string name = scoped(statement.scope, scanner.word());
      const Bytes written{begin, scanner.at()};
      if (written.begin == written.end) continue;
      if (scanner.peek() == '{') scanner.go_to(text_.find('}', scanner.at()) + 1);
      const bool valued = scanner.accept(':') && scanner.accept('=');
      const Bytes value = trimmed_bytes(text_, {valued ? scanner.at() : end, end});
      if (target) {
        const bool again = targets_.contains(name);
        targets_.try_emplace(name, Declared{begin, written, rapid_targets(text_, value)});
        if (again) targets_[name].changed = lines_.line_of(begin);
      } else if (type == "TOOLDATA") {
        tools_[name] = tool_in(value);
      } else {
        wobjs_[name] = wobj_in(value);
      }
      return;
    } while (scanner.next_word());
  }

  // "P10.TRANS.X" of "P10.TRANS.X := ..."; the end at both ends where nothing is assigned.
  [[nodiscard]] Bytes assigned(Bytes statement) const {
    int depth = 0;
    for (std::size_t at = statement.begin; at + 1 < statement.end; ++at) {
      if (text_[at] == '[' || text_[at] == '(') ++depth;
      if (text_[at] == ']' || text_[at] == ')') --depth;
      if (depth != 0 || text_[at] != ':' || text_[at + 1] != '=') continue;
      const std::size_t end = trimmed_bytes(text_, {statement.begin, at}).end;
      std::size_t begin = end;
      while (begin > statement.begin) {
        const char before = text_[begin - 1];
        const std::size_t open = before == '}' ? text_.rfind('{', begin) : std::string::npos;
        if (open != std::string::npos && open >= statement.begin) {
          begin = open;
        } else if (is_word(before) || before == '.') {
          --begin;
        } else {
          break;
        }
      }
      const bool switches = begin > statement.begin && text_[begin - 1] == '\\';
      if (!switches) return {begin, end};
    }
    return {statement.end, statement.end};
  }

  // A value that the program computes while it runs.
  void take_change(const RapidStatement& statement) {
    const Bytes left = assigned(statement.bytes);
    ProgramScanner scanner(std::string_view(text_).substr(0, left.end), left.begin);
    const std::string_view name = scanner.word();
    const std::string_view part =
        std::string_view(text_).substr(scanner.at(), left.end - scanner.at());
    // Loads and external axes are no places.
    if (name.empty() || part.contains(".TLOAD") || part.contains(".EXTAX")) return;
    ProgramScanner all(std::string_view(text_).substr(0, left.begin), statement.bytes.begin);
    for (bool more = !all.at_end(); more; more = all.next_word()) {
      const std::string_view type = all.word();
      if (type == "VAR" || type == "PERS" || type == "CONST") return;
    }
    const int line = lines_.line_of(left.begin);
    Declared* const target = find_in(targets_, name, statement.scope);
    if (target != nullptr) target->changed = line;
    for (auto* frames : {&tools_, &wobjs_}) {
      DeclaredFrame* const frame = find_in(*frames, name, statement.scope);
      if (frame != nullptr) *frame = {std::nullopt, fmt::format("is changed in line {}", line)};
    }
  }

  // The pose [x, y, z], [q1, ... q4] at `k` of the lists.
  [[nodiscard]] std::optional<Pose> pose_in(const std::vector<std::vector<Bytes>>& lists,
                                            std::size_t k) const {
    if (lists.size() < k + 2 || lists[k].size() != 3 || lists[k + 1].size() != 4) return {};
    std::vector<Bytes> numbers = lists[k];
    numbers.insert(numbers.end(), lists[k + 1].begin(), lists[k + 1].end());
    return pose_of(values_at(text_, numbers), kRapidWriting);
  }

  // [robhold, [[x, y, z], [q1, ... q4]], load]
  [[nodiscard]] DeclaredFrame tool_in(Bytes value) const {
    ProgramScanner scanner(std::string_view(text_).substr(0, value.end), value.begin);
    if (!scanner.accept('[')) return {std::nullopt, "is computed"};
    if (scanner.word() != "TRUE") return {std::nullopt, "is not held by the robot"};
    if (!scanner.accept(',')) return {std::nullopt, "is computed"};
    const auto lists = rapid_lists(scanner);
    const auto X = lists ? pose_in(*lists, 0) : std::nullopt;
    return {X, X ? "" : "is computed"};
  }

  // [robhold, ufprog, "ufmec", uframe, oframe]
  [[nodiscard]] DeclaredFrame wobj_in(Bytes value) const {
    ProgramScanner scanner(std::string_view(text_).substr(0, value.end), value.begin);
    if (!scanner.accept('[')) return {std::nullopt, "is computed"};
    if (scanner.word() != "FALSE") return {std::nullopt, "is held by the robot"};
    if (!scanner.accept(',') || scanner.word() != "TRUE") {
      return {std::nullopt, "is moved by another mechanism"};
    }
    if (!scanner.accept(',') || !scanner.accept(',')) return {std::nullopt, "is computed"};
    const auto user = rapid_lists(scanner);
    if (!user || !scanner.accept(',')) return {std::nullopt, "is computed"};
    const auto object = rapid_lists(scanner);
    const auto X_BU = pose_in(*user, 0);
    const auto X_UO = object ? pose_in(*object, 0) : std::nullopt;
    if (!X_BU || !X_UO) return {std::nullopt, "is computed"};
    return {*X_BU * *X_UO, ""};
  }

  void take_instruction(const RapidStatement& statement) {
    const std::string_view upto = std::string_view(text_).substr(0, statement.bytes.end);
    ProgramScanner scanner(upto, statement.bytes.begin);
    if (scanner.at_end()) return;
    do {
      const std::size_t at = scanner.at();
      const std::string_view word = scanner.word();
      const char behind = scanner.peek();
      const bool separate =
          behind == ' ' || behind == '\t' || behind == '\\' || behind == '\r' || behind == '\n';
      if (word == "CONFJ") any_configuration_ = upto.substr(at).contains("\\OFF");
      if (word == "PDISPON" || word == "PDISPSET") {
        remark(at, as_written({at, scanner.at()}) +
                       ": it moves targets; they are corrected for where they are written");
      }
      const bool moves = std::ranges::any_of(
          kRapidMoves, [&](std::string_view start) { return word.starts_with(start); });
      if (!separate || !moves) continue;
      const auto arguments = arguments_from(upto, scanner.at(), ';');
      if (arguments.size() >= 2) go_to(word, arguments, statement.scope);
      return;
    } while (scanner.next_word());
  }

  [[nodiscard]] Bytes without_switches(Bytes argument) const {
    return without_rapid_switches(text_, argument);
  }

  [[nodiscard]] std::string wobj_of(Bytes argument) const {
    const std::string_view text = text_at(text_, argument);
    const std::size_t at = text.find("\\WOBJ");
    if (at == std::string_view::npos) return "WOBJ0";
    ProgramScanner scanner(text, at + 5);
    if (!scanner.accept(':') || !scanner.accept('=')) return "WOBJ0";
    return std::string(scanner.word());
  }

  // The tool is the last argument, but of motions with a signal or a procedure behind it.
  static std::size_t tool_argument(std::string_view instruction, std::size_t count) {
    std::size_t behind = 0;
    if (instruction.starts_with("MOVE") && instruction.size() > 6) {
      const std::string_view end = instruction.substr(instruction.size() - 2);
      if (end == "DO" || end == "AO" || end == "GO") behind = 2;
      if (instruction.ends_with("SYNC")) behind = 1;
    }
    return count - 1 - std::min(behind, count - 1);
  }

  // How an instruction goes to its targets.
  struct Going {
    std::string tool;
    std::string wobj;
    bool linear = false;
    RapidScope scope;
  };

  void go_to(std::string_view instruction, const std::vector<Bytes>& arguments,
             const RapidScope& scope) {
    const std::size_t last = tool_argument(instruction, arguments.size());
    const bool joint = instruction.starts_with("MOVEJ") || instruction.ends_with('J');
    const Going going{std::string(text_at(text_, without_switches(arguments[last]))),
                      wobj_of(arguments[last]), !joint || any_configuration_, scope};
    bool any = false;
    for (std::size_t k = 0; k < last; ++k) {
      any = go_to_argument(without_switches(arguments[k]), going) || any;
    }
    const Bytes first = without_switches(arguments[0]);
    if (!any && instruction.starts_with("MOVE") && first.end > first.begin) {
      leave(first.begin, as_written(first) + (text_at(text_, first).contains('(')
                                                  ? ": it is computed"
                                                  : ": it is not declared here"));
    }
  }

  bool go_to_argument(Bytes argument, const Going& going) {
    const std::string_view name = text_at(text_, argument);
    Declared* const declared =
        find_in(targets_, name.substr(0, std::min(name.find('{'), name.size())), going.scope);
    std::size_t end = argument.begin;
    if (declared != nullptr) {
      use(*declared, argument.begin, going);
    } else if (const auto data = rapid_target_at(text_, end); data && end == argument.end) {
      add("target", argument.begin, *data, going);
    } else if (name.starts_with("OFFS") || name.starts_with("RELTOOL")) {
      offsets_.push_back({argument, going.scope});
    } else {
      return false;
    }
    return true;
  }

  // Offs() and RelTool() move with the target that they begin from, where that one is corrected.
  void name_offsets() {
    for (const RapidStatement& one : offsets_) {
      const std::size_t open = std::min(text_.find('(', one.bytes.begin), one.bytes.end - 1);
      const Bytes from =
          arguments_from(std::string_view(text_).substr(0, one.bytes.end), open + 1, ')')[0];
      const std::string_view name = text_at(text_, from);
      const Declared* const target =
          find_in(targets_, name.substr(0, std::min(name.find('{'), name.size())), one.scope);
      const bool corrected =
          target != nullptr && target->used && target->changed == 0 && !target->data.empty();
      if (corrected) {
        remark(one.bytes.begin, fmt::format("{}: it moves with the correction of {}",
                                            as_written(one.bytes), as_written(from)));
      } else {
        leave(one.bytes.begin, as_written(one.bytes) + ": it is computed");
      }
    }
  }

  void use(Declared& declared, std::size_t at, const Going& going) {
    const std::string name = as_written(declared.name);
    if (declared.data.empty()) {
      leave(at, name + ": it is computed, not written");
      return;
    }
    const bool first = !std::exchange(declared.used, true);
    if (!first) {
      const bool same =
          declared.data[0].joints || (declared.tool == going.tool && declared.wobj == going.wobj);
      if (!same) remark(at, name + ": it is used with another tool or work object than before");
      return;
    }
    declared.tool = going.tool;
    declared.wobj = going.wobj;
    for (const RapidData& data : declared.data) taken_.insert(data.lists[0][0].begin);
    if (declared.changed > 0) {
      leave(declared.at, fmt::format("{}: line {} gives it another value", name, declared.changed));
      return;
    }
    for (std::size_t k = 0; k < declared.data.size(); ++k) {
      add(text_[declared.name.end] == '{' ? fmt::format("{}{{{}}}", name, k + 1) : name,
          k == 0 ? declared.at : declared.data[k].lists[0][0].begin, declared.data[k], going);
    }
  }

  // Targets in places where nothing goes to them: values that a variable gets, arguments.
  void leave_the_rest() {
    for (const RapidData& data : rapid_targets(text_, {0, text_.size()})) {
      const std::size_t at = data.lists[0][0].begin;
      if (taken_.contains(at) || within_declared(at)) continue;
      leave(at, "target: no instruction here goes to it");
    }
  }

  // Further elements of an array that is named already.
  [[nodiscard]] bool within_declared(std::size_t at) const {
    return std::ranges::any_of(targets_, [&](const auto& one) {
      const auto& data = one.second.data;
      return !data.empty() && data.front().lists[0][0].begin < at &&
             at <= data.back().lists[0][0].begin;
    });
  }

  // A frame that is declared, given, or the one that is always there.
  std::expected<Pose, std::string> frame(std::map<std::string, DeclaredFrame>& declared,
                                         const GivenFrames& given, const std::string& name,
                                         std::string_view always, const char* option,
                                         const RapidScope& scope) const {
    if (name == always) return Pose{};
    const DeclaredFrame* const found = find_in(declared, name, scope);
    if (found != nullptr && found->X) return *found->X;
    if (found != nullptr) return std::unexpected(name + " " + found->why_not);
    if (name.empty() || !std::ranges::all_of(name, is_word)) {
      return std::unexpected("its instruction has no tool or work object by name");
    }
    if (const Pose* X = given.find(name)) return *X;
    return std::unexpected(fmt::format("{0} is not declared here: {1} {0}=...", name, option));
  }

  void add(const std::string& name, std::size_t at, const RapidData& data, const Going& going) {
    taken_.insert(data.lists[0][0].begin);
    ProgramTarget target;
    target.line = lines_.line_of(at);
    target.name = name;
    target.joints = data.joints;
    target.linear = going.linear;
    target.numbers = data.lists[0];
    if (!data.joints) {
      const auto X_FT = frame(tools_, frames_.tools, going.tool, "TOOL0", "--tool", going.scope);
      const auto X_BW = frame(wobjs_, frames_.frames, going.wobj, "WOBJ0", "--frame", going.scope);
      if (!X_FT || !X_BW) {
        leave(at, name + ": " + (X_FT ? X_BW.error() : X_FT.error()));
        return;
      }
      target.X_FT = *X_FT;
      target.X_BW = *X_BW;
      target.numbers.insert(target.numbers.end(), data.lists[1].begin(), data.lists[1].end());
      target.words = data.lists[2];
      for (const double value : values_at(text_, data.lists[2])) {
        target.configuration.push_back(std::lround(std::clamp(value, -1e6, 1e6)));
      }
    }
    target.values = values_at(text_, target.numbers);
    target.external = values_at(text_, data.lists.back());
    program_.targets.push_back(std::move(target));
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }
  void remark(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what), true});
  }

  std::string text_;
  std::string_view original_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  int modules_ = 0;
  int routines_ = 0;
  bool any_configuration_ = false;  // ConfJ \Off: the controller goes to the nearest one
  std::map<std::string, Declared> targets_;
  std::map<std::string, DeclaredFrame> tools_;
  std::map<std::string, DeclaredFrame> wobjs_;
  std::vector<RapidStatement> offsets_;
  std::set<std::size_t> taken_;  // where targets begin that are corrected, or left by name
  Program program_;
};

}  // namespace

Program read_rapid(std::string_view text, const ProgramFrames& frames) {
  return RapidReader(text, frames).read();
}

}  // namespace armsig::tool
