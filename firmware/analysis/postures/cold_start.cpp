// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/cold_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/motion_directions.hpp"
#include "core/kinematics/verdict.hpp"
#include "firmware/analysis/postures/free_motion.hpp"
#include "firmware/analysis/postures/posture_search.hpp"

namespace armsig::kinematics {
namespace {

// Starting postures of arms without a closed form: this many at least, and up to the larger number
// until one solution is found.
constexpr int kFewestStarts = 40;
constexpr int kMostStarts = 400;

constexpr int kIterationsPerStart = 50;

// Passes of a descent that is tried where none of the usual length led anywhere.
constexpr int kPatience = 4000;
// And where another start did.
constexpr int kPatienceBesideFold = 1000;
// How far on both sides of a fold its other solution is looked for, in the joint that moves most,
// and along curves [rad, of all joints together].
constexpr std::array<double, 8> kBeside{0.02, -0.02, 0.1, -0.1, 0.4, -0.4, 1.2, -1.2};
constexpr double kAlong = 2;
constexpr double kWholeCurve = 1e3;
// Below this regularity joints may be free to move without frame n.
constexpr double kMayBeFree = 1e-6;
// And below this one Newton's method is slow beside it: other postures are looked for along curves.
constexpr double kOnFold = 3e-3;
// A turn about a line comes near to none without passing it: so near, Newton's method is tried.
constexpr double kNearlyTurned = 0.2;

// Whether the start led to its own posture, clear of the folds: then no other start is needed.
bool settled(const ClosedForm& form, const InverseSolution& solution, const Posture& posture) {
  return solution.verdict == Verdict::kConverged && solution.regularity > kClearOfFolds &&
         posture_of(form, solution.q) == posture;
}

JointVector fixed_start(const Chain& chain, int k) {
  JointVector q;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    const auto [lower, upper] = range_of(chain, i);
    q.push_back(lower + (upper - lower) * halton(i, k + 1));
  }
  return q;
}

bool is_met(const InverseSolution& solution) {
  return solution.verdict == Verdict::kConverged || solution.verdict == Verdict::kDegraded;
}

// Lines of different kinds, so that postures which one does not connect another does.
constexpr std::size_t kLines = 3;
std::array<Line, kLines> lines_beside(const Pose& X_0n, double length) {
  const auto beside = [&](const Vector3& by) { return X_0n.p + length * by; };
  return {Line{beside({0.5, 0.2, -0.3}), Vector3(0.36, -0.48, 0.8)},
          Line{beside({-0.1, 0.9, 0.4}), Vector3(0.8, 0.36, -0.48)},
          Line{beside({-0.2, -0.1, 0.1}), Vector3(-0.48, 0.8, 0.36)}};
}

// Starts of one request, and what they lead to.
class ColdStart {
 public:
  ColdStart(const Chain& chain, const ClosedForm& form, const Pose& X_0n,
            const JointVector& reference, const InverseOptions& options)
      : chain_(chain),
        form_(form),
        X_0n_(X_0n),
        anywhere_(options),
        list_(chain, form, X_0n, reference, options.rotation_tolerance_rad),
        lines_(lines_beside(X_0n, chain.length)) {
    anywhere_.max_step.clear();
    anywhere_.respect_limits = false;
  }

  Result<Solutions> run(const JointVector& reference) {
    if (!reference.empty()) {
      if (const auto led = from(reference, anywhere_); !led) return std::unexpected(led.error());
    }
    ARMSIG_TRY(complete, from_closed_form());
    if (complete) return list_.sorted();
    if (const auto led = search(); !led) return std::unexpected(led.error());
    return list_.sorted();
  }

 private:
  Result<void> search() {
    if (chain_.joint_count == 7) {
      if (const auto led = from_curves_of_seven(); !led) return led;
      return from_outside();
    }
    if (!can_search_postures(chain_)) {
      if (const auto led = from_fixed_starts(); !led) return led;
      if (chain_.joint_count > 6) return from_outside();
      return chain_.joint_count == 6 ? from_lines() : Result<void>();
    }
    const PostureStarts starts = search_postures(chain_, X_0n_);
    for (const JointVector& start : starts) {
      if (const auto led = from(start, anywhere_); !led) return std::unexpected(led.error());
    }
    if (list_.empty()) {
      if (const auto led = from_patiently(starts, kPatience); !led) return led;
    }
    if (!has_one_on_fold()) return from_beside();
    if (const auto led = from_patiently(starts, kPatienceBesideFold); !led) return led;
    return from_lines();
  }
  [[nodiscard]] bool has_one_on_fold() const {
    for (std::size_t k = 0; k < list_.size(); ++k) {
      if (list_[k].regularity < kOnFold) return true;
    }
    return false;
  }

  Result<InverseSolution> from(const JointVector& start, const InverseOptions& options) {
    ARMSIG_TRY(solution, inverse(chain_, X_0n_, start, options));
    if (!is_met(solution)) return solution;
    const bool may_be_free = chain_.joint_count == 6 && solution.regularity < kMayBeFree;
    if (may_be_free && list_.place_of(solution) == list_.size()) {
      if (const auto led = add_free(solution); !led) return std::unexpected(led.error());
    } else {
      list_.add(solution);
    }
    return solution;
  }

  // Of joints that can move without frame n the worthiest readings are listed, once.
  Result<void> add_free(const InverseSolution& solution) {
    FixedVector<JointVector, kMaxCurves> known;
    for (std::size_t k = 0; k < list_.size(); ++k) {
      if (list_[k].regularity < kMayBeFree && !known.full()) known.push_back(list_[k].q);
    }
    FreeMotion motion(chain_, X_0n_, list_);
    FreeMotion::Stretches best;
    const FreeMotion::Kind kind = motion.follow(solution.q, known, best);
    if (kind == FreeMotion::Kind::kNone) list_.add(solution);
    if (kind != FreeMotion::Kind::kNew) return {};
    const std::size_t before = list_.size();
    const auto led = add_all(best);
    if (list_.size() == before) list_.add(solution);
    return led;
  }

  Result<void> add_all(const FreeMotion::Stretches& best) {
    for (const JointVector& q : best) {
      InverseOptions here = anywhere_;
      here.respect_limits = list_.worth(q).beyond == 0;
      ARMSIG_TRY(solution, inverse(chain_, X_0n_, list_.turned(q), here));
      list_.add(solution);
    }
    return {};
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
  Result<void> from_patiently(const PostureStarts& starts, int patience) {
    InverseOptions patient = anywhere_;
    patient.max_iterations = std::max(patient.max_iterations, patience);
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
    for (std::size_t k = 0; k < list_.size(); ++k) {
      const InverseSolution solution = list_[k];
      if (solution.regularity > kClearOfFolds) continue;
      if (solution.verdict == Verdict::kJointLimit) {
        if (const auto led = from(solution.q, inside); !led) return std::unexpected(led.error());
      }
      if (const auto led = from_steps_beside(solution); !led) return led;
      for (const Line& line : lines_) {
        for (const bool forwards : {true, false}) {
          MotionCurve curve(chain_, X_0n_, line);
          if (!curve.begin(solution.q, forwards)) continue;
          const auto led = follow(curve, kAlong, [](const InverseSolution&) {});
          if (!led) return led;
        }
      }
    }
    return {};
  }

  Result<void> from_steps_beside(const InverseSolution& solution) {
    ARMSIG_TRY(at, forward_with_jacobian(chain_, solution.q));
    const Joints weakest = weakest_direction(at.J, static_cast<Eigen::Index>(chain_.joint_count));
    for (const double step : kBeside) {
      JointVector start = solution.q;
      for (std::size_t i = 0; i < start.size(); ++i) {
        start[i] += step * weakest[static_cast<Eigen::Index>(i)];
      }
      if (const auto led = from(start, anywhere_); !led) return std::unexpected(led.error());
    }
    return {};
  }

  // The limits keep the descent where the arm works; six joints have postures beyond them as well.
  Result<void> from_fixed_starts() {
    InverseOptions inside = anywhere_;
    inside.respect_limits = chain_.joint_count != 6;
    // Fewer joints have few postures, and next to a straight elbow a long way to them.
    if (chain_.joint_count > 5) {
      inside.max_iterations = std::min(inside.max_iterations, kIterationsPerStart);
    }
    InverseOptions across = inside;
    across.respect_limits = false;
    for (int k = 0; k < kMostStarts; ++k) {
      if (k >= kFewestStarts && !list_.empty()) break;
      const JointVector start = fixed_start(chain_, k);
      if (const auto led = from(start, inside); !led) return std::unexpected(led.error());
      if (chain_.joint_count > 5) continue;
      // Past a limit there may be another posture inside all of them.
      if (const auto led = from(start, across); !led) return std::unexpected(led.error());
    }
    return {};
  }

  // From each posture along the curves on which frame n turns about a line, to the others.
  Result<void> from_lines() {
    FixedVector<unsigned, PostureList::kMaxFound> followed;
    for (std::size_t k = 0; k < list_.size(); ++k) {
      for (std::size_t line = 0; line < kLines && k < list_.size(); ++line) {
        followed.resize(list_.size(), 0);
        const unsigned bit = 1U << line;
        if ((followed[k] & bit) != 0) continue;
        followed[k] |= bit;
        const JointVector q = list_[k].q;
        const auto mark = [&](const InverseSolution& solution) {
          const std::size_t place = list_.place_of(solution);
          followed.resize(list_.size(), 0);
          if (place < followed.size()) followed[place] |= bit;
        };
        MotionCurve curve(chain_, X_0n_, lines_[line]);
        for (const bool forwards : {true, false}) {
          if (curve.is_whole() || !curve.begin(q, forwards)) break;
          if (const auto led = follow(curve, kWholeCurve, mark); !led) return led;
        }
      }
    }
    return from_beside();
  }

  // Along the curve for so long, to where its turn is zero. `found` is told of what is there.
  template <typename Found>
  Result<void> follow(MotionCurve& curve, double most, Found found) {
    double before = kPi;
    while (curve.length() < most && curve.advance()) {
      const double from_turn = curve.turn_before();
      const double to_turn = curve.turn();
      const bool small = std::abs(from_turn) + std::abs(to_turn) < kPi;
      const bool passes = small && from_turn != 0 && (from_turn > 0) != (to_turn > 0);
      const bool turns_back = std::abs(from_turn) <= std::abs(before) &&
                              std::abs(from_turn) <= std::abs(to_turn) &&
                              std::abs(from_turn) < kNearlyTurned && from_turn != 0;
      before = from_turn;
      if (!passes && !turns_back) continue;
      const double part = passes ? from_turn / (from_turn - to_turn) : 0;
      ARMSIG_TRY(solution, from(curve.near(part), anywhere_));
      if (is_met(solution)) found(solution);
    }
    return {};
  }

  // Seven joints meet a pose along curves. Each is followed once, from whichever start leads to it.
  Result<void> from_curves_of_seven() {
    constexpr int kWithoutNews = 40;
    FixedVector<JointVector, kMaxCurves> known;
    FreeMotion motion(chain_, X_0n_, list_);
    int news = 0;
    for (int k = 0; k < kMostStarts && !known.full(); ++k) {
      if (k > news + kWithoutNews && !known.empty()) break;
      ARMSIG_TRY(met, inverse(chain_, X_0n_, fixed_start(chain_, k), anywhere_));
      if (!is_met(met)) continue;
      FreeMotion::Stretches best;
      const FreeMotion::Kind kind = motion.follow(met.q, known, best);
      if (kind == FreeMotion::Kind::kNone) list_.add(met);
      if (kind != FreeMotion::Kind::kNew) continue;
      known.push_back(met.q);
      news = k;
      if (const auto led = add_all(best); !led) return led;
    }
    return {};
  }

  // At their limits joints stop a descent that would find its way without them. The pose is met
  // first; then those that can move without the tip bring each other inside.
  Result<void> from_outside() {
    InverseOptions inside = anywhere_;
    inside.respect_limits = true;
    inside.max_iterations = std::min(inside.max_iterations, kIterationsPerStart);
    for (int k = 0; k < kMostStarts && !list_.has_one_inside(); ++k) {
      ARMSIG_TRY(met, inverse(chain_, X_0n_, fixed_start(chain_, k), anywhere_));
      if (!is_met(met)) continue;
      if (const auto led = from(list_.turned(met.q), inside); !led) {
        return std::unexpected(led.error());
      }
    }
    return {};
  }

  static constexpr std::size_t kMaxCurves = 32;

  const Chain& chain_;
  const ClosedForm& form_;
  const Pose& X_0n_;
  InverseOptions anywhere_;
  PostureList list_;
  std::array<Line, kLines> lines_;
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
