// SPDX-License-Identifier: MIT
// Rows of a tool and of work objects, taught by poses of a flange that a test gives.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/host_tool/taught_frames/taught_solution.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/taught_frames/random_poses.hpp"

namespace armsig::taught {

class TaughtSession {
 public:
  void add(const std::string& frame, std::string_view point, const Pose& X_CE) {
    const auto* const known =
        std::ranges::find(tool::kTaughtPoints, point, &tool::TaughtPoint::name);
    // Readings are told apart only.
    rows_.push_back({rows_.size() + 2, frame, known, {static_cast<double>(rows_.size())}});
    poses_.push_back(X_CE);
  }

  [[nodiscard]] std::vector<Pose>& poses() { return poses_; }
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }
  [[nodiscard]] std::vector<tool::TaughtRow>& rows() { return rows_; }

  // The tip of the work objects is `tip`, a tool of the session, or t_E.
  [[nodiscard]] tool::TaughtTask task(std::string_view tip = "",
                                      const Vector3& t_E = Vector3::Zero()) const {
    auto task = tool::taught_task(rows_, "taught.csv");
    EXPECT_TRUE(task);
    task->tip = {.frame = task->tool_called(tip), .t_E = t_E, .words = std::string(tip)};
    return *task;
  }

 private:
  std::vector<tool::TaughtRow> rows_;
  std::vector<Pose> poses_;
};

// A six-point tool of these axes, and a three-point work object touched by it, with more points
// than the minimum.
struct TrueFrames {
  Pose X_ET{by_abc(20, -40, 10), Vector3(0.012, -0.034, 0.21)};
  Pose X_CW{by_abc(30, 5, -3), Vector3(0.7, 0.2, 0.1)};
  Vector3 tip_C{0.85, -0.12, 0.4};
  Matrix3 R0_CE = by_abc(10, 170, -5);  // of the flange where it points, and near where it touches
};

// `noise`: what is added to the touched position of each row.
template <typename Noise>
TaughtSession session_of(const TrueFrames& of, const Noise& noise) {
  TaughtSession session;
  const auto touch = [&](const std::string& frame, std::string_view point, const Matrix3& R_CE,
                         const Vector3& p_C) {
    session.add(frame, point, flange_at(R_CE, of.X_ET.p, p_C + noise()));
  };
  const Matrix3& R0 = of.R0_CE;
  touch("torch", "tip", R0, of.tip_C);
  touch("torch", "tip", by_abc(5, 25, -20) * R0, of.tip_C);
  touch("torch", "tip", by_abc(-30, -20, 15) * R0, of.tip_C);
  touch("torch", "tip", by_abc(10, 5, 35) * R0, of.tip_C);
  const auto seen_at = [&](const Vector3& fixed_T) {
    return Vector3(of.tip_C - R0 * of.X_ET.R * fixed_T);
  };
  touch("torch", "x-", R0, seen_at({-0.15, 0, 0}));
  touch("torch", "z+", R0, seen_at({0.02, 0, 0.15}));
  const auto on_table = [&](std::string_view point, const Vector3& p_W) {
    touch("table", point, R0, of.X_CW * p_W);
  };
  on_table("origin", {0, 0, 0});
  on_table("x", {0.25, 0, 0});
  on_table("xy", {0.05, 0.2, 0});
  on_table("xy", {0.3, 0.25, 0});
  return session;
}

inline Vector3 without_noise() { return Vector3::Zero(); }

}  // namespace armsig::taught
