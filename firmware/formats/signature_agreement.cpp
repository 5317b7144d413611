// SPDX-License-Identifier: MIT
#include "firmware/formats/signature_agreement.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "core/base/links.hpp"
#include "core/pseudo_dh/pseudo_dh.hpp"

namespace armsig::tool {
namespace {

Read<void> check_pose(const Pose& X_SA, const Pose& X_SB, double tolerance, std::string what) {
  const double distance_m = (X_SA.p - X_SB.p).norm();
  const double angle_rad = angle_between(X_SA.R, X_SB.R);
  if (distance_m <= tolerance && angle_rad <= tolerance) return {};
  return problem_at(0, 0, fmt::format("{} by {:.3g} m and {:.3g} rad", what, distance_m, angle_rad),
                    fmt::format("agreement within {:g} m and rad", tolerance));
}

}  // namespace

Read<void> check_agreement(const Signature& signature, const Pose& X_S0) {
  constexpr double kBaseTolerance = 1e-9;
  constexpr double kChainTolerance = 1e-5;
  if (auto base = check_pose(X_S0, signature.X_SL[0], kBaseTolerance,
                             "the base pose and the frame of joint 1 differ");
      !base) {
    return base;
  }
  const Pose X_0F = dh_frames(signature.pseudo_dh, signature.configuration).back();
  const Pose X_FL = pseudo_dh::link_frame_in_dh_frame(signature.s_model.back());
  return check_pose(signature.X_SL[0] * X_0F * X_FL, signature.X_SL.back(), kChainTolerance,
                    "pseudo_dh and the link frames differ at the signature configuration");
}

bool is_utc_time(std::string_view text) {
  constexpr std::string_view kPattern = "0000-00-00T00:00:00Z";
  const auto fits = [](char c, char pattern) {
    return pattern == '0' ? c >= '0' && c <= '9' : c == pattern;
  };
  return text.size() == kPattern.size() && std::ranges::equal(text, kPattern, fits);
}

}  // namespace armsig::tool
