// SPDX-License-Identifier: MIT
// The arm of a signature file, from C++: armsig.h (units, frames, threads) with values in place of
// pointers. Nothing throws; armsig::load() allocates, nothing else does.
#pragma once

#include <armsig.h>

#include <array>
#include <cstddef>
#include <expected>
#include <memory>

namespace armsig {

using ToolPose = std::array<double, ARMSIG_POSE>;        // x, y, z, qw, qx, qy, qz
using Readings = std::array<double, ARMSIG_MAX_JOINTS>;  // those beyond the arm's joints are 0

struct AllReadings {
  std::size_t count = 0;
  std::array<Readings, ARMSIG_MAX_SOLUTIONS> readings{};
};

inline constexpr ToolPose kFlange{0, 0, 0, 1, 0, 0, 0};

class LoadedArm {
 public:
  template <typename T>
  using Answer = std::expected<T, armsig_status>;

  explicit LoadedArm(armsig_arm* arm) noexcept : arm_(arm) {}

  [[nodiscard]] std::size_t joint_count() const noexcept { return armsig_joint_count(arm_.get()); }

  [[nodiscard]] Answer<ToolPose> forward(const Readings& q,
                                         const ToolPose& tool = kFlange) const noexcept {
    ToolPose pose{};
    return answered(armsig_forward(arm_.get(), q.data(), tool.data(), pose.data()), pose);
  }
  [[nodiscard]] Answer<Readings> inverse(const ToolPose& pose, const Readings& seed,
                                         const ToolPose& tool = kFlange) const noexcept {
    Readings q{};
    return answered(armsig_inverse(arm_.get(), pose.data(), tool.data(), seed.data(), q.data()), q);
  }
  [[nodiscard]] Answer<AllReadings> solutions(const ToolPose& pose,
                                              const ToolPose& tool = kFlange) const noexcept {
    std::array<double, std::size_t{ARMSIG_MAX_SOLUTIONS} * ARMSIG_MAX_JOINTS> flat{};
    AllReadings all;
    const armsig_status status = armsig_solutions(arm_.get(), pose.data(), tool.data(), flat.data(),
                                                  ARMSIG_MAX_SOLUTIONS, &all.count);
    const std::size_t joints = joint_count();
    for (std::size_t k = 0; k < all.count * joints; ++k) {
      all.readings[k / joints][k % joints] = flat[k];
    }
    return answered(status, all);
  }
  // What a closed controller must be given.
  [[nodiscard]] Answer<ToolPose> compensate(const ToolPose& pose, const Readings& seed,
                                            const ToolPose& tool = kFlange) const noexcept {
    ToolPose corrected{};
    return answered(armsig_compensate(arm_.get(), pose.data(), tool.data(), seed.data(),
                                      corrected.data(), nullptr),
                    corrected);
  }
  // Of a target, along the axes of the sensor's frame.
  [[nodiscard]] Answer<std::array<double, 3>> sigma(const Readings& q, int target) const noexcept {
    std::array<double, 3> sigma_m{};
    return answered(armsig_sigma(arm_.get(), q.data(), target, sigma_m.data()), sigma_m);
  }
  [[nodiscard]] const armsig_arm* c() const noexcept { return arm_.get(); }

 private:
  struct Free {
    void operator()(armsig_arm* arm) const noexcept { armsig_free(arm); }
  };

  // Near a singularity an answer is one, too.
  template <typename T>
  static Answer<T> answered(armsig_status status, const T& value) noexcept {
    if (status == ARMSIG_OK || status == ARMSIG_SINGULAR) return value;
    return std::unexpected(status);
  }

  std::unique_ptr<armsig_arm, Free> arm_;
};

// The problem in words where the file can't be read. `nominal_model`: what the closed controller
// computes with, where it is not the nominal model of the signature.
[[nodiscard]] inline std::expected<LoadedArm, std::array<char, 512>> load(
    const char* path, const char* nominal_model = nullptr) noexcept {
  std::array<char, 512> problem{};
  armsig_arm* const arm = armsig_load(path, nominal_model, problem.data(), problem.size());
  if (arm == nullptr) return std::unexpected(problem);
  return LoadedArm(arm);
}

}  // namespace armsig
