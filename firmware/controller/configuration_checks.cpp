// SPDX-License-Identifier: MIT
#include "firmware/controller/configuration_checks.hpp"

#include <cmath>

namespace armsig::controller {

std::unexpected<ConfigurationRefusal> refused(std::string_view setting, Error error,
                                              std::optional<std::size_t> joint, double found,
                                              double needed) {
  return std::unexpected(ConfigurationRefusal{setting, error, joint, found, needed});
}

Checked check_plausible(std::string_view setting, double value, const Bounds& bounds, Error error,
                        std::optional<std::size_t> joint) {
  if (!std::isfinite(value)) return refused(setting, Error::kNotFinite, joint);
  if (value <= 0 && bounds.lowest > 0) {
    return refused(setting, Error::kNotPositive, joint, value, bounds.lowest);
  }
  if (value >= bounds.lowest && value <= bounds.highest) return {};
  return std::unexpected(
      ConfigurationRefusal{.setting = setting,
                           .error = error,
                           .joint = joint,
                           .found = value,
                           .needed = value < bounds.lowest ? bounds.lowest : bounds.highest,
                           .reason = bounds.reason});
}

Checked check_each(std::string_view setting, const JointVector& values, const Arm& arm,
                   const JointBounds& bounds) {
  if (values.size() != arm.joints.size()) {
    return refused(setting, Error::kOutOfRange, {}, static_cast<double>(values.size()),
                   static_cast<double>(arm.joints.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto checked =
        check_plausible(setting, values[i], bounds.of(arm.joints[i].type), Error::kOutOfRange, i);
    if (!checked) return checked;
  }
  return {};
}

Checked check_count(std::string_view setting, std::size_t count, std::size_t least,
                    std::size_t most) {
  if (count >= least && count <= most) return {};
  return refused(setting, Error::kOutOfRange, {}, static_cast<double>(count),
                 static_cast<double>(count < least ? least : most));
}

Checked check_readings(std::string_view setting, const JointVector& q, const Arm& arm) {
  if (q.size() != arm.joints.size()) {
    return refused(setting, Error::kOutOfRange, {}, static_cast<double>(q.size()),
                   static_cast<double>(arm.joints.size()));
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = arm.limits[i];
    if (!std::isfinite(q[i])) return refused(setting, Error::kNotFinite, i);
    if (q[i] < lower || q[i] > upper) {
      return refused(setting, Error::kJointLimit, i, q[i], q[i] < lower ? lower : upper);
    }
  }
  return {};
}

}  // namespace armsig::controller
