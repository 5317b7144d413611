// SPDX-License-Identifier: MIT
// The stated accuracy of a signature: how far the tool is from where the signature puts it. A
// figure is the root mean square of the lengths of the error over poses; its kind and its region
// are part of it. Figures of the two kinds are not comparable: the sensor's noise is in one of them
// alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace armsig {

// The poses over which a tool error is predicted.
enum class PredictedRegion : std::uint8_t {
  kSignatureConfiguration,  // one pose, which all sweeps pass
  kMeasuredReadings,        // spread over the readings that were measured
  kJointLimits,             // spread over the joint limits; of a controller inside of its workspace
};
// Their names in files, on the console and in a fleet's record.
inline constexpr std::array<std::string_view, 3> kPredictedRegions{"configuration", "measured",
                                                                   "limits"};
[[nodiscard]] constexpr std::string_view name(PredictedRegion region) {
  return kPredictedRegions[static_cast<std::size_t>(region)];
}

struct ToolAccuracy {
  // By the covariance of what was identified, 1 sigma. The sensor's noise is not in it.
  struct Predicted {
    double rms_m = 0;
    PredictedRegion region = PredictedRegion::kSignatureConfiguration;

    friend bool operator==(const Predicted&, const Predicted&) = default;
  };
  // On validation poses, which no fit has used. The sensor's noise is in it.
  struct Validated {
    double rms_m = 0;
    std::uint32_t poses = 0;  // 0: not recorded

    friend bool operator==(const Validated&, const Validated&) = default;
  };
  std::optional<Predicted> predicted;
  std::optional<Validated> validated;

  friend bool operator==(const ToolAccuracy&, const ToolAccuracy&) = default;
};

}  // namespace armsig
