// SPDX-License-Identifier: MIT
#include "core/kinematics/cold_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/check.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/verdict.hpp"

namespace armsig::kinematics {
namespace {

constexpr double kSameSolution = 1e-4;  // rad or m
// Starting postures of arms without a closed form: this many at least, and up to the larger number
// until one solution is found.
constexpr int kFewestStarts = 40;
constexpr int kMostStarts = 400;

constexpr double kClearOfFolds = 0.03;  // regularity
constexpr int kIterationsPerStart = 50;

// Further starts next to a fold. The identified wrist doesn't pass exactly through straight: the
// two solutions near it may bend in any two directions.
constexpr std::array<Perturbation, 6> kFold = {
    {{1, 0}, {2, 0}, {4, 0}, {0.3, 0}, {7, 0}, {0.1, 0}}};
constexpr std::array<Perturbation, 6> kStraightWrist = {
    {{1, 0}, {4, 0}, {1, kPi / 2}, {1, -kPi / 2}, {0.3, kPi / 4}, {0.3, -kPi / 4}}};

// Whether the start led to its own posture, clear of the folds: then no other start is needed.
bool settled(const ClosedForm& form, const InverseSolution& solution, const Posture& posture) {
  return solution.verdict == Verdict::kConverged && solution.regularity > kClearOfFolds &&
         posture_of(form, solution.q) == posture;
}

// Where joint i is looked for: its limits, where they end; a turn, or an arm's length of travel,
// where they don't.
JointLimits range_of(const Chain& chain, std::size_t i) {
  const double whole = chain.revolute[i] ? 2 * kPi : 2 * chain.length;
  if (chain.limits.empty()) return {-0.5 * whole, 0.5 * whole};
  JointLimits range = chain.limits[i];
  const bool ends_below = std::isfinite(range.lower);
  const bool ends_above = std::isfinite(range.upper);
  if (!ends_below && !ends_above) return {-0.5 * whole, 0.5 * whole};
  if (!ends_below) range.lower = range.upper - whole;
  if (!ends_above) range.upper = range.lower + whole;
  return range;
}

JointVector fixed_start(const Chain& chain, int k) {
  JointVector q;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    const auto [lower, upper] = range_of(chain, i);
    q.push_back(lower + (upper - lower) * halton(i, k + 1));
  }
  return q;
}

// The reading that differs from `reading` by whole turns, inside the limits if there is one, and
// nearest to `reference`.
double best_turn(double reading, double reference, const JointLimits* limits) {
  const double change = reading - reference;
  const double nearest = std::abs(change) < kPi ? reading : reference + wrap_angle(change);
  if (limits == nullptr || (nearest >= limits->lower && nearest <= limits->upper)) return nearest;
  const double turns = nearest < limits->lower ? std::ceil((limits->lower - nearest) / (2 * kPi))
                                               : -std::ceil((nearest - limits->upper) / (2 * kPi));
  const double moved = nearest + turns * (2 * kPi);
  return moved >= limits->lower && moved <= limits->upper ? moved : nearest;
}

class Collector {
 public:
  Collector(const Chain& chain, const ClosedForm& form, const JointVector& reference,
            double rotation_tolerance_rad)
      : chain_(chain),
        form_(form),
        reference_(reference),
        rotation_tolerance_rad_(rotation_tolerance_rad) {
    if (!reference_.empty()) return;
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      const JointLimits range = range_of(chain, i);
      reference_.push_back(0.5 * (range.lower + range.upper));
    }
  }

  void add(InverseSolution solution) {
    if (solution.verdict != Verdict::kConverged && solution.verdict != Verdict::kDegraded) return;
    for (std::size_t i = 0; i < chain_.joint_count; ++i) {
      const JointLimits* limits = chain_.limits.empty() ? nullptr : &chain_.limits[i];
      if (chain_.revolute[i]) solution.q[i] = best_turn(solution.q[i], reference_[i], limits);
      if (limits == nullptr) continue;
      const bool inside = solution.q[i] >= limits->lower && solution.q[i] <= limits->upper;
      if (!inside) solution.verdict = Verdict::kJointLimit;
    }
    for (const NamedSolution& other : found_) {
      if (largest_change(other.solution.q, solution.q) < kSameSolution) return;
    }
    if (found_.full()) return;
    NamedSolution named;
    named.solution = solution;
    if (form_.design != Design::kOther) {
      named.named = true;
      named.posture = posture_of(form_, solution.q);
    }
    // Sorted by key().
    found_.push_back(named);
    for (std::size_t i = found_.size() - 1; i > 0 && key(found_[i]) < key(found_[i - 1]); --i) {
      std::swap(found_[i], found_[i - 1]);
    }
  }

  [[nodiscard]] const Solutions& found() const { return found_; }

 private:
  // Those inside the limits first, then those that meet the whole pose, then by distance from the
  // reference.
  [[nodiscard]] std::tuple<bool, bool, double> key(const NamedSolution& named) const {
    const InverseSolution& solution = named.solution;
    return {solution.verdict == Verdict::kJointLimit,
            solution.rotation_error_rad > rotation_tolerance_rad_,
            largest_change(solution.q, reference_)};
  }

  const Chain& chain_;
  const ClosedForm& form_;
  JointVector reference_;
  double rotation_tolerance_rad_;
  Solutions found_;
};

}  // namespace

Result<Solutions> cold_start(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
                             const JointVector& reference, const InverseOptions& options) {
  ARMSIG_CHECK(reference.empty() || reference.size() == chain.joint_count);
  ARMSIG_CHECK(form.design == Design::kOther || (chain.joint_count == 6 && !chain.has_prismatic));
  if (const auto error = refusal(X_0n, reference, options)) return std::unexpected(*error);
  InverseOptions unlimited = options;
  unlimited.max_step.clear();
  unlimited.respect_limits = false;
  Collector collector(chain, form, reference, options.rotation_tolerance_rad);
  if (!reference.empty()) {
    ARMSIG_TRY(solution, inverse(chain, X_0n, reference, unlimited));
    collector.add(solution);
  }
  unlimited.max_iterations = std::min(options.max_iterations, kIterationsPerStart);
  if (form.design != Design::kOther) {
    for (unsigned k = 0; k < 8; ++k) {
      const Posture posture{(k & 4U) != 0, (k & 2U) != 0, (k & 1U) != 0};
      const Start start = solve_closed_form(form, X_0n, posture);
      if (!start.reachable) continue;
      ARMSIG_TRY(solution, inverse(chain, X_0n, start.q, unlimited));
      collector.add(solution);
      if (!start.near_fold || settled(form, solution, posture)) continue;
      for (const Perturbation& perturbation : start.wrist_straight ? kStraightWrist : kFold) {
        const Start apart = solve_closed_form(form, X_0n, posture, perturbation);
        ARMSIG_TRY(other, inverse(chain, X_0n, apart.q, unlimited));
        collector.add(other);
      }
    }
    return collector.found();
  }
  // Without a closed form the limits keep the descent where the arm works.
  unlimited.respect_limits = true;
  for (int k = 0; k < kMostStarts; ++k) {
    if (k >= kFewestStarts && !collector.found().empty()) break;
    ARMSIG_TRY(solution, inverse(chain, X_0n, fixed_start(chain, k), unlimited));
    collector.add(solution);
  }
  return collector.found();
}

const char* name(const NamedSolution& solution) {
  if (!solution.named) return "solution";
  constexpr std::array<const char*, 8> kNames = {
      "righty below noflip", "righty below flip", "righty above noflip", "righty above flip",
      "lefty below noflip",  "lefty below flip",  "lefty above noflip",  "lefty above flip"};
  const Posture& p = solution.posture;
  return kNames[(p.lefty ? 4U : 0U) + (p.above ? 2U : 0U) + (p.flip ? 1U : 0U)];
}

}  // namespace armsig::kinematics
