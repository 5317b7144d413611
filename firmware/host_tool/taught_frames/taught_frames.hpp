// SPDX-License-Identifier: MIT
// Taught frames by the found model and by the nominal one: how well they are known, and what
// teaching by the nominal model costs (docs/model.md, section 14).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host_tool/taught_frames/found_poses.hpp"
#include "firmware/host_tool/taught_frames/taught_solution.hpp"

namespace armsig::tool {

enum class TeachSource : std::uint8_t {
  kResiduals,  // what the points beyond the minimum miss by
  kStated,     // by the person
  kAssumed,    // too few points beyond the minimum
};

// How well a point was taught.
struct TeachNoise {
  TeachSource source = TeachSource::kAssumed;
  double sigma_m = 0;       // per axis
  std::size_t freedom = 0;  // of the residuals, of all frames
};

inline constexpr double kAssumedTeach_m = 0.1e-3;

struct FoundFrame {
  SolvedFrame found;
  SolvedFrame nominal;
  // Of the found frame: its origin, and its turn about its own axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double apart_m = 0;  // the nominal frame from the found one
  double turned_rad = 0;

  [[nodiscard]] Vector3 origin_sigma_m() const;
  [[nodiscard]] Vector3 turn_sigma_rad() const;
};

struct TaughtFrames {
  std::vector<FoundFrame> frames;  // of the task
  TeachNoise teach;
  bool signature_counts = false;  // the covariance of the signature is part of every sigma
  std::vector<std::string> warnings;
};

// The poses of the flange at the rows of the task, by either model.
struct TaughtPoses {
  std::vector<Pose> found_X_CE;
  std::vector<Pose> nominal_X_CE;
};

// `derivatives`: null where the signature has no covariance. `teach_sigma_m`: as stated, or 0.
// Refuses what solved_frames() refuses.
[[nodiscard]] Read<TaughtFrames> taught_frames(const TaughtTask& task, const TaughtPoses& poses,
                                               const PoseDerivatives* derivatives,
                                               double teach_sigma_m);

}  // namespace armsig::tool
