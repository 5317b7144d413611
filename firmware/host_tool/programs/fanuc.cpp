// SPDX-License-Identifier: MIT
// Targets of FANUC's programs in text (.ls): the positions of /POS, poses (mm, W, P, R) or joint
// readings of group 1, with the numbers of their user frame and user tool.
#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 6> kFanucPose{"X", "Y", "Z", "W", "P", "R"};
constexpr std::array<std::string_view, 6> kFanucJoints{"J1", "J2", "J3", "J4", "J5", "J6"};

class FanucReader {
 public:
  FanucReader(std::string_view text, const ProgramFrames& frames)
      : text_(in_capitals(without_quotes(text))), lines_(text), frames_(frames) {}

  Program read() {
    const std::size_t positions = std::min(text_.find("\n/POS"), text_.size());
    find_positions(positions);
    find_changed_frames(positions);
    const std::vector<Bytes> motions = motions_before(positions);
    for (const Bytes& motion : motions) find_increments(motion);
    for (const Bytes& motion : motions) take_motion(motion);
    for (auto& [number, position] : positions_) {
      if (!position.used) leave(position.at, name_of(number) + ": no motion here goes to it");
    }
    return std::move(program_);
  }

 private:
  struct Position {
    std::size_t at = 0;
    Bytes body;
    bool used = false;
    bool incremental = false;  // a motion goes by it, not to it
  };

  // Without quoted text, remarks ("  3:  !Remark ;", "  4:  //J P[1] ... ;") and the names of
  // positions ("P[1:HOME]"). The semicolon at the end of a line stays.
  static std::string without_quotes(std::string_view text) {
    std::string plain = without_comments(text, {.to_end_of_line = '\0'});
    std::size_t begin = 0;
    while (begin < plain.size()) {
      const std::size_t end = std::min(plain.find('\n', begin), plain.size());
      std::size_t last = trimmed_bytes(plain, {begin, end}).end;
      if (last > begin && plain[last - 1] == ';') --last;
      const std::size_t remark = std::min({plain.find('!', begin), plain.find("//", begin), last});
      for (std::size_t k = remark; k < last; ++k) plain[k] = ' ';
      for (std::size_t at = plain.find('[', begin); at < last; at = plain.find('[', at + 1)) {
        const std::size_t close = std::min(plain.find(']', at), last);
        for (std::size_t k = plain.find(':', at); k < close; ++k) plain[k] = ' ';
      }
      begin = end + 1;
    }
    return plain;
  }

  static std::string name_of(int number) { return fmt::format("P[{}]", number); }

  // P[1], P[1:"name"]: its number; nothing of P[R[3]], which a register says.
  static std::optional<int> position_number(ProgramScanner& scanner) {
    if (!scanner.accept('[')) return std::nullopt;
    const std::string number(scanner.word());
    return parse_integer(number);
  }

  void find_positions(std::size_t from) {
    ProgramScanner scanner(text_, from);
    while (scanner.next_word()) {
      const std::size_t at = scanner.at();
      if (scanner.word() != "P") continue;
      const auto number = position_number(scanner);
      const std::size_t open = text_.find('{', at);
      if (!number || open == std::string::npos) continue;
      const std::size_t close = std::min(text_.find('}', open), text_.size());
      // Groups beyond the first are other machines'.
      const std::size_t group2 = text_.find("GP2", open);
      positions_.try_emplace(*number, Position{at, {open + 1, std::min(close, group2)}, false});
      scanner.go_to(close);
    }
  }

  // "UFRAME[2]=PR[3]": the program sets a frame while it runs.
  void find_changed_frames(std::size_t end) {
    ProgramScanner scanner(std::string_view(text_).substr(0, end));
    while (scanner.next_word()) {
      const std::size_t at = scanner.at();
      const std::string_view word = scanner.word();
      if ((word != "UFRAME" && word != "UTOOL") || !scanner.accept('[')) continue;
      const std::string number(scanner.word());
      // A number that a register has may be any.
      const bool direct = scanner.accept(']');
      if (!direct) scanner.go_to(std::min(text_.find("]]", scanner.at()), end) + 2);
      if (!scanner.accept('=') || scanner.peek() == '=') continue;
      const std::string key = std::string(word == "UFRAME" ? "UF" : "UT");
      changed_.try_emplace(key + (direct ? number : ""), lines_.line_of(at));
    }
  }

  // The line that sets it; 0 of none.
  [[nodiscard]] int changed_in(std::string_view which, std::string_view number) const {
    for (const std::string_view one : {number, std::string_view()}) {
      const auto found = changed_.find(std::string(which) + std::string(one));
      if (found != changed_.end()) return found->second;
    }
    return 0;
  }

  // "J P[1] 100% FINE", also with P[2] of an arc, on a line of its own: from the letter on.
  [[nodiscard]] std::vector<Bytes> motions_before(std::size_t end) const {
    std::vector<Bytes> motions;
    const std::string_view program = std::string_view(text_).substr(0, end);
    ProgramScanner scanner(program);
    while (scanner.next_word()) {
      const std::size_t at = scanner.at();
      const std::string_view word = scanner.word();
      const std::size_t behind = scanner.at();
      if (word.size() == 1 && std::string_view("JLCAS").contains(word[0])) {
        const std::string_view place = scanner.word();
        const bool motion = (place == "P" || place == "PR") && scanner.accept('[');
        if (motion) motions.push_back({at, std::min(program.find(';', at), end)});
      }
      scanner.go_to(behind);
    }
    return motions;
  }

  // `take`: (place, is a register, number) of each P[...] and PR[...] that the motion goes to.
  template <typename Take>
  void each_place(Bytes motion, const Take& take) const {
    ProgramScanner scanner(std::string_view(text_).substr(0, motion.end), motion.begin + 1);
    while (scanner.next_word()) {
      const std::size_t at = scanner.at();
      const std::string_view word = scanner.word();
      if (word != "P" && word != "PR") continue;
      // Registers behind a comma are those of offsets.
      const std::size_t before = trimmed_bytes(text_, {motion.begin, at}).end;
      const bool gone_to = before == motion.begin + 1 || text_[before - 1] == ':';
      const auto number = position_number(scanner);
      if (gone_to || (word == "P" && number)) take(at, word == "PR", number);
    }
  }

  [[nodiscard]] bool is_incremental(Bytes motion) const {
    ProgramScanner scanner(std::string_view(text_).substr(0, motion.end), motion.begin);
    while (scanner.next_word()) {
      if (scanner.word() == "INC") return true;
    }
    return false;
  }

  void find_increments(Bytes motion) {
    if (!is_incremental(motion)) return;
    each_place(motion, [&](std::size_t /*at*/, bool is_register, std::optional<int> number) {
      const bool written = !is_register && number.has_value();
      const auto found = written ? positions_.find(*number) : positions_.end();
      if (found != positions_.end()) found->second.incremental = true;
    });
  }

  void take_motion(Bytes motion) {
    const bool offset = text_at(text_, motion).contains("OFFSET");
    each_place(motion, [&](std::size_t at, bool is_register, std::optional<int> number) {
      if (is_register) {
        leave(at, place_at(at) + ": it is a register");
      } else if (!number) {
        leave(at, place_at(at) + ": a register says which position it is");
      } else {
        go_to(at, *number, offset);
      }
    });
  }

  // "PR[3]", "P[R[98]]".
  [[nodiscard]] std::string place_at(std::size_t at) const {
    std::size_t end = at;
    for (int depth = 0; end < text_.size() && text_[end] != '\n'; ++end) {
      if (text_[end] == '[') ++depth;
      if (text_[end] == ']' && --depth == 0) break;
    }
    std::string place = text_.substr(at, end + 1 - at);
    std::erase(place, ' ');
    return place;
  }

  void go_to(std::size_t at, int number, bool offset) {
    const auto found = positions_.find(number);
    if (found == positions_.end()) {
      leave(at, name_of(number) + ": it is not in /POS");
      return;
    }
    Position& position = found->second;
    if (offset) {
      program_.left.push_back({lines_.line_of(at),
                               name_of(number) + ": an offset moves it, with its correction",
                               true});
    }
    if (position.used) return;
    position.used = true;
    if (position.incremental) {
      leave(position.at, name_of(number) + ": a motion goes by it, not to it (INC)");
      return;
    }
    add(number, position);
  }

  // The number after NAME = or NAME :, in the body of a position.
  [[nodiscard]] std::optional<Bytes> value(const Position& position, std::string_view name) const {
    ProgramScanner scanner(std::string_view(text_).substr(0, position.body.end),
                           position.body.begin);
    while (scanner.next_word()) {
      if (scanner.word() != name) continue;
      if (scanner.accept('=') || scanner.accept(':')) return scanner.number();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::vector<Bytes>> values(
      const Position& position, std::span<const std::string_view> names) const {
    std::vector<Bytes> all;
    for (const std::string_view name : names) {
      const auto one = value(position, name);
      if (!one) return std::nullopt;
      all.push_back(*one);
    }
    return all;
  }

  // 0 is the world, or the flange.
  [[nodiscard]] std::optional<Pose> frame(const Position& position, std::string_view name,
                                          const GivenFrames& given) const {
    const auto number = value(position, name);
    const std::string n(number ? text_at(text_, *number) : std::string_view("F"));
    if (n == "0") return Pose{};
    const Pose* const X = given.find(n);
    return X != nullptr ? std::optional(*X) : std::nullopt;
  }

  [[nodiscard]] std::vector<double> external_axes(const Position& position) const {
    std::vector<double> all;
    for (const char* const axis : {"E1", "E2", "E3"}) {
      const auto number = value(position, axis);
      if (!number) break;
      all.push_back(values_at(text_, {*number})[0]);
    }
    return all;
  }

  // Why the place of a pose is not known; empty where it is.
  [[nodiscard]] std::string frames_unknown(const Position& position, bool tool, bool frame) const {
    struct Which {
      std::string_view key, words, option;
      bool known;
    };
    for (const Which& one :
         {Which{"UT", "user tool", "--tool", tool}, Which{"UF", "user frame", "--frame", frame}}) {
      const auto number = value(position, one.key);
      const std::string_view n = number ? text_at(text_, *number) : std::string_view("F");
      if (const int line = changed_in(one.key, n); n != "0" && line > 0) {
        return fmt::format("its {} {} is changed in line {}", one.words, n, line);
      }
      if (!one.known) {
        return fmt::format("its {} is not known: {} {}=...", one.words, one.option, n);
      }
    }
    return {};
  }

  void add(int number, const Position& position) {
    ProgramTarget target;
    target.line = lines_.line_of(position.at);
    target.name = name_of(number);
    const auto joints = values(position, kFanucJoints);
    const auto pose = values(position, kFanucPose);
    if (!joints && !pose) {
      leave(position.at, target.name + ": it has neither X to R nor J1 to J6");
      return;
    }
    target.joints = joints.has_value();
    target.numbers = joints ? *joints : *pose;
    target.values = values_at(text_, target.numbers);
    target.external = external_axes(position);
    const auto X_FT = frame(position, "UT", frames_.tools);
    const auto X_BW = frame(position, "UF", frames_.frames);
    if (!target.joints) {
      const std::string why = frames_unknown(position, X_FT.has_value(), X_BW.has_value());
      if (!why.empty()) {
        leave(position.at, target.name + ": " + why);
        return;
      }
    }
    target.X_FT = X_FT.value_or(Pose{});
    target.X_BW = X_BW.value_or(Pose{});
    program_.targets.push_back(std::move(target));
  }

  void leave(std::size_t at, std::string what) {
    program_.left.push_back({lines_.line_of(at), std::move(what)});
  }

  std::string text_;
  LineNumbers lines_;
  const ProgramFrames& frames_;
  std::map<int, Position> positions_;
  std::map<std::string, int> changed_;  // "UF2", or "UF" of any number: with the line
  Program program_;
};

}  // namespace

Program read_fanuc(std::string_view text, const ProgramFrames& frames) {
  return FanucReader(text, frames).read();
}

}  // namespace armsig::tool
