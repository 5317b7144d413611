// SPDX-License-Identifier: MIT
// What the checks of one signature have shown so far, and what the next one says with them: whether
// the arm is still the one that was accepted.
//
// The first checks that agree with the signature are the reference: what a signature leaves at
// every pose is the same each time and hides no change. From then on a large change is seen at
// once, by all poses of one check; a small one by the sum over many (core/drift/cusum.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "core/drift/cusum.hpp"
#include "core/drift/reference.hpp"

namespace armsig::controller {

inline constexpr std::size_t kMostCheckPoses = 16;
inline constexpr std::size_t kFewestCheckPoses = 6;

// The sum over checks, in sigma of a check: reference value, checks that make the reference, and
// the threshold by drift::threshold() for one false alarm in 1,000 arm-months of daily checks that
// are correlated by 0.3 and whose sigma is told a tenth too small (2026-11-22; a test computes it).
inline constexpr double kCheckReference = 2;
inline constexpr int kCheckBaseline = 20;
inline constexpr double kCheckThreshold = 8.7;

enum class CheckVerdict : std::uint8_t {
  kAsAccepted,
  kDrifting,        // the arm changes little by little
  kStepped,         // the arm changed at once
  kReferenceMoved,  // the sensor did, or the foot of the arm as a whole, and not the arm
  kNotMeasured,
};
[[nodiscard]] std::string_view describe(CheckVerdict verdict);

// One check, measured.
struct MeasuredCheck {
  FixedVector<drift::PoseResidual, kMostCheckPoses> poses;  // measured less what the signature says
  // Of each of them, which pose of the plan it is.
  FixedVector<std::uint8_t, kMostCheckPoses> places;
  double sigma_m = 0;  // one sigma of a component of a residual, of all poses together
};

struct CheckReport {
  CheckVerdict verdict = CheckVerdict::kNotMeasured;
  Vector3 mean_m = Vector3::Zero();  // of the residuals
  double rms_m = 0;                  // of their lengths
  double sigma_m = 0;                // of a component of their mean
  double sum = 0;                    // of the checks, in sigma; named above kCheckThreshold
  int learnt = 0;                    // checks that the reference is made of
};

// All that the checks of one signature have shown.
struct CheckState {
  using Small = Eigen::Vector3f;  // metres: what is kept needs no more digits
  struct Mean {
    Small sum = Small::Zero();
    std::uint16_t count = 0;
    void add(const Vector3& value) {
      sum += value.cast<float>();
      ++count;
    }
    [[nodiscard]] Vector3 value() const {
      return sum.cast<double>() / static_cast<double>(count == 0 ? 1 : count);
    }
  };

  std::uint32_t sequence = 0;  // of the signature
  std::int64_t identified_at_s = 0;
  int learnt = 0;  // checks that the reference is made of
  drift::State sum;
  std::array<Mean, kMostCheckPoses> reference;  // residuals of each pose
  std::array<Mean, kMostCheckPoses> since;      // less those, since the sum was last zero
  FixedVector<Small, kCheckBaseline> means;     // of the last checks, less the reference's
};

class CheckHistory {
 public:
  // Of what signature it is; forgets what was seen of another, and says so.
  bool begin(std::uint32_t sequence, std::int64_t identified_at_s);

  // All that it knows, to be kept and put back as it was.
  [[nodiscard]] const CheckState& state() const { return state_; }
  [[nodiscard]] CheckState& state() { return state_; }

  // The verdict with one more check, which is of no use afterwards (a small stack has no room for a
  // second one); `held_out_rms_m` is what the signature was accepted with. The poses of the first
  // check that agrees are those that the next ones are compared at.
  // Errors: kTooFewPoints (poses below kFewestCheckPoses), kNotFinite, kNotPositive, kSingular (the
  // poses stand on one line).
  [[nodiscard]] Result<CheckReport> take(MeasuredCheck& checked, double held_out_rms_m);

 private:
  void compare_at_known_places(MeasuredCheck& checked) const;
  [[nodiscard]] Result<CheckVerdict> against_reference(MeasuredCheck& less);
  [[nodiscard]] Result<CheckVerdict> by_the_sum(MeasuredCheck& less, double check_sigma_m);
  void learn(const MeasuredCheck& less);

  CheckState state_;
};

}  // namespace armsig::controller
