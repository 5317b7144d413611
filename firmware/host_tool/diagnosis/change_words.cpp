// SPDX-License-Identifier: MIT
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/changes.hpp"
#include "firmware/host_tool/diagnosis/explanation.hpp"

namespace armsig::tool {
namespace {

std::string when(const Change& change) {
  if (!change.slow) return fmt::format("from line {} on", change.first_line);
  return fmt::format("from line {} to line {}", change.first_line, change.last_line);
}

std::string of_reading(JointType type, double off) {
  if (type == JointType::kPrismatic) return short_length(off);
  return fmt::format("{:+.3f}°", degrees(off));
}

// Those of its joints that are told; all of them where none is.
std::string of_readings(const Change& change, const Arm& arm) {
  const auto told = [&](Eigen::Index j) {
    return std::abs(change.size[j]) > kCertainSigmas * change.sigma[j];
  };
  bool any = false;
  for (Eigen::Index j = 0; j < change.size.size(); ++j) any = any || told(j);
  std::string words;
  for (Eigen::Index j = 0; j < change.size.size(); ++j) {
    if (any && !told(j)) continue;
    const JointType type = arm.joints[static_cast<std::size_t>(j)].type;
    words += fmt::format("{}joint {} by {}", words.empty() ? "" : ", ", j + 1,
                         of_reading(type, -change.size[j]));
  }
  return words;
}

// By a share of what was read or seen.
std::string share_in_words(const Change& change, const Arm& arm) {
  if (change.of == Change::Of::kGear) {
    const bool slides = arm.joints[change.index].type == JointType::kPrismatic;
    return fmt::format("joint {} {} {:.4f} times as far for the same reading", change.index + 1,
                       slides ? "moves" : "turns", 1 + change.size[0]);
  }
  return fmt::format("all lengths {}{} by {:.0f} ppm",
                     change.of == Change::Of::kSight ? "that the sensor sees " : "",
                     change.size[0] > 0 ? "grow" : "shrink", 1e6 * std::abs(change.size[0]));
}

std::string both_in_words(const Change& change) {
  return fmt::format(" the positions are shifted by {}, and target {} is another point, {} away",
                     short_length(change.parts_m[0]), change.index,
                     short_length(change.parts_m[1]));
}

std::string change_in_words(const Change& change, const Arm& arm) {
  const std::string by = short_length(change.shift_m);
  const std::string at = when(change);
  switch (change.of) {
    case Change::Of::kSensor:
      return change.slow ? fmt::format("the positions drift by {} {}", by, at)
                         : fmt::format("{} the positions are shifted by {}", at, by);
    case Change::Of::kTarget:
      return change.slow
                 ? fmt::format("target {} creeps by {} {}", change.index, by, at)
                 : fmt::format("{} target {} is another point, {} away", at, change.index, by);
    case Change::Of::kSensorAndTarget:
      return at + both_in_words(change);
    case Change::Of::kZeros:
      return fmt::format("{} several readings are off: {}", at, of_readings(change, arm));
    case Change::Of::kZero: {
      const std::string off = of_reading(arm.joints[change.index].type, -change.size[0]);
      return change.slow
                 ? fmt::format("the reading of joint {} drifts by {} {}", change.index + 1, off, at)
                 : fmt::format("{} the reading of joint {} is off by {}", at, change.index + 1,
                               off);
    }
    case Change::Of::kLink:
      return change.slow
                 ? fmt::format("the axis after joint {} creeps, and the target with it by {}, {}",
                               change.index + 1, by, at)
                 : fmt::format("{} the axis after joint {} stands elsewhere, and the target by {}",
                               at, change.index + 1, by);
    case Change::Of::kLoad:
      return fmt::format("{} the arm bends otherwise, by {}", at, by);
    case Change::Of::kGear:
    case Change::Of::kLengths:
    case Change::Of::kSight:
      return at + " " + share_in_words(change, arm);
    case Change::Of::kStrain:
    case Change::Of::kLag:
      break;
  }
  return {};
}

std::string strain_in_words(const Strains& size) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> in(strain_of(size));
  const auto axis = [&](int i) {
    const Vector3 u = in.eigenvectors().col(i);
    return fmt::format("({:+.2f}, {:+.2f}, {:+.2f})", u.x(), u.y(), u.z());
  };
  return fmt::format("lengths along {} are seen {:.0f} ppm longer than along {}", axis(2),
                     1e6 * (in.eigenvalues()[2] - in.eigenvalues()[0]), axis(0));
}

}  // namespace

std::string in_words(const Change& change, const Arm& arm) {
  if (change.of == Change::Of::kStrain) {
    return "the sensor's axes are not of one scale: " + strain_in_words(change.size);
  }
  if (change.of == Change::Of::kLag) {
    return fmt::format(
        "the positions lag the joint readings: by {:.2f} % of the way from the row before",
        1e2 * change.size[0]);
  }
  return "something changed while the arm was measured: " + change_in_words(change, arm);
}

std::string mend_of(const Change& change) {
  switch (change.of) {
    case Change::Of::kSensor:
      return "the sensor fixed to the ground that the arm stands on, and warm; the first pose "
             "measured once more at the end tells";
    case Change::Of::kTarget:
      return "a target that is fixed firmly; the first pose measured once more at the end tells";
    case Change::Of::kSensorAndTarget:
      return "the sensor and the target fixed firmly; the first pose measured once more at the end "
             "tells";
    case Change::Of::kZeros:
      return "zeros that stay: a look at what happened before that line (a collision, a homing, an "
             "exchanged drive)";
    case Change::Of::kZero:
      return fmt::format("a look at the encoder of joint {} and how it is clamped",
                         change.index + 1);
    case Change::Of::kLoad:
    case Change::Of::kLink:
      return "an arm that carries the same load all along, and touched nothing";
    case Change::Of::kGear:
      return fmt::format(
          "a look at the gear of joint {}, and at what was set in its drive before that line",
          change.index + 1);
    case Change::Of::kLengths:
    case Change::Of::kSight:
      return "arm and sensor warm before the first row is measured";
    case Change::Of::kLag:
      return "positions taken when the arm has come to rest, or one clock for positions and "
             "readings";
    case Change::Of::kStrain:
      return "a look at the sensor: its calibration, the places of its receivers or cameras";
  }
  return {};
}

}  // namespace armsig::tool
