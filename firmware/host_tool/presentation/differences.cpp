// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/differences.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/core.h>

#include "firmware/analysis/differences/differences.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

using differences::Cause;
using differences::DrawnAxis;
using differences::Heading;

const char* kind_of(Cause cause) {
  switch (cause) {
    case Cause::kTiltX:
    case Cause::kTiltY:
      return "tilt";
    case Cause::kShiftX:
    case Cause::kShiftY:
      return "shift";
    case Cause::kZero:
      return "zero";
    case Cause::kScale:
      return "scale";
    case Cause::kOnceATurn:
      return "once-a-turn";
    case Cause::kTwiceATurn:
      return "twice-a-turn";
    case Cause::kMap:
      return "map";
    case Cause::kGravity:
      return "gravity";
  }
  return "";
}

std::string tilt_in_words(const DrawnAxis& axis, std::size_t joint, bool about_x) {
  const std::size_t other = axis.other + 1;
  switch (axis.heading) {
    case Heading::kAlongAxis:
      return about_x ? fmt::format("tilt about axis {}", other)
                     : fmt::format("tilt towards the direction of axis {}", other);
    case Heading::kAwayFromAxis:
      return about_x ? fmt::format("tilt about the link from axis {} to {}", other, joint)
                     : fmt::format("tilt away from axis {}, in their plane", other);
    case Heading::kToTool:
      break;
  }
  return about_x ? "tilt about the direction to the tool" : "tilt towards the tool";
}

std::string shift_in_words(const DrawnAxis& axis, std::size_t joint, bool along_x) {
  const std::size_t other = axis.other + 1;
  switch (axis.heading) {
    case Heading::kAlongAxis:
      if (along_x) return fmt::format("shift along axis {}", other);
      if (axis.y_away == 0) return fmt::format("shift across axes {} and {}", other, joint);
      return fmt::format("shift {} axis {}", axis.y_away > 0 ? "away from" : "towards", other);
    case Heading::kAwayFromAxis:
      return along_x ? fmt::format("shift away from axis {}", other)
                     : fmt::format("shift out of the plane of axes {} and {}", other, joint);
    case Heading::kToTool:
      break;
  }
  return along_x ? "shift towards the tool" : "shift across the direction to the tool";
}

std::string words_of(const DrawnAxis& axis, std::size_t joint, Cause cause) {
  switch (cause) {
    case Cause::kTiltX:
    case Cause::kTiltY:
      return tilt_in_words(axis, joint, cause == Cause::kTiltX);
    case Cause::kShiftX:
    case Cause::kShiftY:
      return shift_in_words(axis, joint, cause == Cause::kShiftX);
    case Cause::kZero:
      return "zero of the reading";
    case Cause::kScale:
      return "scale of the reading";
    case Cause::kOnceATurn:
      return "joint error, once a turn";
    case Cause::kTwiceATurn:
      return "joint error, twice a turn";
    case Cause::kMap:
      return "joint error map";
    case Cause::kGravity:
      return "deflection by gravity";
  }
  return "";
}

const char* unit_of(JointType type, Cause cause) {
  if (cause == Cause::kScale) return "1";
  if (cause == Cause::kShiftX || cause == Cause::kShiftY) return "m";
  const bool of_motion = cause == Cause::kZero || cause == Cause::kMap || cause == Cause::kGravity;
  return of_motion && type == JointType::kPrismatic ? "m" : "rad";
}

bool varies(const DifferenceLine& line) { return line.kind == "map" || line.kind == "gravity"; }

std::string with_sigma(const DifferenceLine& line) {
  const double scale = line.unit == "rad" ? degrees(1.0) : line.unit == "m" ? 1e3 : 100;
  const char* unit = line.unit == "rad" ? "°" : line.unit == "m" ? " mm" : " %";
  if (varies(line)) return fmt::format("up to {:.4f}{}", scale * line.value, unit);
  if (!line.sigma) return fmt::format("{:+.4f}{}", scale * line.value, unit);
  return fmt::format("{:+.4f} ± {:.4f}{}", scale * line.value, scale * *line.sigma, unit);
}

// What the arm gives way by beyond its axes and readings; the drawing gives way by nothing.
differences::Bendings bendings_of(const SignatureRecord& record) {
  if (!record.deflections) return {};
  return {.drawn = {}, .actual = {record.deflections.get(), record.signature.configuration}};
}

}  // namespace

std::optional<DifferenceTable> difference_table(const SignatureRecord& record,
                                                const calibration::Refined* estimate) {
  const Signature& signature = record.signature;
  const auto tool = tool_target(signature);
  if (!tool || record.nominal.limits.size() != signature.joint_count() ||
      !std::ranges::equal(record.nominal.joints, signature.types, {}, &DhJoint::type)) {
    return std::nullopt;
  }
  auto exact = std::make_unique<calibration::Refined>();
  if (estimate == nullptr) {
    exact->signature = signature;
    exact->readings = record.readings();
    estimate = exact.get();
  }
  const auto found =
      differences::differences(record.nominal, *estimate, *tool, bendings_of(record));
  if (!found) return std::nullopt;
  DifferenceTable table{.lines = {}, .total_rms_m = found->total_rms_m};
  for (const differences::Difference& difference : found->all) {
    DifferenceLine line{
        .joint = difference.joint + 1,
        .kind = kind_of(difference.cause),
        .words = words_of(found->axes[difference.joint], difference.joint + 1, difference.cause),
        .unit = unit_of(signature.types[difference.joint], difference.cause),
        .value = difference.value,
        .sigma = {},
        .effect_rms_m = difference.effect.rms_m,
        .adds_m = difference.effect.adds_m};
    if (difference.sigma > 0) line.sigma = difference.sigma;
    table.lines.push_back(std::move(line));
  }
  return table;
}

std::optional<DifferenceTable> difference_table(const SignatureRecord& record) {
  const auto estimate = estimate_of(record, "");
  return difference_table(record, estimate ? estimate->get() : nullptr);
}

std::string in_words(const DifferenceTable& table, std::size_t joints) {
  Table text({"Joint", "Difference", "What", "Effect mm", "Adds mm"});
  std::size_t joint = 0;
  for (const DifferenceLine& line : table.lines) {
    text.add_row({line.joint == joint ? "" : fmt::format("{}", line.joint), with_sigma(line),
                  line.words, fmt::format("{:.3f}", 1e3 * line.effect_rms_m),
                  fmt::format("{:+.3f}", 1e3 * line.adds_m)});
    joint = line.joint;
  }
  text.add_row({"all", "", "base and tool fitted", fmt::format("{:.3f}", 1e3 * table.total_rms_m),
                fmt::format("{:+.3f}", 1e3 * table.total_rms_m)});
  return fmt::format(
      "What is different from the nominal model, and what it does to the tool\n\n{}{}",
      text.render(),
      paragraph(fmt::format(
          "Effect: what the line does to the tool by itself, RMS over the joint limits. Adds: its "
          "part along what all do together; these add up to the last line. Each axis on the link "
          "before, base and tool fitted; ± is 1 sigma. The base stands on axis 1: the zero of "
          "joint "
          "1 is the base's, that of joint {} the tool's.{}",
          joints,
          std::ranges::any_of(table.lines, varies)
              ? " Joint error map and gravity: the largest change from the signature "
                "configuration within the joint limits."
              : "")));
}

nlohmann::ordered_json json_of(const DifferenceTable& table) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const DifferenceLine& line : table.lines) {
    nlohmann::ordered_json json{{"joint", line.joint}, {"kind", line.kind}, {"what", line.words}};
    const std::string suffix = line.unit == "1" ? "" : "_" + line.unit;
    json["value" + suffix] = line.value;
    json["sigma" + suffix] =
        line.sigma ? nlohmann::ordered_json(*line.sigma) : nlohmann::ordered_json(nullptr);
    json["effect_rms_m"] = line.effect_rms_m;
    json["adds_m"] = line.adds_m;
    lines.push_back(std::move(json));
  }
  return {{"base_and_tool", "fitted"}, {"total_rms_m", table.total_rms_m}, {"joints", lines}};
}

}  // namespace armsig::tool
