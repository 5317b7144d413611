// SPDX-License-Identifier: MIT
// What is kept of a sweep while its points come, and the judgement of those that wait.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "core/features/gate.hpp"
#include "core/features/judging.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// Everything known of a sweep; plain data.
struct SweepState {
  std::size_t count = 0;
  std::size_t rejected = 0;  // of those judged
  bool sigma_is_known = false;
  Matrix3 latest_covariance_m2 = Matrix3::Identity();
  FixedVector<double, 3> distinct_readings;  // the first ones
  WaitingPoints waiting;                     // not judged for good
  // Whether `accepted` holds them already: the first points, as long as all agree.
  bool waiting_is_accepted = false;
  SweepStatistics accepted;
};

// Judges the waiting points and takes in the good ones, in the order of their arrival; a bounded
// step at a time. Points that are accepted already are examined again, by all; if one does not
// pass, all are judged together. `state` must outlive it, unchanged.
class Settling {
 public:
  explicit Settling(const SweepState& state);
  Settling(const Settling&) = delete;
  Settling& operator=(const Settling&) = delete;

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] const SweepStatistics& accepted() const { return accepted_; }
  [[nodiscard]] std::size_t rejected() const { return rejected_; }

 private:
  enum class Stage : std::uint8_t { kReview, kJudge, kTake, kOver };
  void review_next();
  void begin_judging();
  void take_next();

  const SweepState& state_;
  SweepStatistics accepted_;
  std::size_t rejected_;
  std::optional<Judging> judging_;
  std::size_t done_ = 0;  // points reviewed, or taken in
  Stage stage_ = Stage::kReview;
};

}  // namespace armsig::features
