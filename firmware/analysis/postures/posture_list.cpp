// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/posture_list.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace armsig::kinematics {
namespace {

constexpr double kSameSolution = 1e-4;  // rad or m
// Orientations that an arm of fewer than six joints misses by as much as this are as good as each
// other: an individual's axes are no straighter, and other postures miss them by far more.
constexpr double kSameOrientation = 0.02;  // rad
// A reading beyond its limit by no more than this is at the limit [rad or m].
constexpr double kAtLimit = 1e-9;
// Two solutions are one posture where the pose is met halfway too [m and rad]. Two that are as near
// as those at a fold may be two: the error halfway goes by the square of what is between them.
constexpr double kMetHalfway = 1e-7;
constexpr double kMetHalfwayAtFold = 4e-10;
constexpr double kAtFold = 0.01;  // rad or m

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

}  // namespace

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

PostureList::PostureList(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
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

JointVector PostureList::turned(JointVector q) const {
  for (std::size_t i = 0; i < chain_.joint_count; ++i) {
    const JointLimits* limits = chain_.limits.empty() ? nullptr : &chain_.limits[i];
    if (chain_.revolute[i]) q[i] = best_turn(q[i], reference_[i], limits);
  }
  return q;
}

PostureList::Worth PostureList::worth(const JointVector& q) const {
  const JointVector best = turned(q);
  Worth worth{0, largest_change(best, reference_)};
  for (std::size_t i = 0; i < chain_.limits.size(); ++i) {
    worth.beyond = std::max(
        {worth.beyond, chain_.limits[i].lower - best[i], best[i] - chain_.limits[i].upper});
  }
  if (worth.beyond <= kAtLimit) worth.beyond = 0;
  return worth;
}

void PostureList::add(InverseSolution solution) {
  if (solution.verdict != Verdict::kConverged && solution.verdict != Verdict::kDegraded) return;
  solution.q = turned(solution.q);
  for (std::size_t i = 0; i < chain_.limits.size(); ++i) {
    double& reading = solution.q[i];
    const double nearest = std::clamp(reading, chain_.limits[i].lower, chain_.limits[i].upper);
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
  const std::size_t place = place_of(solution);
  if (place == found_.size() && !found_.full()) {
    found_.push_back(named);
    return;
  }
  NamedSolution* const worse = place < found_.size()
                                   ? &found_[place]
                                   : std::max_element(
                                         found_.begin(), found_.end(),
                                         [&](const NamedSolution& a, const NamedSolution& b) {
                                           return key(a, 0) < key(b, 0);
                                         });
  if (!(key(named, 0) < key(*worse, 0))) return;
  *worse = named;
  replaced_ = true;
}

bool PostureList::has_one_inside() const {
  return std::ranges::any_of(found_, [](const NamedSolution& named) {
    return named.solution.verdict != Verdict::kJointLimit;
  });
}

std::size_t PostureList::place_of(const InverseSolution& solution) const {
  std::size_t place = 0;
  while (place < found_.size() && !is_same_posture(found_[place].solution, solution)) ++place;
  return place;
}

Solutions PostureList::sorted() const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const NamedSolution& named : found_) {
    nearest = std::min(nearest, named.solution.rotation_error_rad);
  }
  FixedVector<Key, kMaxFound> keys;
  FixedVector<std::uint8_t, kMaxFound> order;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    keys.push_back(key(found_[i], nearest + kSameOrientation));
    order.push_back(static_cast<std::uint8_t>(i));
    for (std::size_t k = i; k > 0 && keys[order[k]] < keys[order[k - 1]]; --k) {
      std::swap(order[k], order[k - 1]);
    }
  }
  Solutions first;
  for (const std::uint8_t place : order) {
    if (first.full()) break;
    const NamedSolution& named = found_[place];
    // The better one of a posture may have come to stand so that it is one with another, too.
    const bool again = replaced_ && std::ranges::any_of(first, [&](const NamedSolution& other) {
                         return is_same_posture(other.solution, named.solution);
                       });
    if (!again) first.push_back(named);
  }
  return first;
}

// Those inside the limits first, then those that meet the whole pose, then those that miss the
// orientation by little more than the best, then by distance from the reference.
PostureList::Key PostureList::key(const NamedSolution& named, double turned_rad) const {
  const InverseSolution& solution = named.solution;
  return {solution.verdict == Verdict::kJointLimit,
          solution.rotation_error_rad > rotation_tolerance_rad_,
          solution.rotation_error_rad > turned_rad, largest_change(solution.q, reference_)};
}

// Equal, or joined by a motion of the joints that leaves frame n where it is, either way round.
bool PostureList::is_same_posture(const InverseSolution& a, const InverseSolution& b) const {
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
  const double largest = std::abs(change[farthest]);
  if (largest < kSameSolution) return true;
  if (is_met_at(a.q, change, largest < kAtFold ? kMetHalfwayAtFold : kMetHalfway)) return true;
  if (largest < kAtFold && leads_between(a.q, change)) return true;
  if (!chain_.revolute[farthest]) return false;
  change[farthest] -= std::copysign(2 * kPi, change[farthest]);
  return is_met_at(a.q, change, kMetHalfway);
}

// Whether Newton's method from halfway stays between the two: at a fold it leads to one of them.
bool PostureList::leads_between(JointVector q, const JointVector& change) const {
  double largest = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] += 0.5 * change[i];
    largest = std::max(largest, std::abs(change[i]));
  }
  const InverseOptions free{.max_iterations = 30, .respect_limits = false};
  const auto between = inverse(chain_, X_0n_, q, free);
  return between && between->position_error_m < kMetHalfwayAtFold &&
         between->rotation_error_rad < kMetHalfwayAtFold &&
         largest_change(between->q, q) < 0.25 * largest;
}

// Halfway along `change` from q.
bool PostureList::is_met_at(JointVector q, const JointVector& change, double within) const {
  for (std::size_t i = 0; i < q.size(); ++i) q[i] += 0.5 * change[i];
  const auto X = forward(chain_, q);
  return X && (X->p - X_0n_.p).norm() < within && (X->R - X_0n_.R).norm() < within;
}

}  // namespace armsig::kinematics
