// SPDX-License-Identifier: MIT
// Free poses for the eye: by how much the signature misses each of them, and by how much it states
// that it does.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/calibration/refined.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/identification/nominal_fit.hpp"
#include "firmware/host_tool/report/measured_sweeps.hpp"

namespace armsig::tool {

struct PoseResidual {
  std::size_t line = 0;  // of the file, from 1
  int target = 0;
  JointVector q;                      // as the encoders read
  Vector3 p_S = Vector3::Zero();      // as measured
  Vector3 error_S = Vector3::Zero();  // measured less predicted
  double stated_m = 0;                // 1 sigma of its length, sensor included; 0: not known
  bool outlier = false;
  // Its component along the way that the target takes while one joint moves, a joint each; nothing
  // where the target stands on the joint's axis.
  FixedVector<std::optional<double>, kMaxJoints> along_m;

  [[nodiscard]] double length_m() const { return error_S.norm(); }
};

// Lengths of residuals beside those that the stated uncertainty leads to.
struct ResidualHistogram {
  double bin_m = 0;              // the first bin starts at zero
  std::vector<double> counts;    // the last bin holds everything beyond
  std::vector<double> expected;  // the same, of normal errors; empty where nothing is stated
};

struct PoseResiduals {
  std::vector<PoseResidual> poses;  // in the order of the file
  bool fitted = false;              // the signature was fitted to them
  ResidualSummary signature;        // outliers included
  std::size_t outliers = 0;
  std::optional<ResidualSummary> nominal;  // its base and tool fitted, outliers apart
  double stated_rms_m = 0;                 // 0: not known
  ResidualHistogram histogram;
};

// Nothing without free poses. `estimate` may be null: nothing is stated then.
[[nodiscard]] std::optional<PoseResiduals> pose_residuals(const SignatureRecord& record,
                                                          const MeasuredSweeps& measured,
                                                          const calibration::Refined* estimate);

// Probability that three normal errors, each of 1 sigma, give a length of at most `sigmas`.
[[nodiscard]] double length_probability(double sigmas);

}  // namespace armsig::tool
