// SPDX-License-Identifier: MIT
// What a signature file holds: the signature, the arm it belongs to, and how it came about.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/arm.hpp"
#include "core/signature.hpp"

namespace armsig::tool {

struct SignatureRecord {
  Signature signature;
  std::string arm_name;
  std::string serial;  // may be empty
  std::string method;  // "paper", "encoder", "refined", or "exact": computed, not measured
  Arm nominal;         // the drawing: rows, limits, couplings; as many joints as the signature
  // 1-sigma squares and products of the parameters, and what they are ("axis lines, 4 a revolute
  // joint, 2 a prismatic one; m and rad"). Symmetric.
  std::optional<Eigen::MatrixXd> covariance;
  std::string covariance_of;
  std::optional<double>
      sigma_m;  // noise of the measurements per axis, 1 sigma, as the fit found it
  std::optional<double> predicted_tool_error_m;  // RMS over the work volume
  std::optional<double> air_c;
  std::string time;     // UTC, ISO 8601: 1986-04-07T12:00:00Z
  std::string version;  // of the armsig that made it
  std::vector<std::string> warnings;
};

}  // namespace armsig::tool
