// SPDX-License-Identifier: MIT
#include "firmware/analysis/differences/difference_effects.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/base/links.hpp"
#include "core/base/low_discrepancy.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::differences {
namespace {

// Base and tool: rotation vector of the base about the pivot, its shift, the shift of the tool.
using Fitted = Eigen::Matrix<double, 9, 1>;
using FittedMatrix = Eigen::Matrix<double, 9, 9>;
using FittedColumns = Eigen::Matrix<double, 3, 9>;

using CauseFields = std::array<Vector3, kMaxJoints * kCauses>;

// Nodes and weights of Gauss and Legendre on [0, 1]: exact to the sixth order of the deviations.
constexpr std::array<double, 3> kNodes{0.5 - 0.3872983346207417, 0.5, 0.5 + 0.3872983346207417};
constexpr std::array<double, 3> kWeights{5.0 / 18, 8.0 / 18, 5.0 / 18};

// The tool and its derivatives along the path.
struct ToolAt {
  Vector3 p_S;
  CauseFields by_cause;     // derivative by s times what the cause is
  FittedColumns by_fitted;  // derivative by Fitted
};

double value(const DeviatingChain& chain, std::size_t joint, Deviation which) {
  return chain.values[deviation_index(joint, which)];
}
Vector3 tilt_of(const DeviatingChain& chain, std::size_t joint) {
  return {value(chain, joint, Deviation::kTiltX), value(chain, joint, Deviation::kTiltY), 0};
}
Vector3 shift_of(const DeviatingChain& chain, std::size_t joint) {
  return {value(chain, joint, Deviation::kShiftX), value(chain, joint, Deviation::kShiftY), 0};
}

// What is added to the effective reading of a joint.
double offset_of(const DeviatingChain& chain, std::size_t joint, double coupled) {
  return value(chain, joint, Deviation::kZero) +
         calibration::corrected_reading(chain.readings, joint, coupled) - coupled;
}

// One configuration of the work volume.
struct Reading {
  JointVector coupled;
  Bend bend;
};

class Path {
 public:
  Path(const DeviatingChain& chain, const FixedVector<JointLimits, kMaxJoints>& limits)
      : chain_(chain), limits_(limits), types_(types_of(chain.axes)), bends_(chain.bendings) {}

  // Configuration n >= 1.
  [[nodiscard]] Reading reading(int n) const {
    const JointVector readings = evenly_spread_configuration(types_, limits_, n);
    Reading reading{.coupled = effective_readings(chain_.readings.couplings, readings), .bend = {}};
    if (chain_.bendings.any()) reading.bend = bends_.at(readings, reading.coupled);
    return reading;
  }

  [[nodiscard]] std::size_t causes() const { return types_.size() * kCauses; }
  void set_pivot(const Vector3& pivot_S) { pivot_S_ = pivot_S; }

  // The base, off by `fitted`.
  [[nodiscard]] Pose base(const Fitted& fitted) const {
    const Matrix3 R = numerics::rotation_by(fitted.head<3>());
    return Pose{R, pivot_S_ - R * pivot_S_ + fitted.segment<3>(3)} * chain_.X_SD;
  }

  // At the share s of all deviations, base and tool off by `fitted` (1 - s).
  void evaluate(const Reading& q, double s, const Fitted& fitted, ToolAt& at) const {
    AxisFrames frames;
    place(q, s, fitted, frames, at);
    for (std::size_t i = 0; i < types_.size(); ++i) {
      add_causes(i, s, q, frames.before[i], frames.after[i], at);
    }
  }
  // The same without the derivatives by causes.
  void place(const Reading& q, double s, const Fitted& fitted, ToolAt& at) const {
    AxisFrames frames;
    place(q, s, fitted, frames, at);
  }

 private:
  // In the sensor frame, before E_i and after it.
  struct AxisFrames {
    std::array<Pose, kMaxJoints> before;
    std::array<Pose, kMaxJoints> after;
  };

  void place(const Reading& q, double s, const Fitted& fitted, AxisFrames& frames,
             ToolAt& at) const {
    const JointVector& coupled = q.coupled;
    auto& [before, after] = frames;
    const Vector3 shift = (1 - s) * fitted.segment<3>(3);
    Pose X = base((1 - s) * fitted);
    for (std::size_t i = 0; i < types_.size(); ++i) {
      before[i] = X * chain_.axes[i].X_before;
      after[i] =
          before[i] * Pose{numerics::rotation_by(s * tilt_of(chain_, i)), s * shift_of(chain_, i)};
      const double more = q.bend.more_by_map[i] + q.bend.more_by_gravity[i];
      const double turned =
          coupled[i] + q.bend.drawn[i] + s * (offset_of(chain_, i, coupled[i]) + more);
      X = after[i] * joint_motion(types_[i], turned);
    }
    at.p_S = X * Vector3(chain_.p_T + (1 - s) * fitted.tail<3>());
    for (int c = 0; c < 3; ++c) {
      at.by_fitted.col(c) = Vector3::Unit(c).cross(at.p_S - shift - pivot_S_);
      at.by_fitted.col(3 + c) = Vector3::Unit(c);
      at.by_fitted.col(6 + c) = X.R.col(c);
    }
  }

  void add_causes(std::size_t i, double s, const Reading& q, const Pose& before, const Pose& after,
                  ToolAt& at) const {
    const double coupled = q.coupled[i];
    const auto of = [&](Cause cause) -> Vector3& {
      return at.by_cause[i * kCauses + static_cast<std::size_t>(cause)];
    };
    const Vector3 arm = at.p_S - before.p - s * (before.R * shift_of(chain_, i));
    of(Cause::kTiltX) = before.R.col(0).cross(arm) * value(chain_, i, Deviation::kTiltX);
    of(Cause::kTiltY) = before.R.col(1).cross(arm) * value(chain_, i, Deviation::kTiltY);
    of(Cause::kShiftX) = before.R.col(0) * value(chain_, i, Deviation::kShiftX);
    of(Cause::kShiftY) = before.R.col(1) * value(chain_, i, Deviation::kShiftY);
    const Vector3 z = after.R.col(2);
    const Vector3 motion =
        types_[i] == JointType::kRevolute ? Vector3(z.cross(at.p_S - after.p)) : z;
    of(Cause::kZero) = motion * value(chain_, i, Deviation::kZero);
    calibration::ReadingCorrection c;
    if (!chain_.readings.corrections.empty()) c = chain_.readings.corrections[i];
    of(Cause::kScale) = motion * (c.gain * coupled);
    of(Cause::kOnceATurn) = motion * (c.cos_1 * std::cos(coupled) + c.sin_1 * std::sin(coupled));
    of(Cause::kTwiceATurn) =
        motion * (c.cos_2 * std::cos(2 * coupled) + c.sin_2 * std::sin(2 * coupled));
    of(Cause::kMap) = motion * q.bend.more_by_map[i];
    of(Cause::kGravity) = motion * q.bend.more_by_gravity[i];
  }

  const DeviatingChain& chain_;
  const FixedVector<JointLimits, kMaxJoints>& limits_;
  JointTypes types_;
  Bends bends_;
  Vector3 pivot_S_ = Vector3::Zero();
};

// The directions of base and tool that the work volume determines: a slide of the base along axes
// that are all parallel is one of the tool, too.
FittedMatrix determined_directions(const FittedMatrix& information) {
  constexpr double kLeastShare = 1e-6;
  const Eigen::SelfAdjointEigenSolver<FittedMatrix> spectrum(information);
  FittedMatrix directions = spectrum.eigenvectors();
  for (int k = 0; k < 9; ++k) {
    if (spectrum.eigenvalues()[k] < kLeastShare * spectrum.eigenvalues()[8]) {
      directions.col(k).setZero();
    }
  }
  return directions;
}

// Adds 1 to the diagonal where there is no direction, so that nothing is solved for there.
void fill_empty(FittedMatrix& matrix, const FittedMatrix& directions) {
  for (int k = 0; k < 9; ++k) {
    if (directions.col(k).isZero(0)) matrix(k, k) = 1;
  }
}

// Base and tool of the drawing that fit the tool of the arm best, and the directions sought.
struct Fit {
  Fitted fitted = Fitted::Zero();
  FittedMatrix directions = FittedMatrix::Zero();
};

Fit fit_base_and_tool(Path& path, int count) {
  constexpr int kMaxSteps = 30;
  constexpr double kNegligibleStep = 1e-13;
  ToolAt arm;
  ToolAt drawn;
  Vector3 middle = Vector3::Zero();
  for (int n = 1; n <= count; ++n) {
    path.place(path.reading(n), 1, Fitted::Zero(), arm);
    middle += arm.p_S / count;
  }
  path.set_pivot(middle);
  Fit fit;
  for (int step = 0; step < kMaxSteps; ++step) {
    FittedMatrix information = FittedMatrix::Zero();
    Fitted gradient = Fitted::Zero();
    for (int n = 1; n <= count; ++n) {
      const Reading q = path.reading(n);
      path.place(q, 1, Fitted::Zero(), arm);
      path.place(q, 0, fit.fitted, drawn);
      information.noalias() += drawn.by_fitted.transpose() * drawn.by_fitted;
      gradient.noalias() += drawn.by_fitted.transpose() * (arm.p_S - drawn.p_S);
    }
    if (step == 0) fit.directions = determined_directions(information);
    FittedMatrix reduced = fit.directions.transpose() * information * fit.directions;
    fill_empty(reduced, fit.directions);
    const Fitted along = fit.directions.transpose() * gradient;
    const Fitted change = fit.directions * Eigen::PartialPivLU<FittedMatrix>(reduced).solve(along);
    fit.fitted += change;
    if (change.norm() < kNegligibleStep) break;
  }
  return fit;
}

// Everything along the path at one configuration.
struct PathIntegral {
  Vector3 displacement;  // of the arm from the drawing
  CauseFields by_cause;
  FittedColumns by_fitted;
  FittedColumns at_start;
};

void integrate(const Path& path, int n, const Fit& fit, PathIntegral& integral) {
  const Reading q = path.reading(n);
  ToolAt at;
  path.place(q, 1, fit.fitted, at);
  integral.displacement = at.p_S;
  path.place(q, 0, fit.fitted, at);
  integral.displacement -= at.p_S;
  integral.at_start = at.by_fitted * fit.directions;
  integral.by_fitted.setZero();
  integral.by_cause.fill(Vector3::Zero());
  for (std::size_t k = 0; k < kNodes.size(); ++k) {
    path.evaluate(q, kNodes[k], fit.fitted, at);
    integral.by_fitted += kWeights[k] * (at.by_fitted * fit.directions);
    for (std::size_t c = 0; c < path.causes(); ++c) {
      integral.by_cause[c] += kWeights[k] * at.by_cause[c];
    }
  }
}

void keep_largest(const Bend& bend, Bend& largest) {
  const auto keep = [](const BendValues& from, BendValues& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = std::max(to[i], std::abs(from[i]));
  };
  keep(bend.drawn, largest.drawn);
  keep(bend.more_by_map, largest.more_by_map);
  keep(bend.more_by_gravity, largest.more_by_gravity);
}

}  // namespace

Pose hand_pose(const DeviatingChain& chain, const JointVector& effective) {
  Pose X = chain.X_SD;
  for (std::size_t i = 0; i < chain.axes.size(); ++i) {
    const double turned = effective[i] + offset_of(chain, i, effective[i]);
    X = X * chain.axes[i].X_before *
        Pose{numerics::rotation_by(tilt_of(chain, i)), shift_of(chain, i)} *
        joint_motion(chain.axes[i].type, turned);
  }
  return X;
}

FittedBase fitted_base(const DeviatingChain& chain,
                       const FixedVector<JointLimits, kMaxJoints>& limits, int count) {
  ARMSIG_CHECK(limits.size() == chain.axes.size() && count > 0);
  Path path(chain, limits);
  const Fit fit = fit_base_and_tool(path, count);
  return {path.base(fit.fitted), chain.p_T + fit.fitted.tail<3>()};
}

Effects difference_effects(const DeviatingChain& chain,
                           const FixedVector<JointLimits, kMaxJoints>& limits, int count) {
  ARMSIG_CHECK(limits.size() == chain.axes.size() && count > 0);
  Path path(chain, limits);
  const Fit fit = fit_base_and_tool(path, count);
  // What base and tool take of each cause: the fit at the start of the path sees nothing of what is
  // left, and what they do along the path itself vanishes.
  FittedMatrix overlap = FittedMatrix::Zero();
  std::array<Fitted, kMaxJoints * kCauses> taken;
  taken.fill(Fitted::Zero());
  PathIntegral integral;
  Effects effects;
  for (int n = 1; n <= count; ++n) {
    integrate(path, n, fit, integral);
    keep_largest(path.reading(n).bend, effects.largest);
    overlap.noalias() += integral.at_start.transpose() * integral.by_fitted;
    for (std::size_t c = 0; c < path.causes(); ++c) {
      taken[c].noalias() += integral.at_start.transpose() * integral.by_cause[c];
    }
  }
  fill_empty(overlap, fit.directions);
  const Eigen::PartialPivLU<FittedMatrix> solver(overlap);
  for (Fitted& of_cause : taken) of_cause = Fitted(solver.solve(of_cause));

  for (int n = 1; n <= count; ++n) {
    integrate(path, n, fit, integral);
    effects.total_rms_m += integral.displacement.squaredNorm() / count;
    for (std::size_t c = 0; c < path.causes(); ++c) {
      const Vector3 left = integral.by_cause[c] - integral.by_fitted * taken[c];
      effects.of[c].rms_m += left.squaredNorm() / count;
      effects.of[c].adds_m += left.dot(integral.displacement) / count;
    }
  }
  effects.total_rms_m = std::sqrt(effects.total_rms_m);
  for (Effect& effect : effects.of) {
    effect.rms_m = std::sqrt(effect.rms_m);
    if (effects.total_rms_m > 0) effect.adds_m /= effects.total_rms_m;
  }
  return effects;
}

}  // namespace armsig::differences
