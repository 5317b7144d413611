// SPDX-License-Identifier: MIT
// Targets of RAPID: robtargets and jointtargets that a module declares or an instruction holds. The
// instruction that goes to one names its tool and work object, which are declared in the module or
// given.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <fmt/core.h>

#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

// Instructions that go to a target begin with one of these.
constexpr std::array<std::string_view, 9> kRapidMoves{"MOVE", "ARC",   "TRIGG", "SPOT",   "SEARCH",
                                                      "DISP", "PAINT", "CAP",   "CONTACT"};

struct RapidData {
  std::vector<std::vector<Bytes>> lists;
  bool joints = false;
};

// [[...], [...], ...] of numbers.
std::optional<std::vector<std::vector<Bytes>>> rapid_lists(ProgramScanner& scanner) {
  std::vector<std::vector<Bytes>> lists;
  if (!scanner.accept('[')) return std::nullopt;
  do {
    auto one = scanner.list('[', ']');
    if (!one) return std::nullopt;
    lists.push_back(std::move(*one));
  } while (scanner.accept(','));
  if (!scanner.accept(']')) return std::nullopt;
  return lists;
}

bool has_sizes(const RapidData& data, std::initializer_list<std::size_t> sizes) {
  return std::ranges::equal(data.lists, sizes, {}, [](const auto& list) { return list.size(); });
}

// A robtarget or jointtarget written out between `bytes`.
std::optional<RapidData> rapid_target(std::string_view text, Bytes bytes) {
  ProgramScanner scanner(text.substr(0, bytes.end), bytes.begin);
  auto lists = rapid_lists(scanner);
  if (!lists || scanner.at() != bytes.end) return std::nullopt;
  RapidData data{std::move(*lists), false};
  data.joints = has_sizes(data, {6, 6});
  if (!data.joints && !has_sizes(data, {3, 4, 4, 6})) return std::nullopt;
  return data;
}

class RapidReader {
 public:
  RapidReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_comments(text, {.to_end_of_line = '!'}))),
        original_(text),
        lines_(text),
        frames_(frames) {}

  Program read() {
    for (const Bytes& statement : statements()) take_declaration(statement);
    for (const Bytes& statement : statements()) take_instruction(statement);
    for (const auto& [name, declared] : targets_) {
      if (!declared.used && declared.data) {
        leave(declared.at, as_written(declared.name) + ": no instruction here goes to it");
      }
    }
    return std::move(program_);
  }

 private:
  struct Declared {
    std::size_t at = 0;
    Bytes name;
    std::optional<RapidData> data;  // nothing of what is computed, or an array
    bool used = false;
    std::string tool = {};  // NOLINT(readability-redundant-member-init)
    std::string wobj = {};  // NOLINT(readability-redundant-member-init)
  };
  struct DeclaredFrame {
    std::optional<Pose> X;
    std::string why_not;
  };

  [[nodiscard]] std::vector<Bytes> statements() const {
    std::vector<Bytes> all;
    std::size_t begin = 0;
    for (std::size_t at = text_.find(';'); at != std::string::npos; at = text_.find(';', begin)) {
      all.push_back(trimmed_bytes(text_, {begin, at}));
      begin = at + 1;
    }
    return all;
  }

  [[nodiscard]] std::string as_written(Bytes bytes) const {
    return std::string(text_at(original_, bytes));
  }

  // The name declared, and where its value begins; type is one of RAPID's.
  void take_declaration(Bytes statement) {
    ProgramScanner scanner(std::string_view(text_).substr(0, statement.end), statement.begin);
    do {
      const std::string_view type = scanner.word();
      const bool target = type == "ROBTARGET" || type == "JOINTTARGET";
      if (!target && type != "TOOLDATA" && type != "WOBJDATA") continue;
      scanner.skip_blanks();
      const std::size_t begin = scanner.at();
      const std::string name(scanner.word());
      const Bytes written{begin, scanner.at()};
      if (name.empty() || !scanner.accept(':') || !scanner.accept('=')) {
        if (target) targets_[name] = {begin, written, std::nullopt};
        return;
      }
      const Bytes value = trimmed_bytes(text_, {scanner.at(), statement.end});
      if (target) {
        targets_[name] = {begin, written, rapid_target(text_, value)};
      } else if (type == "TOOLDATA") {
        tools_[name] = tool_in(value);
      } else {
        wobjs_[name] = wobj_in(value);
      }
      return;
    } while (scanner.next_word());
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

  void take_instruction(Bytes statement) {
    ProgramScanner scanner(std::string_view(text_).substr(0, statement.end), statement.begin);
    if (scanner.at_end()) return;
    do {
      const std::string_view word = scanner.word();
      const char behind = scanner.peek();
      const bool separate =
          behind == ' ' || behind == '\t' || behind == '\\' || behind == '\r' || behind == '\n';
      const bool moves = std::ranges::any_of(
          kRapidMoves, [&](std::string_view start) { return word.starts_with(start); });
      if (!separate || !moves) continue;
      const auto arguments =
          arguments_from(std::string_view(text_).substr(0, statement.end), scanner.at(), ';');
      if (arguments.size() >= 2) go_to(word, arguments);
      return;
    } while (scanner.next_word());
  }

  // What stands before the first switch: "P10" of "P10\ID:=3".
  [[nodiscard]] Bytes without_switches(Bytes argument) const {
    const std::size_t at = text_.find('\\', argument.begin);
    return at < argument.end ? trimmed_bytes(text_, {argument.begin, at}) : argument;
  }

  [[nodiscard]] std::string wobj_of(Bytes argument) const {
    const std::string_view text = text_at(text_, argument);
    const std::size_t at = text.find("\\WOBJ");
    if (at == std::string_view::npos) return "WOBJ0";
    ProgramScanner scanner(text, at + 5);
    if (!scanner.accept(':') || !scanner.accept('=')) return "WOBJ0";
    return std::string(scanner.word());
  }

  void go_to(std::string_view instruction, const std::vector<Bytes>& arguments) {
    const std::string tool(text_at(text_, without_switches(arguments.back())));
    const std::string wobj = wobj_of(arguments.back());
    const bool linear = !instruction.ends_with('J');
    bool any = false;
    for (std::size_t k = 0; k + 1 < arguments.size(); ++k) {
      const Bytes argument = without_switches(arguments[k]);
      const std::string name(text_at(text_, argument));
      const auto declared = targets_.find(name);
      if (declared != targets_.end()) {
        use(declared->second, argument.begin, tool, wobj, linear);
        any = true;
      } else if (const auto data = rapid_target(text_, argument)) {
        add("target", argument.begin, *data, tool, wobj, linear);
        any = true;
      } else if (name.starts_with("OFFS") || name.starts_with("RELTOOL")) {
        leave(argument.begin, as_written(argument) +
                                  ": it is computed; it moves with the correction of its target");
        any = true;
      }
    }
    const Bytes first = without_switches(arguments[0]);
    if (!any && instruction.starts_with("MOVE") && first.end > first.begin) {
      leave(first.begin, as_written(first) + ": it is not declared here");
    }
  }

  void use(Declared& declared, std::size_t at, const std::string& tool, const std::string& wobj,
           bool linear) {
    const std::string name = as_written(declared.name);
    if (!declared.data) {
      leave(at, name + ": it is computed, not written");
      return;
    }
    if (declared.used) {
      const bool same = declared.data->joints || (declared.tool == tool && declared.wobj == wobj);
      if (!same) leave(at, name + ": it is used with another tool or work object than before");
      return;
    }
    declared.used = true;
    declared.tool = tool;
    declared.wobj = wobj;
    add(name, declared.at, *declared.data, tool, wobj, linear);
  }

  // A frame that is declared, given, or the one that is always there.
  [[nodiscard]] std::expected<Pose, std::string> frame(
      const std::map<std::string, DeclaredFrame>& declared, const GivenFrames& given,
      const std::string& name, std::string_view always, const char* option) const {
    if (name == always) return Pose{};
    const auto found = declared.find(name);
    if (found != declared.end() && found->second.X) return *found->second.X;
    if (found != declared.end()) return std::unexpected(name + " " + found->second.why_not);
    if (const Pose* X = given.find(name)) return *X;
    return std::unexpected(fmt::format("{0} is not declared here: {1} {0}=...", name, option));
  }

  void add(const std::string& name, std::size_t at, const RapidData& data, const std::string& tool,
           const std::string& wobj, bool linear) {
    ProgramTarget target;
    target.line = lines_.line_of(at);
    target.name = name;
    target.joints = data.joints;
    target.linear = linear;
    target.numbers = data.lists[0];
    if (!data.joints) {
      const auto X_FT = frame(tools_, frames_.tools, tool, "TOOL0", "--tool");
      const auto X_BW = frame(wobjs_, frames_.frames, wobj, "WOBJ0", "--frame");
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
    program_.targets.push_back(std::move(target));
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }

  std::string text_;
  std::string_view original_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  std::map<std::string, Declared> targets_;
  std::map<std::string, DeclaredFrame> tools_;
  std::map<std::string, DeclaredFrame> wobjs_;
  Program program_;
};

}  // namespace

Program read_rapid(std::string_view text, const ProgramFrames& frames) {
  return RapidReader(text, frames).read();
}

}  // namespace armsig::tool
