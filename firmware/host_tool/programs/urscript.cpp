// SPDX-License-Identifier: MIT
// Targets of URScript: poses p[x, y, z, rx, ry, rz] (m, rotation vector) and joint readings [q1,
// ... q6] (rad) in moves, or in a variable that a move names. set_tcp() says the tool.
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>

#include <fmt/core.h>

#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kNumbers = 6;

struct UrMove {
  std::string_view name;
  std::size_t targets = 1;
  bool linear = true;
};
constexpr std::array kUrMoves{
    UrMove{"movej", 1, false},  UrMove{"movel"}, UrMove{"movep"}, UrMove{"movec", 2},
    UrMove{"servoj", 1, false}, UrMove{"servoc"}};

struct UrLiteral {
  std::vector<Bytes> numbers;
  bool joints = false;
};

// p[...] or [...] of six numbers, and nothing behind them.
std::optional<UrLiteral> ur_literal(std::string_view text, Bytes bytes) {
  ProgramScanner scanner(text.substr(0, bytes.end), bytes.begin);
  UrLiteral literal;
  literal.joints = scanner.peek() == '[';
  if (!literal.joints && !scanner.accept('p')) return std::nullopt;
  auto numbers = scanner.list('[', ']');
  if (!numbers || numbers->size() != kNumbers || scanner.at() != bytes.end) return std::nullopt;
  literal.numbers = std::move(*numbers);
  return literal;
}

// "pose=p[...]": behind the name of a parameter of a move.
Bytes ur_argument(std::string_view text, Bytes bytes) {
  for (const std::string_view name : {"pose_via", "pose_to", "pose", "q", "x"}) {
    ProgramScanner scanner(text.substr(0, bytes.end), bytes.begin);
    if (scanner.word() != name || !scanner.accept('=')) continue;
    return trimmed_bytes(text, {scanner.at(), bytes.end});
  }
  return bytes;
}

// Functions whose poses are no targets.
constexpr std::array<std::string_view, 12> kUrNoTargets{
    "set_tcp",   "force_mode",      "pose_trans", "pose_add",     "pose_inv",   "pose_sub",
    "pose_dist", "get_inverse_kin", "speedl",     "wrench_trans", "point_dist", "interpolate_pose"};

class UrReader {
 public:
  UrReader(std::string_view text, const ProgramFrames& frames)
      : plain_(without_comments(text, {.to_end_of_line = '#'})), lines_(text), frames_(frames) {}

  Program read() {
    find_variables();
    find_parameters();
    ProgramScanner scanner(plain_);
    if (scanner.peek() != '\0' && is_word(scanner.peek())) take_word(scanner);
    while (scanner.next_word()) take_word(scanner);
    leave_the_rest();
    return std::move(program_);
  }

 private:
  struct Variable {
    std::vector<UrLiteral> values;
    bool computed = false;  // somewhere it gets what is no literal
    const Pose* tool = nullptr;
    bool used = false;
  };

  void find_variables() {
    for (std::size_t at = plain_.find('='); at != std::string::npos;
         at = plain_.find('=', at + 1)) {
      const bool compares = (at > 0 && std::string_view("=<>!").contains(plain_[at - 1])) ||
                            (at + 1 < plain_.size() && plain_[at + 1] == '=');
      if (compares) continue;
      const Bytes before = trimmed_bytes(plain_, {plain_.rfind('\n', at) + 1, at});
      if (is_within_call(before)) continue;
      // An element of a variable, name[3], is the variable's, and computed.
      const std::size_t bracket = plain_.substr(before.begin, before.end - before.begin).find('[');
      const bool element = bracket != std::string::npos;
      const std::size_t name_end = element ? before.begin + bracket : before.end;
      std::size_t begin = name_end;
      while (begin > before.begin && is_word(plain_[begin - 1])) --begin;
      const std::string name(text_at(plain_, {begin, name_end}));
      const std::size_t end = std::min(plain_.find('\n', at), plain_.size());
      const auto literal = ur_literal(plain_, trimmed_bytes(plain_, {at + 1, end}));
      Variable& variable = variables_[name];
      if (literal && !element) {
        variable.values.push_back(*literal);
      } else {
        variable.computed = true;
      }
    }
  }

  // A parenthesis is open there: "a=1.2" of a move is no variable.
  [[nodiscard]] bool is_within_call(Bytes line) const {
    const std::string_view text = text_at(plain_, line);
    return std::ranges::count(text, '(') > std::ranges::count(text, ')');
  }

  // A parameter of a function is another thing than the variable of its name.
  void find_parameters() {
    ProgramScanner scanner(plain_);
    for (bool more = !scanner.at_end(); more; more = scanner.next_word()) {
      const std::string_view word = scanner.word();
      if (word != "def" && word != "thread") continue;
      scanner.word();
      if (!scanner.accept('(')) continue;
      for (const Bytes& parameter : arguments_from(plain_, scanner.at(), ')')) {
        ProgramScanner name(plain_, parameter.begin);
        if (parameter.begin < parameter.end) {
          variables_[std::string(name.word())].computed = true;
        }
      }
    }
  }

  void take_word(ProgramScanner& scanner) {
    const std::size_t begin = scanner.at();
    const std::string_view word = scanner.word();
    const std::size_t behind = scanner.at();
    if (!scanner.accept('(')) {
      scanner.go_to(behind);
      return;
    }
    const auto arguments = arguments_from(plain_, scanner.at(), ')');
    scanner.go_to(behind);
    if (word == "set_tcp") set_tool(begin, arguments[0]);
    const auto* const move = std::ranges::find(kUrMoves, word, &UrMove::name);
    if (move == kUrMoves.end()) return;
    for (std::size_t k = 0; k < move->targets && k < arguments.size(); ++k) {
      take_target(*move, begin, ur_argument(plain_, arguments[k]), {});
    }
  }

  void set_tool(std::size_t at, Bytes argument) {
    auto literal = ur_literal(plain_, argument);
    const auto variable = variables_.find(std::string(text_at(plain_, argument)));
    if (!literal && variable != variables_.end() && !variable->second.computed &&
        variable->second.values.size() == 1) {
      literal = variable->second.values[0];
    }
    if (literal && !literal->joints) {
      taken_.insert(literal->numbers[0].begin);
      tools_.push_back(
          std::make_unique<Pose>(*pose_of(values_at(plain_, literal->numbers), kUrWriting)));
      tool_ = tools_.back().get();
      return;
    }
    tool_ = nullptr;
    tool_unknown_ = fmt::format("the tool that line {} computes is not known", lines_.line_of(at));
  }

  // The pose of get_inverse_kin(pose, qnear=...), and its `near`; nothing of other arguments.
  [[nodiscard]] std::optional<Bytes> inverse_of(Bytes argument, std::vector<double>& near) const {
    ProgramScanner scanner(std::string_view(plain_).substr(0, argument.end), argument.begin);
    if (scanner.word() != "get_inverse_kin" || !scanner.accept('(')) return std::nullopt;
    const auto arguments =
        arguments_from(std::string_view(plain_).substr(0, argument.end), scanner.at(), ')');
    if (arguments.back().end + 1 != argument.end) return std::nullopt;
    if (arguments.size() > 1) {
      ProgramScanner second(std::string_view(plain_).substr(0, arguments[1].end),
                            arguments[1].begin);
      const bool named = second.word() == "qnear" && second.accept('=');
      const Bytes value =
          trimmed_bytes(plain_, {named ? second.at() : arguments[1].begin, arguments[1].end});
      auto literal = ur_literal(plain_, value);
      const auto variable = variables_.find(std::string(text_at(plain_, value)));
      const bool known = variable != variables_.end() && !variable->second.computed &&
                         variable->second.values.size() == 1;
      if (!literal && known) literal = variable->second.values[0];
      if (!literal || !literal->joints) return std::nullopt;
      near = values_at(plain_, literal->numbers);
    }
    return ur_argument(plain_, arguments[0]);
  }

  void take_target(const UrMove& move, std::size_t at, Bytes argument,
                   const std::vector<double>& near) {
    std::vector<double> nearest;
    if (const auto pose = inverse_of(argument, nearest); pose && near.empty()) {
      take_target(move, at, *pose, nearest);
      return;
    }
    const std::string name(text_at(plain_, argument));
    if (const auto literal = ur_literal(plain_, argument)) {
      add(move, at, "target", *literal, near);
      return;
    }
    const auto variable = variables_.find(name);
    if (variable == variables_.end() || variable->second.computed) {
      leave(at, fmt::format("{}: it is computed, not written", name.empty() ? "target" : name));
      return;
    }
    Variable& found = variable->second;
    if (found.used) {
      if (found.tool != tool_now()) {
        program_.left.push_back({lines_.line_of(at), name + ": it is used with two tools", true});
      }
      return;
    }
    found.used = true;
    found.tool = tool_now();
    for (const UrLiteral& literal : found.values) {
      add(move, literal.numbers[0].begin, name, literal, near);
    }
  }

  // The function in whose parentheses a place is; empty outside of any.
  [[nodiscard]] std::string_view function_around(std::size_t at) const {
    int depth = 0;
    for (; at > 0 && plain_[at - 1] != '\n'; --at) {
      if (plain_[at - 1] == ')') ++depth;
      if (plain_[at - 1] != '(' || --depth >= 0) continue;
      std::size_t begin = at - 1;
      while (begin > 0 && is_word(plain_[begin - 1])) --begin;
      return std::string_view(plain_).substr(begin, at - 1 - begin);
    }
    return {};
  }

  // Poses that are written and that no move goes to: of variables, of functions of the program.
  void leave_the_rest() {
    for (std::size_t at = plain_.find("p["); at != std::string::npos;
         at = plain_.find("p[", at + 1)) {
      if (at > 0 && is_word(plain_[at - 1])) continue;
      const std::size_t end = std::min(plain_.find(']', at), plain_.size() - 1) + 1;
      const auto literal = ur_literal(plain_, {at, end});
      if (!literal || taken_.contains(literal->numbers[0].begin)) continue;
      const int line = lines_.line_of(at);
      const bool named =
          std::ranges::find(program_.left, line, &LeftAsItIs::line) != program_.left.end();
      const std::string_view function = function_around(at);
      if (named || std::ranges::find(kUrNoTargets, function) != kUrNoTargets.end()) continue;
      const Bytes before = trimmed_bytes(plain_, {plain_.rfind('\n', at) + 1, at});
      std::string_view name = "target";
      if (function.empty() && before.end > before.begin && plain_[before.end - 1] == '=') {
        const Bytes left = trimmed_bytes(plain_, {before.begin, before.end - 1});
        name = text_at(plain_, left);
        name = name.substr(name.find_last_of(" \t") + 1);
      }
      leave(at, std::string(name) + ": no move here goes to it");
    }
  }

  [[nodiscard]] const Pose* tool_now() const {
    if (tool_ != nullptr || !tool_unknown_.empty()) return tool_;
    return frames_.tools.find("");
  }

  void add(const UrMove& move, std::size_t at, const std::string& name, const UrLiteral& literal,
           const std::vector<double>& near) {
    taken_.insert(literal.numbers[0].begin);
    const Pose* const tool = tool_now();
    if (tool == nullptr && !literal.joints) {
      leave(at, name + ": " + (tool_unknown_.empty() ? kNoTool : tool_unknown_));
      return;
    }
    const Pose* const frame = frames_.frames.find("");
    ProgramTarget target;
    target.line = lines_.line_of(at);
    target.name = name;
    target.joints = literal.joints;
    target.linear = move.linear;
    target.near = near;
    target.numbers = literal.numbers;
    target.values = values_at(plain_, literal.numbers);
    if (frame != nullptr) target.X_BW = *frame;
    if (tool != nullptr) target.X_FT = *tool;
    program_.targets.push_back(std::move(target));
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }

  std::string plain_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  std::map<std::string, Variable> variables_;
  std::vector<std::unique_ptr<Pose>> tools_;
  const Pose* tool_ = nullptr;
  std::string tool_unknown_;
  std::set<std::size_t> taken_;  // where targets and tools begin
  Program program_;
};

}  // namespace

Program read_urscript(std::string_view text, const ProgramFrames& frames) {
  return UrReader(text, frames).read();
}

}  // namespace armsig::tool
