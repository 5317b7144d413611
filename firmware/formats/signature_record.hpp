// SPDX-License-Identifier: MIT
// What a signature file holds: the signature, the arm it belongs to, and how it came about.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/arm.hpp"
#include "core/base/flight_time.hpp"
#include "core/base/tool_accuracy.hpp"
#include "core/calibration/model.hpp"
#include "core/calibration/parameters.hpp"
#include "core/calibration/readings.hpp"
#include "core/clearance/surroundings.hpp"
#include "core/signature.hpp"
#include "firmware/formats/origin.hpp"

namespace armsig::tool {

// How well the signature explains what it was fitted to, and rows that it was not fitted to.
struct FitRecord {
  std::size_t rows_used = 0;
  std::size_t rows_rejected = 0;
  double rms_m = 0;  // of the residual lengths of the rows used
  struct LeftOut {
    std::size_t rows = 0;
    double mean_m = 0;
    double rms_m = 0;
  };
  std::optional<LeftOut> left_out;  // cross-validated
  // Rows of the fit, where neighbours of a long log were merged; 0: each was fitted by itself.
  std::size_t rows_merged_to = 0;
};

struct SignatureRecord {
  Signature signature;
  std::string arm_name;
  std::vector<std::string> joint_names;  // one each as other software calls them, or none
  std::string serial;                    // may be empty
  std::string method;  // "paper", "encoder", "refined", or "exact": computed, not measured
  Arm nominal;         // the drawing: rows, limits, couplings; as many joints as the signature
  clearance::Mounting mounting;  // of that arm
  // What was fitted beside axes and targets (its unknowns are part of the covariance), and found.
  calibration::ParameterRequest fitted;
  FixedVector<calibration::ReadingCorrection, kMaxJoints> corrections;  // none, or one per joint
  FixedVector<double, kMaxReceivers> receiver_offsets_m;  // as many as receivers, where fitted
  double scale = 0;  // a measured length is (1 + scale) times the true one
  // 1-sigma squares and products of the parameters, and what they are ("axis lines, 4 a revolute
  // joint, 2 a prismatic one; m and rad"). Symmetric.
  std::optional<Eigen::MatrixXd> covariance;
  std::string covariance_of;
  std::optional<double>
      sigma_m;               // noise of the measurements per axis, 1 sigma: as stated, or as found
  double unexplained_m = 0;  // what the residuals show beyond it, 1 sigma per axis
  double noise_freedom = 0;  // degrees of freedom that either was found with; 0: none was
  ToolAccuracy accuracy;
  std::uint32_t controller_signature = 0;  // its number in a controller's store; 0: of no store
  std::optional<FitRecord> fit;
  std::optional<double> air_c;
  std::string time;     // UTC, ISO 8601: 1986-04-07T12:00:00Z
  std::string version;  // of the armsig that made it
  std::vector<std::string> warnings;
  std::optional<Origin> origin;  // the measurements it was found from; none where not known

  // Gravity and the joint error maps; none where they were not found.
  std::shared_ptr<const calibration::ArmModel> deflections;

  // From what the encoders read to how far the joints have turned. Points to `deflections`.
  [[nodiscard]] calibration::ReadingModel readings() const {
    return {nominal.couplings, corrections, deflections.get()};
  }
};

}  // namespace armsig::tool
