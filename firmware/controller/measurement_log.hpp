// SPDX-License-Identifier: MIT
// Everything that a sequence has measured, of fixed capacity.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::controller {

// Where a program has no memory for a Refinement, nothing of what would call one is in its image.
#ifdef ARMSIG_NO_REFINEMENT
inline constexpr bool kMayRefine = false;
#else
inline constexpr bool kMayRefine = true;
#endif

// Of one joint. An image without memory for a refinement has less for the log as well.
inline constexpr std::size_t kMostSweepPoints = kMayRefine ? 60 : 52;
inline constexpr std::size_t kMostHeldOut = 16;
// Six joints of the most points each; more joints have fewer (check() of the configuration).
inline constexpr std::size_t kMostLogged = 6 * kMostSweepPoints + kMostHeldOut;

// Numbers as 32 bits, so that a small controller has room for all of them: readings to 3e-8 rad or
// m up to 64, places to 6e-8 m up to 128 m, both finer than what is told of them and than any
// sensor. A sigma to four in a thousand.
class LogEntry {
 public:
  LogEntry() = default;
  // `sweep`: joint from 1, 0: a held-out pose. `readings`: actual, at standstill. `sigma_m`: RMS
  // over the axes.
  LogEntry(std::size_t sweep, std::size_t pings, const JointVector& readings, const Vector3& p_S,
           double sigma_m)
      : sigma_(rounded(static_cast<float>(sigma_m))),
        pings_(static_cast<std::uint8_t>(pings)),
        sweep_and_joints_(static_cast<std::uint8_t>(sweep << 4U | readings.size())) {
    for (std::size_t i = 0; i < readings.size(); ++i) {
      readings_[i] = whole(readings[i], kReadingStep);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      p_S_[i] = whole(p_S(static_cast<Eigen::Index>(i)), kPlaceStep_m);
    }
  }

  [[nodiscard]] std::size_t sweep() const { return sweep_and_joints_ >> 4U; }
  [[nodiscard]] std::size_t pings() const { return pings_; }
  [[nodiscard]] double sigma_m() const {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(sigma_) << 16U));
  }
  [[nodiscard]] JointVector readings() const {
    JointVector readings;
    const std::size_t joints = sweep_and_joints_ & 0xFU;
    for (std::size_t i = 0; i < joints; ++i) readings.push_back(readings_[i] * kReadingStep);
    return readings;
  }
  [[nodiscard]] Vector3 p_S() const { return kPlaceStep_m * Vector3(p_S_[0], p_S_[1], p_S_[2]); }

  static constexpr double kReadingStep = 0x1p-25;
  static constexpr double kPlaceStep_m = 0x1p-24;

 private:
  static std::int32_t whole(double value, double step) {
    constexpr double kMost = 0x7FFFFFFF;
    return static_cast<std::int32_t>(std::lround(std::clamp(value / step, -kMost, kMost)));
  }

  // The upper half of a number in 32 bits.
  static std::uint16_t rounded(float value) {
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000U) >> 16U);
  }

  std::array<std::int32_t, kMaxJoints> readings_{};
  std::array<std::int32_t, 3> p_S_{};
  std::uint16_t sigma_ = 0;
  std::uint8_t pings_ = 0;
  std::uint8_t sweep_and_joints_ = 0;
};

// Room for the sweeps and the held-out poses, and for more where extend() has lent it.
class MeasurementLog {
 public:
  // What is lent outlives the log. To be called before the first entry.
  void extend(std::span<LogEntry> further) { further_ = further; }

  [[nodiscard]] std::size_t capacity() const { return kMostLogged + further_.size(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool full() const { return size_ == capacity(); }
  void clear() { size_ = 0; }
  // Precondition: not full().
  void push_back(const LogEntry& entry) { at(size_++) = entry; }
  [[nodiscard]] const LogEntry& operator[](std::size_t i) const {
    ARMSIG_CHECK(i < size_);
    return i < kMostLogged ? own_[i] : further_[i - kMostLogged];
  }

 private:
  LogEntry& at(std::size_t i) {
    ARMSIG_CHECK(i < capacity());
    return i < kMostLogged ? own_[i] : further_[i - kMostLogged];
  }

  std::array<LogEntry, kMostLogged> own_{};
  std::span<LogEntry> further_;
  std::size_t size_ = 0;
};

}  // namespace armsig::controller
