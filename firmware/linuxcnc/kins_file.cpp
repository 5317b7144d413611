// SPDX-License-Identifier: MIT
#include "firmware/linuxcnc/kins_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/couplings.hpp"
#include "core/base/crc32.hpp"
#include "core/base/joint_range.hpp"

namespace armsig::linuxcnc {
namespace {

using Refused = std::optional<std::string_view>;  // why; nothing where all is well

// No number of an arm is larger, pseudo Denavit-Hartenberg rows of axes hardly off parallel
// included.
constexpr double kLargestNumber = 1e6;

class Words {
 public:
  explicit Words(std::string_view line) : left_(line) {}

  [[nodiscard]] std::string_view next() {
    const std::size_t begin = std::min(left_.find_first_not_of(" \t\r"), left_.size());
    left_.remove_prefix(begin);
    const std::string_view word = left_.substr(0, left_.find_first_of(" \t\r"));
    left_.remove_prefix(word.size());
    return word;
  }
  // Whether `word` is the next one, which is then taken.
  [[nodiscard]] bool take(std::string_view word) {
    Words behind = *this;
    if (behind.next() != word) return false;
    *this = behind;
    return true;
  }
  [[nodiscard]] bool number(double& value) {
    return whole(next(), value) && std::abs(value) <= kLargestNumber;
  }
  [[nodiscard]] bool numbers(std::span<double> values) {
    return std::ranges::all_of(values, [this](double& value) { return number(value); });
  }
  template <typename Integer>
  [[nodiscard]] bool integer(Integer& value) {
    return whole(next(), value);
  }
  // A joint, counted from 1 in the file, of `joints`.
  [[nodiscard]] bool joint(std::size_t joints, std::size_t& index) {
    if (!integer(index) || index < 1 || index > joints) return false;
    --index;
    return true;
  }
  [[nodiscard]] bool vector(Vector3& v) { return number(v.x()) && number(v.y()) && number(v.z()); }
  [[nodiscard]] bool end() { return next().empty(); }

 private:
  template <typename Number>
  static bool whole(std::string_view word, Number& value) {
    const auto [stopped, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return !word.empty() && error == std::errc() && stopped == word.data() + word.size();
  }

  std::string_view left_;
};

class Parser {
 public:
  [[nodiscard]] Refused take(std::string_view line) {
    Words words(line);
    const std::string_view key = words.next();
    if (key.empty() || key.front() == '#') return {};
    if (!tagged_) {
      tagged_ = key == "armsig" && words.next() == kKinsTag && words.end();
      if (tagged_) return {};
      return "not a file of armsig export in its format linuxcnc-kins, or of another version";
    }
    for (const auto& [name, handler] : kHandlers) {
      if (name != key) continue;
      if (const Refused refused = (this->*handler)(words)) return refused;
      if (!words.end()) return "more words than this line has";
      return {};
    }
    return "a line of no known kind";
  }

  [[nodiscard]] Refused finish() {
    const std::size_t joints = model_.arm.joints.size();
    if (joints == 0) return "no joint";
    if (!has_tip_) return "no tip";
    if (model_.deflections.empty()) {
      if (model_.deflections.gravity.empty() && model_.drawn.empty()) return {};
      return "gravity or a nominal model, but no maps";
    }
    if (model_.drawn.size() != joints) return "maps, but not every joint of the nominal model";
    if (model_.configuration.size() != joints) return "maps, but no configuration";
    for (std::size_t i = 0; i < joints; ++i) {
      const DhJoint& row = model_.drawn[i];
      model_.deflections.drawn_zero[i] = row.type == JointType::kRevolute ? row.theta_rad : row.d_m;
    }
    Arm nominal = model_.arm;
    nominal.joints = model_.drawn;
    if (!calibration::check(model_.deflections, nominal)) return "maps or gravity out of range";
    return {};
  }

  [[nodiscard]] const KinsModel& model() const { return model_; }

 private:
  struct Handler {
    std::string_view key;
    Refused (Parser::*take)(Words& words);
  };
  static const std::array<Handler, 9> kHandlers;

  Refused joint(Words& words) {
    if (model_.arm.joints.full()) return "more joints than 8";
    const std::string_view type = words.next();
    if (type != "revolute" && type != "prismatic") return "a joint is revolute or prismatic";
    DhJoint row;
    row.type = type == "revolute" ? JointType::kRevolute : JointType::kPrismatic;
    JointLimits limits;
    if (!row_numbers(words, row) || !limit_numbers(words, limits)) {
      return "a joint has four numbers and two limits";
    }
    if (is_endless(limits) && row.type == JointType::kPrismatic) {
      return "a prismatic joint has limits";
    }
    if (limits.lower > limits.upper) return "the limits are the wrong way round";
    model_.arm.joints.push_back(row);
    model_.arm.limits.push_back(limits);
    return {};
  }

  Refused coupling(Words& words) {
    JointCouplings& couplings = model_.arm.couplings;
    const std::size_t joints = model_.arm.joints.size();
    JointCoupling coupling;
    if (couplings.full()) return "more couplings than joints";
    if (!words.joint(joints, coupling.joint) || !words.joint(joints, coupling.from) ||
        !words.number(coupling.ratio)) {
      return "a coupling has two joints and a ratio";
    }
    couplings.push_back(coupling);
    if (leads_back(couplings, coupling.joint)) return "a joint hangs, through others, on itself";
    return {};
  }

  Refused tip(Words& words) {
    std::array<double, 4> q{};
    if (has_tip_) return "a second tip";
    if (!words.vector(model_.X_nL.p) || !words.numbers(q)) return "a tip has seven numbers";
    const Eigen::Quaterniond quaternion(q[0], q[1], q[2], q[3]);
    constexpr double kTolerance = 1e-9;
    if (!(std::abs(quaternion.norm() - 1) < kTolerance)) return "not a unit quaternion";
    model_.X_nL.R = quaternion.normalized().toRotationMatrix();
    has_tip_ = true;
    return {};
  }

  Refused tool(Words& words) {
    ToolPoint point;
    if (model_.tools.full()) return "more tools than 32";
    if (!words.integer(point.number) || !words.vector(point.p_nT)) {
      return "a tool has a number and three lengths";
    }
    model_.tools.push_back(point);
    return {};
  }

  Refused drawn(Words& words) {
    const std::size_t index = model_.drawn.size();
    if (index >= model_.arm.joints.size()) return "more joints drawn than there are";
    DhJoint row;
    row.type = model_.arm.joints[index].type;
    if (!row_numbers(words, row)) return "a joint is drawn by four numbers";
    model_.drawn.push_back(row);
    return {};
  }

  Refused configuration(Words& words) {
    if (!model_.configuration.empty()) return "a second configuration";
    model_.configuration.resize(model_.arm.joints.size());
    if (!words.numbers(std::span(model_.configuration.begin(), model_.configuration.end()))) {
      return "a configuration has a number a joint";
    }
    return {};
  }

  Refused map(Words& words) {
    auto& maps = model_.deflections.maps;
    std::size_t index = 0;
    calibration::PackedMap map;
    if (!words.joint(model_.arm.joints.size(), index) || index != maps.size()) {
      return "maps are in the order of the joints, one each";
    }
    if (!words.number(map.domain.origin) || !words.number(map.domain.per_length) ||
        !words.number(map.step)) {
      return "a map begins with three numbers";
    }
    for (std::int16_t& step : map.steps) {
      if (!words.integer(step)) return "a map has 120 whole numbers of 16 bits";
    }
    maps.push_back(map);
    return {};
  }

  Refused up(Words& words) {
    if (!words.vector(model_.deflections.up_0)) return "up has three numbers";
    return {};
  }

  Refused gravity(Words& words) {
    calibration::GravityTerm term;
    if (model_.deflections.gravity.full()) return "more gravity than 28 terms";
    std::size_t index = 0;
    if (!words.joint(model_.arm.joints.size(), index) || !words.integer(term.origin) ||
        !words.number(term.coefficient)) {
      return "gravity has a joint, an origin and a number";
    }
    term.joint = static_cast<std::uint8_t>(index);
    model_.deflections.gravity.push_back(term);
    return {};
  }

  // Two numbers, or the word for none.
  static bool limit_numbers(Words& words, JointLimits& limits) {
    if (words.take("none")) {
      limits = kNoLimits;
      return true;
    }
    return words.number(limits.lower) && words.number(limits.upper);
  }

  static bool row_numbers(Words& words, DhJoint& row) {
    return words.number(row.theta_rad) && words.number(row.d_m) && words.number(row.a_m) &&
           words.number(row.alpha_rad);
  }

  KinsModel model_;
  bool tagged_ = false;
  bool has_tip_ = false;
};

constexpr std::array<Parser::Handler, 9> Parser::kHandlers{{
    {"joint", &Parser::joint},
    {"coupling", &Parser::coupling},
    {"tip", &Parser::tip},
    {"tool", &Parser::tool},
    {"drawn", &Parser::drawn},
    {"configuration", &Parser::configuration},
    {"map", &Parser::map},
    {"up", &Parser::up},
    {"gravity", &Parser::gravity},
}};

// What stands before the seal, which is the last line; nothing where it is not right.
std::optional<std::string_view> sealed_part(std::string_view text) {
  constexpr std::string_view kSeal = "crc32 0x";
  constexpr std::size_t kDigits = 8;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  if (text.size() < kSeal.size() + kDigits) return {};
  const std::size_t at = text.size() - kSeal.size() - kDigits;
  if (text.substr(at, kSeal.size()) != kSeal) return {};
  std::uint32_t stated = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(end - kDigits, end, stated, 16);
  const std::string_view body = text.substr(0, at);
  const bool right =
      error == std::errc() && stopped == end && stated == crc32(std::as_bytes(std::span(body)));
  return right ? std::optional(body) : std::nullopt;
}

}  // namespace

std::expected<KinsModel, KinsRefusal> parse_kins(std::string_view text) {
  const auto body = sealed_part(text);
  if (!body) {
    return std::unexpected(KinsRefusal{
        0, "its last line is not the crc32 of the others: changed, damaged, or another file"});
  }
  Parser parser;
  std::string_view left = *body;
  for (std::size_t line = 1; !left.empty(); ++line) {
    const std::size_t length = std::min(left.find('\n'), left.size());
    if (const Refused refused = parser.take(left.substr(0, length))) {
      return std::unexpected(KinsRefusal{line, *refused});
    }
    left.remove_prefix(std::min(length + 1, left.size()));
  }
  if (const Refused refused = parser.finish()) return std::unexpected(KinsRefusal{0, *refused});
  return parser.model();
}

std::expected<KinsModel, KinsRefusal> read_kins(const char* path) {
  static std::array<char, kLargestKinsFile + 1> bytes;
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::unexpected(KinsRefusal{0, "it can't be opened"});
  std::size_t size = 0;
  ssize_t got = 0;
  while (size < bytes.size() &&
         (got = ::read(file, bytes.data() + size, bytes.size() - size)) > 0) {
    size += static_cast<std::size_t>(got);
  }
  ::close(file);
  if (got < 0) return std::unexpected(KinsRefusal{0, "it can't be read"});
  if (size > kLargestKinsFile) return std::unexpected(KinsRefusal{0, "larger than 64 kB"});
  return parse_kins({bytes.data(), size});
}

}  // namespace armsig::linuxcnc
