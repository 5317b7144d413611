// SPDX-License-Identifier: MIT
// Points and poses that were logged at one time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/host_tool/joining/clocks.hpp"
#include "firmware/host_tool/joining/join.hpp"

namespace armsig::tool {

// A pose of the log, and what tells it from others: poses of one standstill are one.
struct Partner {
  const LoggedPose* pose = nullptr;  // null: none
  std::size_t group = 0;
};

// Both files on one clock.
class TimedFiles {
 public:
  // Refuses what clock_of() and check_order() refuse, and times of two kinds without an offset.
  [[nodiscard]] static Read<TimedFiles> open(const JointLog& log, const TrackedPoints& tracked,
                                             const JoinSettings& settings, const JointTypes& types);

  // The pose of each point.
  [[nodiscard]] std::vector<Partner> partners() const;
  // A row for each standstill.
  [[nodiscard]] Joined standstill_rows() const;
  // Where another offset of the clocks puts more points into standstills than `agreeing` are:
  // which, and the option to say so; else empty.
  [[nodiscard]] std::string doubt(std::size_t agreeing) const;

 private:
  TimedFiles(const JointLog& log, const TrackedPoints& tracked, const JoinSettings& settings,
             const JointTypes& types)
      : log_(log), tracked_(tracked), settings_(settings), types_(types) {}

  // The mean of its readings, as a row without a position.
  [[nodiscard]] MeasurementRow pose_of(const Standstill& still) const;
  // Nothing where they moved.
  [[nodiscard]] std::optional<Vector3> mean_of(std::span<const std::size_t> points) const;

  const JointLog& log_;
  const TrackedPoints& tracked_;
  const JoinSettings& settings_;
  const JointTypes& types_;
  Clock poses_;
  Clock points_;
  std::vector<Standstill> standstills_;
};

}  // namespace armsig::tool
