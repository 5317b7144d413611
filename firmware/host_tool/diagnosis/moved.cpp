// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/moved.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace armsig::tool {
namespace {

constexpr std::size_t kBlocksOfPoses = 8;
constexpr int kTrySteps = 7;
constexpr int kFinalSteps = 20;
constexpr int kMovePasses = 4;
constexpr std::size_t kStarts = 2;  // by each measure
constexpr int kHalvings = 7;
constexpr int kOtherTool = 1 << 20;

double cost_of_trial(const NearFit& fit, const ArmLimits& limits, const Arm& arm) {
  return fit.clipped_m * (1 + fit.farthest(limits, arm));
}

// Where one sweep ends and the next begins; poses in eight parts. Ends with the number of rows.
std::vector<std::size_t> borders_of(const Evidence& evidence) {
  const auto& rows = evidence.rows;
  std::vector<std::size_t> borders{0};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].sweep != rows[k - 1].sweep) borders.push_back(k);
  }
  if (borders.size() > 2 * kMaxJoints || borders.size() < 3) {  // in no order of sweeps, or poses
    borders.clear();
    for (std::size_t k = 0; k < kBlocksOfPoses; ++k) {
      borders.push_back(k * rows.size() / kBlocksOfPoses);
    }
  }
  borders.push_back(rows.size());
  return borders;
}

void mark(Evidence& evidence, std::size_t begin, std::size_t end) {
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    evidence.rows[k].moved = k >= begin && k < end;
  }
}

struct Interval {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// The run of rows that gains most from being seen from the second place.
Interval best_run(const Evidence& evidence, const NearFit& fit) {
  const Pose X_MS = fit.X_SM.inverse();
  const double cap = 100 * fit.best_rms_m * fit.best_rms_m;
  Interval best;
  double most = 0;
  double sum = 0;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    const EvidenceRow& row = evidence.rows[k];
    const Vector3 here = row.p_S - fit.residuals_S[k];
    const Vector3 first = row.moved ? X_MS * here : here;
    const double plain = std::min(cap, (row.p_S - first).squaredNorm());
    const double moved = std::min(cap, (row.p_S - fit.X_SM * first).squaredNorm());
    if (sum <= 0) {
      sum = 0;
      begin = k;
    }
    sum += plain - moved;
    if (sum > most) {
      most = sum;
      best = {begin, k + 1};
    }
  }
  return best;
}

// The runs of whole blocks to start from. By all residuals where the sensor was moved between two
// blocks; by the best seven tenths of them where it was in the middle of one, whose other rows are
// then outliers.
std::vector<Interval> likely_runs(const Evidence& evidence, const ArmLimits& limits) {
  const std::vector<std::size_t> borders = borders_of(evidence);
  const std::size_t blocks = borders.size() - 1;
  struct Run {
    Interval run;
    double all = 0;
    double best = 0;
  };
  std::vector<Run> tried;
  Evidence trial = evidence;
  for (std::size_t i = 1; i < blocks; ++i) {
    for (std::size_t j = i + 1; j <= blocks; ++j) {
      mark(trial, borders[i], borders[j]);
      const auto fit = fit_near(trial, limits, kTrySteps);
      if (!fit) continue;
      const double strange = 1 + fit->farthest(limits, trial.arm);
      tried.push_back(
          {{borders[i], borders[j]}, fit->clipped_m * strange, fit->best_rms_m * strange});
    }
  }
  std::vector<Interval> runs;
  for (const auto by : {&Run::all, &Run::best}) {
    std::ranges::sort(tried, {}, by);
    for (std::size_t k = 0; k < std::min(kStarts, tried.size()); ++k) runs.push_back(tried[k].run);
  }
  return runs;
}

// From there row by row: the run that gains, and the fit with it, until neither changes.
std::optional<Moved> refined_run(const Evidence& evidence, const ArmLimits& limits, Interval run) {
  std::optional<Moved> found;
  Evidence trial = evidence;
  for (int pass = 0; pass < kMovePasses; ++pass) {
    mark(trial, run.begin, run.end);
    const auto fit = fit_near(trial, limits, kFinalSteps);
    if (!fit) break;
    if (!found ||
        cost_of_trial(*fit, limits, trial.arm) < cost_of_trial(found->fit, limits, trial.arm)) {
      found = Moved{.evidence = trial, .fit = *fit};
    }
    const Interval next = best_run(trial, *fit);
    if (next.end <= next.begin || (next.begin == run.begin && next.end == run.end)) break;
    run = next;
  }
  return found;
}

void describe_move(Moved& found) {
  Vector3 mean = Vector3::Zero();
  double count = 0;
  for (const EvidenceRow& row : found.evidence.rows) {
    if (!row.moved) continue;
    if (count == 0) found.first_line = row.line;
    found.last_line = row.line;
    mean += row.p_S;
    ++count;
  }
  if (count == 0) return;
  mean /= count;
  const Vector3 shift = mean - found.fit.X_SM.inverse() * mean;
  found.shift_m = shift.norm();
  if (found.shift_m > 0) found.along_S = shift / found.shift_m;
  found.turn_rad = angle_between(found.fit.X_SM.R, Matrix3::Identity());
}

}  // namespace

std::optional<Moved> find_moved_sensor(const Evidence& evidence, const ArmLimits& limits) {
  std::optional<Moved> found;
  for (const Interval& start : likely_runs(evidence, limits)) {
    auto refined = refined_run(evidence, limits, start);
    if (!refined) continue;
    if (found && cost_of_trial(found->fit, limits, evidence.arm) <=
                     cost_of_trial(refined->fit, limits, evidence.arm)) {
      continue;
    }
    found = std::move(refined);
  }
  if (found) describe_move(*found);
  return found;
}

std::optional<Moved> find_changed_tool(const Evidence& evidence, const ArmLimits& limits) {
  const std::size_t n = evidence.rows.size();
  if (n < 2 * kBlocksOfPoses) return std::nullopt;
  const int number = evidence.rows.back().target;
  const auto at = [&](std::size_t from) {
    Moved moved{.evidence = evidence, .fit = {}};
    for (std::size_t k = from; k < n; ++k) {
      if (moved.evidence.rows[k].target == number) moved.evidence.rows[k].target = kOtherTool;
    }
    if (const auto fit = fit_near(moved.evidence, limits, kTrySteps)) moved.fit = *fit;
    moved.first_line = evidence.rows[from].line;
    moved.last_line = evidence.rows.back().line;
    return moved;
  };
  std::optional<Moved> best;
  std::size_t from = 0;
  const auto consider = [&](std::size_t candidate) {
    Moved moved = at(candidate);
    if (moved.fit.joints.empty()) return;
    if (best && !(cost_of_trial(moved.fit, limits, evidence.arm) <
                  cost_of_trial(best->fit, limits, evidence.arm))) {
      return;
    }
    best = std::move(moved);
    from = candidate;
  };
  for (std::size_t k = 1; k < 2 * kBlocksOfPoses; ++k) consider(k * n / (2 * kBlocksOfPoses));
  std::size_t step = n / (4 * kBlocksOfPoses);
  for (int halving = 0; halving < kHalvings && step > 0; ++halving, step /= 2) {
    const std::size_t centre = from;
    if (centre > step) consider(centre - step);
    if (centre + step < n) consider(centre + step);
  }
  return best;
}

}  // namespace armsig::tool
