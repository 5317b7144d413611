// SPDX-License-Identifier: MIT
// How well a fit predicts poses that were held out of it, or that it would be without.
#pragma once

#include "core/calibration/engine.hpp"

namespace armsig::controller {

inline constexpr std::size_t kMostSelfHeldOut = 256;
// Fewer say too little to be believed.
inline constexpr std::size_t kFewestSelfHeldOut = 12;

// Poses held out of a fit, one after the other; and fitted ones, each judged by what the fit would
// be without it.
class HeldOutJudge {
 public:
  void add(const calibration::Engine& engine, const calibration::FitRow& row,
           const calibration::ChainFrames& frames);
  // A fitted row by its residual, and what was stated for it with the row: what it would be missed
  // by without it, by the linear fit (Cook and Weisberg, Residuals and Influence in Regression,
  // 1982, section 2.2). A direction that the row determines to more than nine tenths tells nothing.
  void add_fitted(const Vector3& residual, const calibration::Engine::Stated& with_it);

  [[nodiscard]] std::size_t count() const { return held_out_.size(); }

  struct Score {
    std::size_t poses = 0;
    std::size_t blunders = 0;  // among them, by the errors' own scale; they do not count below
    double rms_m = 0;          // of the errors, which the sensor has a part in
    // By which what the model leaves open exceeds what is stated, by all errors; at least 1.
    double factor = 1;
  };
  [[nodiscard]] Score score() const;

 private:
  // Of errors: their squared lengths, and what of these is expected of the rows themselves and of
  // what the model leaves open.
  template <typename Number>
  struct Squares {
    Number all_m2 = 0;
    Number row_m2 = 0;
    Number model_m2 = 0;
  };
  struct HeldOut {
    Squares<float> error;
    float normalised = 0;  // e^T S^-1 e
  };
  FixedVector<HeldOut, kMostSelfHeldOut> held_out_;
  Squares<double> fitted_;
};

}  // namespace armsig::controller
