// SPDX-License-Identifier: MIT
#include "firmware/fleet/wire/signature_document.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

using calibration::GravityTerm;
using calibration::kKnots;
using calibration::PackedDeflections;
using calibration::PackedMap;

constexpr double kLargestValue = 1e9;  // degrees or mm; an arm has none such
constexpr double kTravel_m = 1;

std::string_view unit_of(JointType type) { return type == JointType::kPrismatic ? "m" : "rad"; }

// The words of a document, one after the other.
class Words {
 public:
  explicit Words(std::string_view text) : left_(text) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  // Takes the next word where it is `name=...`: what is after it.
  std::optional<std::string_view> take(std::string_view name) {
    if (!left_.starts_with(name) || left_.substr(name.size(), 1) != "=") return std::nullopt;
    const std::string_view value = left_.substr(name.size() + 1, left_.find(' ') - name.size() - 1);
    left_.remove_prefix(name.size() + 1 + value.size());
    if (left_.size() == 1) return std::nullopt;  // a space at the end
    if (!left_.empty()) left_.remove_prefix(1);
    return value;
  }

 private:
  std::string_view left_;
};

template <typename Number>
bool read_number(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() &&
         std::abs(static_cast<double>(value)) < kLargestValue;
}

bool take_number(Words& words, const std::string& name, double& value) {
  const auto text = words.take(name);
  return text && read_number(*text, value);
}

// Numbers with commas between them, exactly as many.
template <typename Number>
bool read_list(std::string_view text, std::span<Number> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == values.size())) return false;
    if (!read_number(text.substr(0, comma), values[i])) return false;
    text.remove_prefix(std::min(text.size(), comma == text.npos ? text.size() : comma + 1));
  }
  return text.empty();
}

bool take_row(Words& words, std::size_t i, Arm& arm) {
  std::array<double, 4> row{};
  const bool good = take_number(words, fmt::format("theta{}_deg", i), row[0]) &&
                    take_number(words, fmt::format("d{}_mm", i), row[1]) &&
                    take_number(words, fmt::format("a{}_mm", i), row[2]) &&
                    take_number(words, fmt::format("alpha{}_deg", i), row[3]);
  if (!good) return false;
  DhJoint joint;
  joint.theta_rad = radians(row[0]);
  joint.d_m = 1e-3 * row[1];
  joint.a_m = 1e-3 * row[2];
  joint.alpha_rad = radians(row[3]);
  arm.joints.push_back(joint);
  arm.limits.push_back({.lower = -std::numbers::pi, .upper = std::numbers::pi});
  return true;
}

// Of all joints, or of none.
bool take_rest(Words& words, std::size_t i, JointType type, JointVector& configuration) {
  const auto text = words.take(fmt::format("rest{}_{}", i, unit_of(type)));
  if (!text) return configuration.empty();
  double reading = 0;
  if (configuration.size() + 1 != i || !read_number(*text, reading)) return false;
  configuration.push_back(reading);
  return true;
}

bool take_map(Words& words, std::size_t i, JointType type, PackedMap& map) {
  const std::string_view unit = unit_of(type);
  const auto steps_of = [&] { return words.take(fmt::format("map{}", i)); };
  const bool good =
      take_number(words, fmt::format("map{}_from_{}", i, unit), map.domain.origin) &&
      take_number(words, fmt::format("map{}_knots_per_{}", i, unit), map.domain.per_length) &&
      take_number(words, fmt::format("map{}_step_{}", i, unit), map.step);
  if (!good) return false;
  const auto steps = steps_of();
  return steps && read_list(*steps, std::span<std::int16_t>(map.steps));
}

bool take_gravity(std::string_view text, GravityTerm& term) {
  std::array<double, 3> values{};
  if (!read_list(text, std::span<double>(values))) return false;
  if (!(values[0] >= 1 && values[0] <= 8 && values[1] >= 1 && values[1] <= 8)) return false;
  term = {.joint = static_cast<std::uint8_t>(values[0] - 1),
          .origin = static_cast<std::uint8_t>(values[1]),
          .coefficient = values[2]};
  return true;
}

bool take_deflections(Words& words, DocumentedSignature& signature) {
  const Arm& arm = signature.arm;
  PackedDeflections& deflections = signature.deflections;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const JointType type = arm.joints[i].type;
    const std::string zero = fmt::format("zero{}_{}", i + 1, unit_of(type));
    deflections.maps.push_back({});
    if (!take_number(words, zero, deflections.drawn_zero[i]) ||
        !take_rest(words, i + 1, type, signature.configuration) ||
        !take_map(words, i + 1, type, deflections.maps[i])) {
      return false;
    }
  }
  // Documents of arms whose frame 0 has its z axis up do not say so.
  if (const auto up = words.take("up")) {
    std::array<double, 3> parts{};
    if (!read_list(*up, std::span<double>(parts))) return false;
    deflections.up_0 = Vector3(parts[0], parts[1], parts[2]);
  }
  while (!words.empty()) {
    const auto text = words.take("gravity");
    GravityTerm term;
    if (!text || deflections.gravity.full() || !take_gravity(*text, term)) return false;
    deflections.gravity.push_back(term);
  }
  return calibration::check(deflections, of_unknown_lengths(arm.joints.size())).has_value();
}

}  // namespace

Arm of_unknown_lengths(std::size_t joints) {
  constexpr double kShortest_m = 0.2;
  Arm arm;
  arm.joints.resize(joints);
  arm.joints[0].a_m = kShortest_m;
  return arm;
}

std::string signature_document(std::string_view rows, std::span<const JointType> types,
                               const PackedDeflections& deflections,
                               std::span<const double> configuration) {
  std::string text(rows);
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i] == JointType::kPrismatic) text += fmt::format(" type{}=prismatic", i + 1);
  }
  for (std::size_t i = 0; i < deflections.maps.size() && i < types.size(); ++i) {
    const PackedMap& map = deflections.maps[i];
    const std::string_view unit = unit_of(types[i]);
    text += fmt::format(" zero{}_{}={}", i + 1, unit, deflections.drawn_zero[i]);
    if (i < configuration.size())
      text += fmt::format(" rest{}_{}={}", i + 1, unit, configuration[i]);
    text += fmt::format(" map{0}_from_{1}={2} map{0}_knots_per_{1}={3} map{0}_step_{1}={4} map{0}=",
                        i + 1, unit, map.domain.origin, map.domain.per_length, map.step);
    for (std::size_t k = 0; k < kKnots; ++k) {
      text += fmt::format("{}{}", k == 0 ? "" : ",", map.steps[k]);
    }
  }
  if (const Vector3& up = deflections.up_0; up != Vector3::UnitZ() && !deflections.empty()) {
    text += fmt::format(" up={},{},{}", up.x(), up.y(), up.z());
  }
  for (const GravityTerm& term : deflections.gravity) {
    text += fmt::format(" gravity={},{},{}", term.joint + 1, term.origin, term.coefficient);
  }
  return text;
}

std::optional<DocumentedSignature> read_signature_document(std::string_view document) {
  DocumentedSignature signature;
  Arm& arm = signature.arm;
  Words words(document);
  while (arm.joints.size() < kMaxJoints && take_row(words, arm.joints.size() + 1, arm)) {
  }
  if (arm.joints.empty()) return std::nullopt;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto type = words.take(fmt::format("type{}", i + 1));
    if (!type) continue;
    if (*type != "prismatic") return std::nullopt;
    arm.joints[i].type = JointType::kPrismatic;
    arm.limits[i] = {.lower = 0, .upper = kTravel_m};
  }
  if (words.empty()) return signature;
  if (!take_deflections(words, signature)) return std::nullopt;
  return signature;
}

}  // namespace armsig::fleet
