// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/cold_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/base/check.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/motion_directions.hpp"
#include "core/kinematics/verdict.hpp"
#include "firmware/analysis/postures/posture_search.hpp"

namespace armsig::kinematics {
namespace {

constexpr double kSameSolution = 1e-4;  // rad or m
// Orientations that an arm of fewer than six joints misses by as much as this are as good as each
// other: an individual's axes are no straighter, and other postures miss them by far more.
constexpr double kSameOrientation = 0.02;  // rad
// Starting postures of arms without a closed form: this many at least, and up to the larger number
// until one solution is found.
constexpr int kFewestStarts = 40;
constexpr int kMostStarts = 400;

constexpr double kClearOfFolds = 0.03;  // regularity
constexpr int kIterationsPerStart = 50;

// Passes of a descent that is tried where none of the usual length led anywhere.
constexpr int kPatience = 4000;
// How far on both sides of a fold its other solution is looked for, in the joint that moves most.
constexpr std::array<double, 8> kBeside{0.02, -0.02, 0.1, -0.1, 0.4, -0.4, 1.2, -1.2};
// A reading beyond its limit by no more than this is at the limit [rad or m].
constexpr double kAtLimit = 1e-9;
// Two solutions are one posture where the pose is met halfway too [m and rad].
constexpr double kMetHalfway = 1e-7;

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
  Collector(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
            const JointVector& reference, double rotation_tolerance_rad)
      : chain_(chain),
        form_(form),
        X_0n_(X_0n),
        reference_(reference),
        rotation_tolerance_rad_(rotation_tolerance_rad) {
    if (!reference_.empty()) return;
    for (std::size_t i = 0; i < chain.joint_count; ++i) {
      const JointLimits range = range_of(chain, i);
      reference_.push_back(0.5 * (range.lower + range.upper));
    }
  }

  // Each revolute joint by the whole turns that bring it inside its limits, and to the reference.
  [[nodiscard]] JointVector turned(JointVector q) const {
    for (std::size_t i = 0; i < chain_.joint_count; ++i) {
      const JointLimits* limits = chain_.limits.empty() ? nullptr : &chain_.limits[i];
      if (chain_.revolute[i]) q[i] = best_turn(q[i], reference_[i], limits);
    }
    return q;
  }

  void add(InverseSolution solution) {
    if (solution.verdict != Verdict::kConverged && solution.verdict != Verdict::kDegraded) return;
    solution.q = turned(solution.q);
    for (std::size_t i = 0; i < chain_.joint_count; ++i) {
      const JointLimits* limits = chain_.limits.empty() ? nullptr : &chain_.limits[i];
      double& reading = solution.q[i];
      if (limits == nullptr) continue;
      const double nearest = std::clamp(reading, limits->lower, limits->upper);
      if (std::abs(reading - nearest) > kAtLimit) {
        solution.verdict = Verdict::kJointLimit;
      } else {
        reading = nearest;
      }
    }
    NamedSolution named;
    named.solution = solution;
    if (form_.design != Design::kOther) {
      named.named = true;
      named.posture = posture_of(form_, solution.q);
    }
    for (NamedSolution& other : found_) {
      if (!is_same_posture(other.solution, solution)) continue;
      if (key(named, 0) < key(other, 0)) other = named;
      return;
    }
    if (!found_.full()) {
      found_.push_back(named);
      return;
    }
    const auto worst = std::max_element(
        found_.begin(), found_.end(),
        [&](const NamedSolution& a, const NamedSolution& b) { return key(a, 0) < key(b, 0); });
    if (key(named, 0) < key(*worst, 0)) *worst = named;
  }

  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] const InverseSolution& operator[](std::size_t k) const {
    return found_[k].solution;
  }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] bool has_one_inside() const {
    return std::ranges::any_of(found_, [](const NamedSolution& named) {
      return named.solution.verdict != Verdict::kJointLimit;
    });
  }
  // In order.
  [[nodiscard]] const Solutions& sorted() {
    double nearest = std::numeric_limits<double>::infinity();
    for (const NamedSolution& named : found_) {
      nearest = std::min(nearest, named.solution.rotation_error_rad);
    }
    const double turned = nearest + kSameOrientation;
    for (std::size_t i = 1; i < found_.size(); ++i) {
      for (std::size_t k = i; k > 0 && key(found_[k], turned) < key(found_[k - 1], turned); --k) {
        std::swap(found_[k], found_[k - 1]);
      }
    }
    return found_;
  }

 private:
  // Those inside the limits first, then those that meet the whole pose, then those that miss the
  // orientation by little more than the best, then by distance from the reference.
  [[nodiscard]] std::tuple<bool, bool, bool, double> key(const NamedSolution& named,
                                                         double turned_rad) const {
    const InverseSolution& solution = named.solution;
    return {solution.verdict == Verdict::kJointLimit,
            solution.rotation_error_rad > rotation_tolerance_rad_,
            solution.rotation_error_rad > turned_rad, largest_change(solution.q, reference_)};
  }

  // Equal, or joined by a motion of the joints that leaves frame n where it is, either way round.
  [[nodiscard]] bool is_same_posture(const InverseSolution& a, const InverseSolution& b) const {
    const bool clear = std::max(a.regularity, b.regularity) > kClearOfFolds;
    JointVector change;
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < a.q.size(); ++i) {
      double apart = b.q[i] - a.q[i];
      if (chain_.revolute[i] && std::abs(apart) >= kPi) apart = wrap_angle(apart);
      if (clear && std::abs(apart) >= kSameSolution) return false;
      change.push_back(apart);
      if (std::abs(apart) > std::abs(change[farthest])) farthest = i;
    }
    if (std::abs(change[farthest]) < kSameSolution) return true;
    if (is_met_at(a.q, change)) return true;
    if (!chain_.revolute[farthest]) return false;
    change[farthest] -= std::copysign(2 * kPi, change[farthest]);
    return is_met_at(a.q, change);
  }

  // Halfway along `change` from q.
  [[nodiscard]] bool is_met_at(JointVector q, const JointVector& change) const {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += 0.5 * change[i];
    const auto X = forward(chain_, q);
    return X && (X->p - X_0n_.p).norm() < kMetHalfway && (X->R - X_0n_.R).norm() < kMetHalfway;
  }

  const Chain& chain_;
  const ClosedForm& form_;
  const Pose& X_0n_;
  JointVector reference_;
  double rotation_tolerance_rad_;
  Solutions found_;
};

// Starts of one request, and what they lead to.
class ColdStart {
 public:
  ColdStart(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
            const JointVector& reference, const InverseOptions& options)
      : chain_(chain),
        form_(form),
        X_0n_(X_0n),
        anywhere_(options),
        collector_(chain, form, X_0n, reference, options.rotation_tolerance_rad) {
    anywhere_.max_step.clear();
    anywhere_.respect_limits = false;
  }

  Result<Solutions> run(const JointVector& reference) {
    if (!reference.empty()) {
      if (const auto led = from(reference, anywhere_); !led) return std::unexpected(led.error());
    }
    ARMSIG_TRY(complete, from_closed_form());
    if (complete) return collector_.sorted();
    if (can_search_postures(chain_)) {
      const PostureStarts starts = search_postures(chain_, X_0n_);
      for (const JointVector& start : starts) {
        if (const auto led = from(start, anywhere_); !led) return std::unexpected(led.error());
      }
      if (collector_.empty()) {
        if (const auto led = from_patiently(starts); !led) return std::unexpected(led.error());
      }
      if (const auto led = from_beside(); !led) return std::unexpected(led.error());
    } else if (const auto led = from_fixed_starts(); !led) {
      return std::unexpected(led.error());
    }
    return collector_.sorted();
  }

 private:
  Result<InverseSolution> from(const JointVector& start, const InverseOptions& options) {
    ARMSIG_TRY(solution, inverse(chain_, X_0n_, start, options));
    collector_.add(solution);
    return solution;
  }

  // Whether that is all there is: no start was next to a fold, and each led to its own posture.
  Result<bool> from_closed_form() {
    if (form_.design == Design::kOther) return false;
    bool complete = true;
    for (unsigned k = 0; k < 8; ++k) {
      const Posture posture{(k & 4U) != 0, (k & 2U) != 0, (k & 1U) != 0};
      const Start start = solve_closed_form(form_, X_0n_, posture);
      if (!start.reachable) continue;
      ARMSIG_TRY(solution, from(start.q, anywhere_));
      complete = complete && (!start.near_fold || settled(form_, solution, posture));
    }
    return complete;
  }

  // Where two folds meet, a stretched elbow and a straight wrist for instance, the descent still
  // converges, by a digit in some hundred passes.
  Result<void> from_patiently(const PostureStarts& starts) {
    InverseOptions patient = anywhere_;
    patient.max_iterations = std::max(patient.max_iterations, kPatience);
    for (const JointVector& start : starts) {
      if (const auto led = from(start, patient); !led) return std::unexpected(led.error());
    }
    return {};
  }

  // Two solutions that have nearly met in a fold lie on both sides of it; one that can move without
  // moving frame n may do so into the limits.
  Result<void> from_beside() {
    InverseOptions inside = anywhere_;
    inside.respect_limits = true;
    for (std::size_t k = 0; k < collector_.size(); ++k) {
      const InverseSolution solution = collector_[k];
      if (solution.regularity > kClearOfFolds) continue;
      if (solution.verdict == Verdict::kJointLimit) {
        if (const auto led = from(solution.q, inside); !led) return std::unexpected(led.error());
      }
      ARMSIG_TRY(at, forward_with_jacobian(chain_, solution.q));
      const Joints weakest = weakest_direction(at.J, static_cast<Eigen::Index>(chain_.joint_count));
      for (const double step : kBeside) {
        JointVector start = solution.q;
        for (std::size_t i = 0; i < start.size(); ++i) {
          start[i] += step * weakest[static_cast<Eigen::Index>(i)];
        }
        if (const auto led = from(start, anywhere_); !led) return std::unexpected(led.error());
      }
    }
    return {};
  }

  // The limits keep the descent where the arm works.
  Result<void> from_fixed_starts() {
    InverseOptions inside = anywhere_;
    inside.respect_limits = true;
    inside.max_iterations = std::min(inside.max_iterations, kIterationsPerStart);
    for (int k = 0; k < kMostStarts; ++k) {
      if (k >= kFewestStarts && !collector_.empty()) break;
      if (const auto led = from(fixed_start(chain_, k), inside); !led) {
        return std::unexpected(led.error());
      }
    }
    return chain_.joint_count > 6 ? from_outside(inside) : Result<void>();
  }

  // At their limits joints stop a descent that would find its way without them. The pose is met
  // first; then those that can move without the tip bring each other inside.
  Result<void> from_outside(const InverseOptions& inside) {
    for (int k = 0; k < kMostStarts && !collector_.has_one_inside(); ++k) {
      ARMSIG_TRY(met, inverse(chain_, X_0n_, fixed_start(chain_, k), anywhere_));
      if (met.verdict != Verdict::kConverged && met.verdict != Verdict::kDegraded) continue;
      if (const auto led = from(collector_.turned(met.q), inside); !led) {
        return std::unexpected(led.error());
      }
    }
    return {};
  }

  const Chain& chain_;
  const ClosedForm& form_;
  const Pose& X_0n_;
  InverseOptions anywhere_;
  Collector collector_;
};

}  // namespace

Result<Solutions> cold_start(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
                             const JointVector& reference, const InverseOptions& options) {
  ARMSIG_CHECK(reference.empty() || reference.size() == chain.joint_count);
  ARMSIG_CHECK(form.design == Design::kOther || (chain.joint_count == 6 && !chain.has_prismatic));
  if (const auto error = refusal(X_0n, reference, options)) return std::unexpected(*error);
  return ColdStart(chain, form, X_0n, reference, options).run(reference);
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
