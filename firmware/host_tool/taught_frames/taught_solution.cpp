// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/taught_solution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/taught_frames/frame_fit.hpp"
#include "firmware/host_tool/taught_frames/tip_fit.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kLeastTips = 3;
constexpr double kLeastTurn = radians(5);   // of the direction that turns least
constexpr double kLeastApart_m = 5e-3;      // of two points of a frame
constexpr double kLeastAngle = radians(2);  // of a point from an axis
constexpr double kWorstMiss_m = 10e-3;      // of touches of one point, RMS

// One frame of the task, and what its points say.
class FrameSolver {
 public:
  FrameSolver(const TaughtTask& task, const TaughtFrame& frame, const std::vector<Pose>& X_CE)
      : task_(task), frame_(frame), X_CE_(X_CE) {}

  Read<SolvedFrame> tool() {
    for (const std::size_t k : frame_.rows) {
      (point(k).axis < 0 ? tips_ : directions_).push_back(k);
    }
    if (tips_.size() < kLeastTips) {
      return refused(fmt::format("{} of one tip", counted(tips_.size(), "point")),
                     "three at the least, four or more with different orientations");
    }
    if (auto turned = check_turns(); !turned) return std::unexpected(std::move(turned).error());
    fit_ = fit_tip(poses(tips_));
    SolvedFrame solved = with_tip();
    if (solved.rms_m > kWorstMiss_m) {
      return refused(fmt::format("its touches miss one tip by {:.1f} mm RMS", 1e3 * solved.rms_m),
                     "touches of one fixed point; joints in the order of the arm description");
    }
    if (directions_.empty()) return solved;
    if (auto added = add_orientation(solved); !added) {
      return std::unexpected(std::move(added).error());
    }
    return solved;
  }

  // `tip`: the solved tool that touched the points; null where it is that of the task.
  Read<SolvedFrame> work_object(const SolvedFrame* tip) {
    const Vector3 t_E = tip != nullptr ? tip->X.p : task_.tip.t_E;
    std::vector<FramePoint> points;
    for (const std::size_t k : frame_.rows) points.push_back({X_CE_[k] * t_E, point(k).zero});
    ARMSIG_TRY(X_start, start_of(points));
    const auto fit = fit_frame(points, X_start, FrameOrigin::kToBeFound);
    if (!fit) return refused("its points do not determine a frame", kFrameNeeds);
    SolvedFrame solved = empty();
    solved.X = fit->X_AW;
    solved.residual_squares = fit->residual_squares();
    solved.freedom = fit->freedom;
    solved.rms_m = std::sqrt(solved.residual_squares / static_cast<double>(points.size()));
    if (solved.rms_m > kWorstMiss_m) {
      return refused("its points miss every frame by more than 10 mm RMS",
                     "the names of the points as they were taught");
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
      solved.misses_m.push_back(fit->residuals_W[n].norm());
      const std::size_t k = frame_.rows[n];
      const Eigen::MatrixXd by_point = fit->by_points.middleCols<3>(column(n, 3));
      solved.by_rows.middleCols<3>(column(k, 6)) += by_point;
      solved.by_rows.middleCols<3>(column(k, 6) + 3) -= by_point * cross_matrix(X_CE_[k].R * t_E);
      solved.by_tip += by_point * X_CE_[k].R;
    }
    if (tip != nullptr) solved.by_rows += solved.by_tip * tip->by_rows.topRows<3>();
    return solved;
  }

 private:
  static constexpr const char* kFrameNeeds =
      "`origin`, `x` and `xy` or `y`; or `x` twice and `y`, the first `x` nearer to the origin";

  [[nodiscard]] const TaughtPoint& point(std::size_t k) const { return *task_.rows[k].point; }

  [[nodiscard]] static Eigen::Index column(std::size_t n, std::size_t width) {
    return static_cast<Eigen::Index>(width * n);
  }

  [[nodiscard]] std::vector<Pose> poses(const std::vector<std::size_t>& rows) const {
    std::vector<Pose> of;
    for (const std::size_t k : rows) of.push_back(X_CE_[k]);
    return of;
  }

  [[nodiscard]] std::unexpected<Problem> refused(std::string what, std::string expected) const {
    return std::unexpected(
        Problem{task_.file, 0, 0,
                fmt::format("{} {}: {}", word_of(frame_.kind), in_quotes(frame_.name), what),
                std::move(expected)});
  }

  [[nodiscard]] SolvedFrame empty() const {
    SolvedFrame solved;
    solved.by_rows = Eigen::MatrixXd::Zero(6, column(task_.rows.size(), 6));
    return solved;
  }

  [[nodiscard]] Read<void> check_turns() const {
    const LeastTurned least = least_turned(poses(tips_));
    if (least.angle_rad >= kLeastTurn) return {};
    const Vector3& u = least.direction_E;
    return refused(
        fmt::format("along the direction {:.2f}, {:.2f}, {:.2f} of the flange its touches turn by "
                    "{:.1f} deg at most, and leave the tip open",
                    u.x(), u.y(), u.z(), degrees(least.angle_rad)),
        fmt::format("orientations that differ about two axes, by {:.0f} deg at the least; 30 deg "
                    "and more are better",
                    degrees(kLeastTurn)));
  }

  [[nodiscard]] SolvedFrame with_tip() const {
    SolvedFrame solved = empty();
    solved.X.p = fit_.t_E;
    solved.oriented = false;
    solved.residual_squares = fit_.residual_squares();
    solved.freedom = 3 * tips_.size() - 6;
    solved.rms_m = std::sqrt(solved.residual_squares / static_cast<double>(tips_.size()));
    solved.misses_m.resize(frame_.rows.size());
    for (std::size_t n = 0; n < tips_.size(); ++n) {
      solved.by_rows.block<3, 6>(0, column(tips_[n], 6)) =
          fit_.by_poses.block<3, 6>(0, column(n, 6));
      solved.misses_m[place(tips_[n])] = fit_.residuals_C[n].norm();
    }
    return solved;
  }

  // The place of row `k` among those of the frame.
  [[nodiscard]] std::size_t place(std::size_t k) const {
    return static_cast<std::size_t>(std::ranges::find(frame_.rows, k) - frame_.rows.begin());
  }

  // The fixed tip as the tool's flange has it, from the tool's tip.
  [[nodiscard]] Vector3 fixed_tip_E(std::size_t k) const {
    return X_CE_[k].inverse() * fit_.tip_C - fit_.t_E;
  }

  // Of the directions along `axis`.
  [[nodiscard]] Vector3 sum_along(int axis) const {
    Vector3 sum = Vector3::Zero();
    for (const std::size_t k : directions_) {
      if (point(k).axis == axis) sum += point(k).sign * fixed_tip_E(k);
    }
    return sum;
  }

  struct Axes {
    int main = 0;  // taught first: it is kept
    int second = 0;
  };

  [[nodiscard]] Read<Axes> taught_axes() const {
    std::vector<int> axes;
    for (const std::size_t k : directions_) {
      if (std::ranges::find(axes, point(k).axis) == axes.end()) axes.push_back(point(k).axis);
      const double apart_m = fixed_tip_E(k).norm();
      if (apart_m >= kLeastApart_m) continue;
      return refused(fmt::format("at line {} the fixed tip is {:.1f} mm from the tool's tip",
                                 task_.rows[k].line, 1e3 * apart_m),
                     "5 mm at the least; 100 mm and more are better");
    }
    if (axes.size() != 2) {
      return refused(fmt::format("directions of {}", axes.size() == 1 ? "one axis" : "three axes"),
                     "directions of two axes, such as `x+` and `z+`; or none");
    }
    const double angle = std::asin(std::min(
        1.0, sum_along(axes[0]).normalized().cross(sum_along(axes[1]).normalized()).norm()));
    if (angle < kLeastAngle) {
      return refused("its directions are on one line", "directions at right angles");
    }
    return Axes{axes[0], axes[1]};
  }

  Read<void> add_orientation(SolvedFrame& solved) const {
    ARMSIG_TRY(axes, taught_axes());
    std::vector<FramePoint> points;
    for (const std::size_t k : directions_) {
      FramePoint of{fixed_tip_E(k), point(k).zero};
      // The first axis is kept, and the second says which way the third is.
      if (point(k).axis != axes.main) of.zero[static_cast<std::size_t>(axes.main)] = false;
      points.push_back(of);
    }
    const Pose start = frame_along(Vector3::Zero(), axes.main, sum_along(axes.main), axes.second,
                                   sum_along(axes.second));
    const auto fit = fit_frame(points, start, FrameOrigin::kKnown);
    if (!fit) return refused("its directions do not determine an orientation", "two directions");
    solved.X.R = fit->X_AW.R;
    solved.oriented = true;
    solved.residual_squares += fit->residual_squares();
    solved.freedom += fit->freedom;
    for (std::size_t n = 0; n < directions_.size(); ++n) {
      solved.misses_m[place(directions_[n])] = fit->residuals_W[n].norm();
      add_turn(directions_[n], fit->by_points.block<3, 3>(3, column(n, 3)), solved);
    }
    return {};
  }

  // What the pose of row `k`, the tip and the fixed tip do to the tool's orientation by way of the
  // row's direction R^T (tip_C - p) - t_E.
  void add_turn(std::size_t k, const Matrix3& by_direction, SolvedFrame& solved) const {
    const Matrix3 by_C = by_direction * X_CE_[k].R.transpose();
    auto turn = solved.by_rows.bottomRows<3>();
    turn.middleCols<3>(column(k, 6)) -= by_C;
    turn.middleCols<3>(column(k, 6) + 3) += by_C * cross_matrix(fit_.tip_C - X_CE_[k].p);
    for (std::size_t n = 0; n < tips_.size(); ++n) {
      const auto by_pose = fit_.by_poses.middleCols<6>(column(n, 6));
      turn.middleCols<6>(column(tips_[n], 6)) +=
          by_C * by_pose.bottomRows<3>() - by_direction * by_pose.topRows<3>();
    }
  }

  // The mean of the points called `name`; nothing where there are none.
  [[nodiscard]] std::optional<Vector3> mean_of(const std::vector<FramePoint>& points,
                                               std::string_view name) const {
    Vector3 sum = Vector3::Zero();
    double count = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (point(frame_.rows[n]).name != name) continue;
      sum += points[n].p_A;
      ++count;
    }
    if (count == 0) return std::nullopt;
    return Vector3(sum / count);
  }

  // Two points on the axis x, the second farther along it.
  [[nodiscard]] Read<std::pair<Vector3, Vector3>> axis_x(
      const std::vector<FramePoint>& points) const {
    std::vector<Vector3> along;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (point(frame_.rows[n]).name == "x") along.push_back(points[n].p_A);
    }
    const auto origin = mean_of(points, "origin");
    if (along.size() + (origin ? 1 : 0) < 2) {
      return refused(fmt::format("{} of its axis x", counted(along.size(), "point")), kFrameNeeds);
    }
    const Vector3 from = origin ? *origin : along.front();
    const Vector3 to = origin ? *mean_of(points, "x") : along.back();
    if ((to - from).norm() < kLeastApart_m) {
      return refused(
          fmt::format("the points of its axis x are {:.1f} mm apart", 1e3 * (to - from).norm()),
          "5 mm at the least; 100 mm and more are better");
    }
    return std::pair(from, to);
  }

  // From the points alone, each on its side.
  [[nodiscard]] Read<Pose> start_of(const std::vector<FramePoint>& points) const {
    ARMSIG_TRY(x, axis_x(points));
    const auto origin = mean_of(points, "origin");
    const auto on_y = mean_of(points, "y");
    const auto beside = on_y ? on_y : mean_of(points, "xy");
    if (!beside || (!origin && !on_y)) {
      return refused("no point beside its axis x that gives the origin or the plane", kFrameNeeds);
    }
    const Vector3 along = (x.second - x.first).normalized();
    const Vector3 from = *beside - x.first;
    const Vector3 across = from - along * along.dot(from);
    if (across.norm() < std::max(kLeastApart_m, std::sin(kLeastAngle) * from.norm())) {
      return refused(fmt::format("its points are on a line but for {:.1f} mm", 1e3 * across.norm()),
                     "a point far from the axis x");
    }
    const Vector3 foot = x.first + along * along.dot(from);
    return frame_along(origin ? *origin : foot, 0, along, 1, across);
  }

  const TaughtTask& task_;
  const TaughtFrame& frame_;
  const std::vector<Pose>& X_CE_;
  std::vector<std::size_t> tips_, directions_;
  TipFit fit_;
};

}  // namespace

Read<std::vector<SolvedFrame>> solved_frames(const TaughtTask& task,
                                             const std::vector<Pose>& X_CE) {
  std::vector<SolvedFrame> solved(task.frames.size());
  // Tools first: they touch the work objects.
  for (std::size_t f = 0; f < task.frames.size(); ++f) {
    if (task.frames[f].kind != TaughtFrameKind::kTool) continue;
    ARMSIG_TRY(tool, FrameSolver(task, task.frames[f], X_CE).tool());
    solved[f] = std::move(tool);
  }
  for (std::size_t f = 0; f < task.frames.size(); ++f) {
    if (task.frames[f].kind != TaughtFrameKind::kWorkObject) continue;
    const SolvedFrame* const tip = task.tip.frame ? &solved[*task.tip.frame] : nullptr;
    ARMSIG_TRY(object, FrameSolver(task, task.frames[f], X_CE).work_object(tip));
    solved[f] = std::move(object);
  }
  return solved;
}

}  // namespace armsig::tool
