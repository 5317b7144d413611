// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/words.hpp"

#include <cmath>

#include <fmt/core.h>

#include "core/base/pose.hpp"

namespace armsig::tool {

std::string counted(std::size_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string reading_in_words(JointType type, double reading) {
  constexpr double kTooLongToSpell = 1e9;
  const bool turns = type == JointType::kRevolute;
  const double value = turns ? degrees(reading) : 1e3 * reading;
  const char* unit = turns ? "°" : " mm";
  return std::abs(value) < kTooLongToSpell ? fmt::format("{:.3f}{}", value, unit)
                                           : fmt::format("{:.3g}{}", value, unit);
}

std::string refusal_in_words(const Refusal& refusal, JointType type) {
  std::string phrase(describe(refusal.error));
  switch (refusal.error) {
    case Error::kTooFewPoints:
      return fmt::format("{}: {:.0f} of at least {:.0f}", phrase, refusal.found, refusal.needed);
    case Error::kArcTooShort:
      return type == JointType::kRevolute
                 ? fmt::format("{}: {:.2f}°, and at least {:.2f}° are needed", phrase,
                               degrees(refusal.found), degrees(refusal.needed))
                 : fmt::format(
                       "the stroke is too short to tell the axis: {:.3f} mm, and at least "
                       "{:.3f} mm are needed",
                       1e3 * refusal.found, 1e3 * refusal.needed);
    case Error::kRadiusTooSmall:
      return fmt::format("{}: radius {:.3f} mm, and at least {:.3f} mm are needed", phrase,
                         1e3 * refusal.found, 1e3 * refusal.needed);
    case Error::kNotACircle:
      return fmt::format("{}: residuals of {:.3f} mm, where {:.3f} mm would be plausible", phrase,
                         1e3 * refusal.found, 1e3 * refusal.needed);
    case Error::kTooManyOutliers:
      return fmt::format("{}: {:.0f} of {:.0f} points agree", phrase, refusal.found,
                         refusal.needed);
    default:
      return phrase;
  }
}

std::string remedy_in_words(Error error) {
  switch (error) {
    case Error::kTooFewPoints:
      return "more points in this sweep";
    case Error::kJointDidNotMove:
      return "rows at different readings of the swept joint";
    case Error::kCoincidentPoints:
      return "a target that the swept joint moves; is it fixed to a link beyond the joint?";
    case Error::kArcTooShort:
      return "a longer sweep";
    case Error::kRadiusTooSmall:
      return "a target further from the joint axis, for example on a bar";
    case Error::kTooManyOutliers:
      return "a sensor that sees the target; check for multipath and for a loose target";
    case Error::kNotACircle:
      return "a rigid target, held joints that stay still, and no coupled reading; "
             "check sigma_mm as well";
    case Error::kMirroredSense:
      return "readings that grow in the sense of the arm description, in a right-handed sensor "
             "frame; check the sign of the reading and the order of the sensor's axes";
    case Error::kReceiversCollinear:
      return "at least three receivers that do not stand on one line";
    case Error::kMirrorAmbiguity:
      return "a `facing` direction, or a receiver outside the plane of the others";
    case Error::kTemperatureImplausible:
      return "an air temperature in degrees Celsius";
    default:
      return "consistent measurements";
  }
}

std::string lines_in_words(const std::vector<std::size_t>& lines) {
  std::string words;
  for (std::size_t k = 0; k < lines.size();) {
    std::size_t last = k;
    while (last + 1 < lines.size() && lines[last + 1] == lines[last] + 1) ++last;
    if (!words.empty()) words += ", ";
    words += fmt::format("{}", lines[k]);
    if (last > k) words += fmt::format("{}{}", last > k + 1 ? " to " : ", ", lines[last]);
    k = last + 1;
  }
  return words;
}

std::string duration_in_words(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole >= 3600) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
  if (whole >= 60) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

std::string region_in_words(PredictedRegion region) {
  switch (region) {
    case PredictedRegion::kSignatureConfiguration:
      return "the signature configuration alone";
    case PredictedRegion::kMeasuredReadings:
      return "the readings measured";
    case PredictedRegion::kJointLimits:
      break;
  }
  return "the joint limits";
}

}  // namespace armsig::tool
