// SPDX-License-Identifier: MIT
// How far the tool is from where a model puts it, all over the work volume: by the drawing, and
// with the signature.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/report/uncertain_signature.hpp"

namespace armsig::tool {

struct ToolErrorAt {
  Vector3 p_S = Vector3::Zero();
  double drawing_m = 0;               // distance of the drawing's tool from the signature's
  std::optional<double> predicted_m;  // 1 sigma of the signature's, all three directions together
  Vector3 variances_m2 = Vector3::Zero();  // of the signature's error, along its principal axes
  bool measured = true;  // each reading is within those measured, as far as is known
};

struct ToolErrorMap {
  // What the configurations are spread over evenly: the joint limits, or the readings measured
  // where joint error maps hold there alone.
  std::string over;
  std::vector<ToolErrorAt> points;
  double nominal_rms_m = 0;                       // over many more configurations
  std::optional<double> predicted_rms_m;          // as the record says, where it does
  std::optional<double> predicted_over_limits_m;  // where the region is smaller
  // Where the truth is known.
  std::optional<double> true_nominal_rms_m;
  std::optional<double> true_rms_m;
  // Share of the predicted variance that each joint's axis brings, of all axes.
  std::vector<double> joint_share;
};

// Nothing for an arm without a target on its last link. All in the sensor's frame: the drawing with
// base and tool fitted to the arm, the signature as it is. `estimate` may be null. `measured`: the
// reach of each joint's reading over what was measured; empty where that is not known.
[[nodiscard]] std::optional<ToolErrorMap> tool_error_map(
    const SignatureRecord& record, const calibration::Refined* estimate,
    const std::optional<SignatureRecord>& truth,
    const FixedVector<JointLimits, kMaxJoints>& measured = {});

}  // namespace armsig::tool
