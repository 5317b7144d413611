// SPDX-License-Identifier: MIT
// Which of two models predicts poses better that neither was fitted to.
#pragma once

#include <limits>

#include "core/calibration/servo_readings.hpp"
#include "core/frames/alignment.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/controller/signature_record.hpp"

namespace armsig::controller {

struct HeldOutReport {
  std::size_t poses = 0;
  double candidate_rms_m = 0;
  double active_rms_m = 0;
  std::uint32_t active = 0;  // number of the signature compared with; 0: the drawing

  [[nodiscard]] bool is_better() const { return poses > 0 && candidate_rms_m < active_rms_m; }
};

// A candidate and the active model. The active one is laid over the candidate: its axes over the
// candidate's at the candidate's signature configuration, and there with the same target, as it
// would be taught, since sensor and target may have been moved. A signature is judged where it
// stood, too, and counts as well as it does best: laid over a noisy candidate it shares that
// candidate's error of place.
class HeldOutComparison {
 public:
  // `active` null: the drawing. Both records have one target, on the hand. Precondition: as many
  // joints in all three.
  HeldOutComparison(const SignatureRecord& candidate, const SignatureRecord* active,
                    const Arm& drawing);

  // A bounded step of laying one over the other; false if nothing is left to do.
  bool step();
  // The target was seen at p_S. Precondition: step() has returned false.
  void judge(const JointVector& readings, const Vector3& p_S);
  [[nodiscard]] HeldOutReport report() const;

 private:
  struct Predictor {
    kinematics::SModelChain<double> chain;
    calibration::ServoReadings joints;  // how far the chain's have turned
    Vector3 p_L = Vector3::Zero();      // of the target, in the last link frame
  };

  [[nodiscard]] static Pose last_frame(const Predictor& model, const JointVector& q);

  Predictor candidate_;
  Predictor active_;
  frames::Aligning aligning_;
  std::size_t poses_ = 0;
  double candidate_m2_ = 0;
  // The active model where it stood, with its own target. The drawing stood nowhere: infinite.
  Vector3 p_L_stood_ = Vector3::Zero();
  double stood_m2_ = std::numeric_limits<double>::infinity();
  Pose X_laid_;  // takes its sensor frame to the candidate's
  double laid_m2_ = 0;
};

}  // namespace armsig::controller
