// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/merged_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/numerics/robust.hpp"

namespace armsig::tool {
namespace {

using calibration::FitRow;
using calibration::Observation;
using calibration::RowPart;

// Of a group's readings, in knots of the map: how far they span, and how far one may be from the
// line through them. Below kPointKnots one row stands for all of them.
constexpr double kSpanKnots = 1;
constexpr double kOffLine = 0.1;
constexpr double kPointKnots = 0.25;
// Where a joint has no map.
constexpr double kKnotAngle = radians(3);
constexpr double kKnotLength = 5e-3;
constexpr std::size_t kFewestMembers = 3;  // rows of a group
constexpr std::size_t kMostMembers = 1000;
constexpr double kGateOfScale = 6;     // of the scale of the distances from the line
constexpr double kNextOutside = 0.5;   // of the furthest: what goes with it
constexpr double kMostOutside = 0.25;  // of a group whose other rows are still merged

using Knots = Eigen::Matrix<double, kMaxJoints, 1>;
using Members = std::span<const std::uint32_t>;

// A group along the line of its readings: t in knots, about their mean.
struct Line {
  Knots mean = Knots::Zero();   // readings
  Knots slope = Knots::Zero();  // of the readings, by t
  std::vector<double> t;
  double variance = 0;            // of t
  double third = 0;               // moment of t
  Vector3 p_S = Vector3::Zero();  // of the positions beside the model's, at t = 0
  Vector3 dp_S = Vector3::Zero();
};

class Merging {
 public:
  using RowOf = std::function<FitRow(std::size_t)>;

  Merging(std::span<const Observation> log, std::span<const Sides> sides, const RowOf& row_of,
          const FitStart& start)
      : log_(log), sides_(sides), row_of_(row_of), start_(start) {
    knots_.setZero();
    for (std::size_t j = 0; j < start.model.joint_count(); ++j) {
      const calibration::JointModel& joint = start.model.joints[j];
      const double spacing = joint.type == JointType::kRevolute ? 1 / kKnotAngle : 1 / kKnotLength;
      knots_[static_cast<Eigen::Index>(j)] =
          joint.domain.per_length > 0 ? joint.domain.per_length : spacing;
    }
  }

  RowsToFit operator()() {
    beside_.reserve(log_.size());
    for (const Observation& row : log_) {
      beside_.emplace_back(row.p_S - position(row.readings, row.target));
    }
    gather();
    gate_m_ = kGateOfScale * scale_m();
    for (const Group& group : groups_) settle(group);
    std::ranges::sort(single_);
    for (const std::uint32_t k : single_) {
      parts_[k].first = static_cast<std::uint32_t>(result_.size());
      result_.push_back(row_of_(k));
      result_.back().index = parts_[k].first;
    }
    return {std::move(result_), std::move(parts_)};
  }

 private:
  struct Group {
    std::size_t first = 0;  // of order_
    std::size_t count = 0;
  };
  struct Open {
    std::vector<std::uint32_t> members;
    Knots lowest;
    Knots highest;
  };

  [[nodiscard]] Knots readings_of(std::uint32_t k) const {
    const JointVector& readings = log_[k].readings;
    Knots q = Knots::Zero();
    for (std::size_t j = 0; j < readings.size(); ++j) q[static_cast<Eigen::Index>(j)] = readings[j];
    return q;
  }

  [[nodiscard]] Vector3 position(const JointVector& readings, std::size_t index) {
    const calibration::ModelTarget& target = start_.targets[index];
    calibration::evaluate_chain(start_.model, readings, target.link, frames_);
    return frames_.X_SL * target.p_L;
  }

  // Runs of neighbours, a target each.
  void gather() {
    parts_.resize(log_.size());
    std::array<Open, kMaxTargets> open;
    for (std::uint32_t k = 0; k < log_.size(); ++k) {
      Open& run = open[log_[k].target];
      const Knots at = knots_.cwiseProduct(readings_of(k));
      if (!run.members.empty()) {
        const Knots lowest = run.lowest.cwiseMin(at);
        const Knots highest = run.highest.cwiseMax(at);
        if (run.members.size() < kMostMembers && alike(run.members.front(), k) &&
            (highest - lowest).maxCoeff() <= kSpanKnots) {
          run.lowest = lowest;
          run.highest = highest;
          run.members.push_back(k);
          continue;
        }
        close(run.members);
      }
      run = {{k}, at, at};
    }
    for (Open& run : open) close(run.members);
  }

  [[nodiscard]] bool alike(std::uint32_t a, std::uint32_t b) const {
    return log_[a].sweep == log_[b].sweep && sides_[a].sides == sides_[b].sides &&
           sides_[a].sided == sides_[b].sided;
  }

  // In halves where it is bent.
  void close(Members members) {
    if (members.size() < kFewestMembers) {
      single_.insert(single_.end(), members.begin(), members.end());
      return;
    }
    if (is_straight(members, line_through(members))) {
      groups_.push_back({order_.size(), members.size()});
      order_.insert(order_.end(), members.begin(), members.end());
      return;
    }
    close(members.first(members.size() / 2));
    close(members.subspan(members.size() / 2));
  }

  [[nodiscard]] Line line_through(Members members) const {
    const auto count = static_cast<double>(members.size());
    Line line;
    for (const std::uint32_t k : members) line.mean += readings_of(k) / count;
    const Knots way =
        knots_.cwiseProduct(readings_of(members.back()) - readings_of(members.front()));
    const Knots along = way.norm() > 0 ? Knots(way / way.norm()) : Knots(Knots::Zero());
    for (const std::uint32_t k : members) {
      const Knots from_mean = readings_of(k) - line.mean;
      const double t = along.dot(knots_.cwiseProduct(from_mean));
      line.t.push_back(t);
      line.variance += t * t / count;
      line.third += t * t * t / count;
      line.slope += t * from_mean / count;
      line.p_S += beside_[k] / count;
      line.dp_S += t * beside_[k] / count;
    }
    if (line.variance < kPointKnots * kPointKnots / 12) {
      line.variance = 0;
      line.slope.setZero();
      line.dp_S.setZero();
    } else {
      line.slope /= line.variance;
      line.dp_S /= line.variance;
    }
    return line;
  }

  // A group that one row stands for has no line: all of it lies within kPointKnots.
  [[nodiscard]] bool is_straight(Members members, const Line& line) const {
    const double most = line.variance > 0 ? kOffLine : kPointKnots;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Knots off = readings_of(members[i]) - line.mean - line.t[i] * line.slope;
      if (knots_.cwiseProduct(off).cwiseAbs().maxCoeff() > most) return false;
    }
    return true;
  }

  [[nodiscard]] Vector3 off_line(const Line& line, std::size_t i, std::uint32_t k) const {
    return beside_[k] - line.p_S - line.t[i] * line.dp_S;
  }

  // Of the distances of all rows from their lines.
  [[nodiscard]] double scale_m() const {
    numerics::LogHistogram squares;
    for (const Group& group : groups_) {
      const Members members = Members(order_).subspan(group.first, group.count);
      const Line line = line_through(members);
      const auto count = static_cast<double>(members.size());
      const double freedom = count - (line.variance > 0 ? 2 : 1);
      for (std::size_t i = 0; i < members.size(); ++i) {
        squares.add(off_line(line, i, members[i]).squaredNorm() * count / freedom);
      }
    }
    return numerics::robust_scale_m(squares);
  }

  // Takes out what lies outside the gate, what is furthest first: it draws the line to itself.
  void settle(const Group& group) {
    std::vector<std::uint32_t> members(
        order_.begin() + static_cast<std::ptrdiff_t>(group.first),
        order_.begin() + static_cast<std::ptrdiff_t>(group.first + group.count));
    std::vector<std::uint32_t> outside;
    const auto most = static_cast<std::size_t>(kMostOutside * static_cast<double>(members.size()));
    for (;;) {
      const Line line = line_through(members);
      double furthest_m = 0;
      for (std::size_t i = 0; i < members.size(); ++i) {
        furthest_m = std::max(furthest_m, off_line(line, i, members[i]).norm());
      }
      if (furthest_m <= gate_m_) {
        merge(members, line);
        break;
      }
      const double limit_m = std::max(gate_m_, kNextOutside * furthest_m);
      std::vector<std::uint32_t> inside;
      for (std::size_t i = 0; i < members.size(); ++i) {
        const bool is_inside = off_line(line, i, members[i]).norm() <= limit_m;
        (is_inside ? inside : outside).push_back(members[i]);
      }
      members = std::move(inside);
      if (outside.size() <= most && members.size() >= kFewestMembers) continue;
      single_.insert(single_.end(), members.begin(), members.end());
      break;
    }
    single_.insert(single_.end(), outside.begin(), outside.end());
  }

  // Two rows at which the values of the line have no covariance.
  void merge(Members members, const Line& line) {
    const auto count = static_cast<std::uint32_t>(members.size());
    const auto first = static_cast<std::uint32_t>(result_.size());
    double scatter_m2 = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      scatter_m2 += off_line(line, i, members[i]).squaredNorm();
    }
    const double share_m2 = scatter_m2 / count;
    double from = 0;
    double to = 1;
    if (line.variance > 0) {
      const double skew = line.third / line.variance;
      const double upper = 0.5 * (skew + std::sqrt(skew * skew + 4 * line.variance));
      const double weight = line.variance / (line.variance + upper * upper);
      const auto above =
          std::clamp(static_cast<std::uint32_t>(std::lround(weight * count)), 1U, count - 1);
      const double ratio = static_cast<double>(above) / (count - above);
      from = -std::sqrt(line.variance * ratio);
      to = std::sqrt(line.variance / ratio);
      add(members, line, from, count - above, share_m2);
      add(members, line, to, above, share_m2);
    } else {
      add(members, line, 0, count, share_m2);
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
      RowPart& part = parts_[members[i]];
      part.first = first;
      if (line.variance > 0) part.share = static_cast<float>((line.t[i] - from) / (to - from));
      part.beside = off_line(line, i, members[i]).cast<float>();
    }
  }

  void add(Members members, const Line& line, double t, std::uint32_t count, double share_m2) {
    FitRow row = row_of_(members.front());
    const Knots readings = line.mean + t * line.slope;
    for (std::size_t j = 0; j < row.readings.size(); ++j) {
      row.readings[j] = readings[static_cast<Eigen::Index>(j)];
    }
    row.p_S = position(row.readings, row.target) + line.p_S + t * line.dp_S;
    row.merged.count = count;
    row.merged.scatter_m2 = count * share_m2;
    row.index = static_cast<std::uint32_t>(result_.size());
    result_.push_back(row);
  }

  std::span<const Observation> log_;
  std::span<const Sides> sides_;
  const RowOf& row_of_;
  const FitStart& start_;
  Knots knots_;                  // a radian or metre
  std::vector<Vector3> beside_;  // measured, less the model's
  std::vector<std::uint32_t> order_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> single_;
  std::vector<RowPart> parts_;
  std::vector<FitRow> result_;
  calibration::ChainFrames frames_;
  double gate_m_ = 0;
};

}  // namespace

bool merges(std::span<const Observation> rows) {
  if (!calibration::kMergesRows || rows.size() <= kMostRowsUnmerged) return false;
  return std::ranges::all_of(rows, [&](const Observation& row) {
    return row.kind == calibration::ObservationKind::kPosition &&
           row.sigma_m == rows.front().sigma_m;
  });
}

RowsToFit merged(std::span<const Observation> log, std::span<const Sides> sides,
                 const std::function<FitRow(std::size_t)>& row_of, const FitStart& start) {
  ARMSIG_CHECK(sides.size() == log.size());
  return Merging(log, sides, row_of, start)();
}

void join_groups(std::span<FitRow> rows, std::span<const RowPart> parts) {
  std::vector<std::uint32_t> pose_of(rows.size());
  for (const FitRow& row : rows) pose_of[row.index] = row.pose;
  std::vector<std::uint32_t> root(rows.empty() ? 0 : rows.back().pose + 1);
  std::iota(root.begin(), root.end(), 0U);
  const auto root_of = [&](std::uint32_t pose) {
    while (root[pose] != pose) pose = root[pose] = root[root[pose]];
    return pose;
  };
  for (const RowPart& part : parts) {
    if (part.share == 0) continue;
    const std::uint32_t a = root_of(pose_of[part.first]);
    const std::uint32_t b = root_of(pose_of[part.first + 1]);
    root[std::max(a, b)] = std::min(a, b);
  }
  for (FitRow& row : rows) row.pose = root_of(row.pose);
  std::ranges::stable_sort(rows, {}, &FitRow::pose);
}

}  // namespace armsig::tool
