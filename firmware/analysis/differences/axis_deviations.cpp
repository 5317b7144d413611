// SPDX-License-Identifier: MIT
#include "firmware/analysis/differences/axis_deviations.hpp"

#include <Eigen/Cholesky>

#include "core/base/links.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::differences {
namespace {

// What is free: a turn and a shift of the base, the zeros.
constexpr int kFree = 6 + static_cast<int>(kMaxJoints);
using FreeVector = Eigen::Matrix<double, kFree, 1>;
using FreeMatrix = Eigen::Matrix<double, kFree, kFree>;

// Step of the central differences: the values are of radians and metres, their curvature of one.
constexpr double kStep = 1e-6;
// An axis must point the way the drawing has it at least so far.
constexpr double kLeastCosine = 0.5;

// The tolerance, as a share, of what is laid to base and zeros instead.
constexpr double kNoneOfIt = 1e-3;

struct Freedom {
  Pose X_SD;
  JointVector zeros;
};

Freedom moved(const Freedom& from, const FreeVector& step) {
  Freedom to = from;
  to.X_SD.R = numerics::rotation_by(step.head<3>()) * from.X_SD.R;
  to.X_SD.p += step.segment<3>(3);
  for (std::size_t i = 0; i < to.zeros.size(); ++i) {
    to.zeros[i] += step[6 + static_cast<Eigen::Index>(i)];
  }
  return to;
}

class LineComparison {
 public:
  LineComparison(const FixedVector<DrawnAxis, kMaxJoints>& axes, const Signature& signature,
                 const Pose& X_SD, const WorkshopTolerances& tolerances)
      : axes_(axes), signature_(signature), base_S_(X_SD.p), base_m_(tolerances.base_m) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const bool revolute = axes[i].type == JointType::kRevolute;
      tolerance_[deviation_index(i, Deviation::kTiltX)] = tolerances.tilt_rad;
      tolerance_[deviation_index(i, Deviation::kTiltY)] = tolerances.tilt_rad;
      tolerance_[deviation_index(i, Deviation::kShiftX)] = tolerances.shift_m;
      tolerance_[deviation_index(i, Deviation::kShiftY)] = tolerances.shift_m;
      tolerance_[deviation_index(i, Deviation::kZero)] =
          revolute ? tolerances.zero_rad : tolerances.zero_m;
      if (axes[i].of_zero != Deviation::kZero) {
        tolerance_[deviation_index(i, axes[i].of_zero)] *= kNoneOfIt;
      }
    }
    for (std::size_t k = 0; k < kDeviations; ++k) tolerance_[k] *= kNoneOfIt;  // the base's
  }

  [[nodiscard]] std::size_t count() const { return axes_.size() * kDeviations; }

  // What E_i must be for the lines of `signature`; false where an axis points elsewhere.
  bool walk(const Signature& signature, const Freedom& freedom, DeviationValues& values) const {
    Pose X_SW = freedom.X_SD;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      X_SW = X_SW * axes_[i].X_before;
      const Pose X_WL = X_SW.inverse() * signature.X_SL[i];
      const Vector3 z = X_WL.R.col(2);
      if (!(z.z() > kLeastCosine)) return false;
      const Vector3 turn(-z.y(), z.x(), 0);
      const double sine = turn.norm();
      const double angle = std::atan2(sine, z.z());
      Pose E;
      if (sine > 0) E.R = rotation_about(turn / sine, angle);
      if (axes_[i].type == JointType::kRevolute) E.p = X_WL.p - z * (X_WL.p.z() / z.z());
      const double per_sine = sine > 0 ? angle / sine : 1;
      values[deviation_index(i, Deviation::kTiltX)] = turn.x() * per_sine;
      values[deviation_index(i, Deviation::kTiltY)] = turn.y() * per_sine;
      values[deviation_index(i, Deviation::kShiftX)] = E.p.x();
      values[deviation_index(i, Deviation::kShiftY)] = E.p.y();
      values[deviation_index(i, Deviation::kZero)] = freedom.zeros[i];
      X_SW = X_SW * E * joint_motion(axes_[i].type, signature.configuration[i] + freedom.zeros[i]);
    }
    return true;
  }
  bool walk(const Freedom& freedom, DeviationValues& values) const {
    return walk(signature_, freedom, values);
  }

  // Sum of squares over the tolerances.
  [[nodiscard]] double cost(const Freedom& freedom, const DeviationValues& values) const {
    double sum = (freedom.X_SD.p - base_S_).squaredNorm() / (base_m_ * base_m_);
    for (std::size_t k = 0; k < count(); ++k) {
      sum += values[k] / tolerance_[k] * (values[k] / tolerance_[k]);
    }
    return sum;
  }

  // Derivatives of the values by what is free, and their normal equations.
  bool linearise(const Freedom& freedom) {
    information_.setZero();
    for (int c = 0; c < kFree; ++c) {
      DeviationValues above{};
      DeviationValues below{};
      const FreeVector step = FreeVector::Unit(c) * kStep;
      if (c < 6 + static_cast<int>(axes_.size()) &&
          (!walk(moved(freedom, step), above) || !walk(moved(freedom, -step), below))) {
        return false;
      }
      for (std::size_t k = 0; k < count(); ++k) {
        by_free_[k][c] = (above[k] - below[k]) / (2 * kStep);
      }
    }
    for (std::size_t k = 0; k < count(); ++k) {
      const FreeVector row = by_free_[k] / tolerance_[k];
      information_.noalias() += row * row.transpose();
    }
    information_.diagonal().segment<3>(3).array() += 1 / (base_m_ * base_m_);
    // A turn about axes that are all one, and the zeros that there are not, stay where they are.
    constexpr double kDamping = 1e-14;
    const double damping = kDamping * information_.diagonal().maxCoeff();
    information_.diagonal().array() += damping;
    solver_.compute(information_);
    return true;
  }

  // The change of what is free that makes a change of the values least.
  [[nodiscard]] FreeVector answer(const DeviationValues& values) const {
    return solver_.solve(-gradient(values));
  }

  // The step to the least sum of squares.
  [[nodiscard]] FreeVector step(const Freedom& freedom, const DeviationValues& values) const {
    FreeVector uphill = gradient(values);
    uphill.segment<3>(3) += (freedom.X_SD.p - base_S_) / (base_m_ * base_m_);
    return solver_.solve(-uphill);
  }

  // The derivative of every value by one column of the lines, what is free following.
  [[nodiscard]] DeviationValues by_line(const Freedom& freedom, std::size_t joint,
                                        std::size_t column) const {
    const auto value_at = [&](double step) {
      Signature shifted = signature_;
      Pose& X_SL = shifted.X_SL[joint];
      const auto along = static_cast<Eigen::Index>(column % 2);
      if (column < 2) {
        X_SL.R = X_SL.R * rotation_about(Vector3::Unit(along), step);
      } else {
        X_SL.p += X_SL.R.col(along) * step;
      }
      DeviationValues values{};
      static_cast<void>(walk(shifted, freedom, values));
      return values;
    };
    DeviationValues derivative = value_at(kStep);
    const DeviationValues below = value_at(-kStep);
    for (std::size_t k = 0; k < count(); ++k) {
      derivative[k] = (derivative[k] - below[k]) / (2 * kStep);
    }
    const FreeVector follows = answer(derivative);
    for (std::size_t k = 0; k < count(); ++k) derivative[k] += by_free_[k].dot(follows);
    return derivative;
  }

 private:
  [[nodiscard]] FreeVector gradient(const DeviationValues& values) const {
    FreeVector sum = FreeVector::Zero();
    for (std::size_t k = 0; k < count(); ++k) {
      sum += by_free_[k] * (values[k] / (tolerance_[k] * tolerance_[k]));
    }
    return sum;
  }

  const FixedVector<DrawnAxis, kMaxJoints>& axes_;
  const Signature& signature_;
  Vector3 base_S_;
  double base_m_;
  DeviationValues tolerance_{};
  std::array<FreeVector, kMaxJoints * kDeviations> by_free_{};
  FreeMatrix information_;
  Eigen::LLT<FreeMatrix> solver_;
};

// Gauss-Newton with step halving.
Result<Freedom> least_deviations(LineComparison& comparison, Freedom freedom) {
  constexpr int kMaxSteps = 50;
  constexpr int kMaxHalvings = 10;
  constexpr double kNegligibleStep = 1e-11;
  DeviationValues values{};
  if (!comparison.walk(freedom, values)) return std::unexpected(Error::kNotConverged);
  for (int n = 0; n < kMaxSteps; ++n) {
    if (!comparison.linearise(freedom)) return std::unexpected(Error::kNotConverged);
    FreeVector step = comparison.step(freedom, values);
    if (!step.allFinite()) return std::unexpected(Error::kNotFinite);
    const double cost = comparison.cost(freedom, values);
    bool better = false;
    for (int halving = 0; halving < kMaxHalvings && !better; ++halving, step *= 0.5) {
      const Freedom next = moved(freedom, step);
      DeviationValues there{};
      if (!comparison.walk(next, there) || comparison.cost(next, there) > cost) continue;
      better = true;
      freedom = next;
      values = there;
      if (step.norm() < kNegligibleStep) return freedom;
    }
    if (!better) return freedom;  // as low as rounding lets it
  }
  return std::unexpected(Error::kNotConverged);
}

}  // namespace

Result<AxisDeviations> axis_deviations(const FixedVector<DrawnAxis, kMaxJoints>& axes,
                                       const Signature& signature, const Pose& X_SD,
                                       const WorkshopTolerances& tolerances) {
  ARMSIG_CHECK(axes.size() == signature.joint_count() &&
               signature.configuration.size() == axes.size());
  LineComparison comparison(axes, signature, X_SD, tolerances);
  ARMSIG_TRY(freedom, least_deviations(comparison, {X_SD, JointVector(axes.size())}));
  AxisDeviations found{.X_SD = freedom.X_SD, .values = {}, .by_lines = {}};
  if (!comparison.walk(freedom, found.values) || !comparison.linearise(freedom)) {
    return std::unexpected(Error::kNotConverged);
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::size_t columns = axes[i].type == JointType::kRevolute ? kLineColumns : 2;
    for (std::size_t c = 0; c < columns; ++c) {
      const DeviationValues derivative = comparison.by_line(freedom, i, c);
      for (std::size_t k = 0; k < comparison.count(); ++k) {
        found.by_lines[k][i * kLineColumns + c] = derivative[k];
      }
    }
  }
  return found;
}

}  // namespace armsig::differences
