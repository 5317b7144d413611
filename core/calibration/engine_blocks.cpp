// SPDX-License-Identifier: MIT
// The blocks of unknowns: their columns, normal equations and improvements.
#include <cmath>
#include <utility>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

// 1 sigma of the priors; those of the deviations are to be multiplied by their scales.
constexpr double kBaseTurn = 1;
constexpr double kFarAway_m = 3;
constexpr double kRotation = 2e-3;
constexpr double kShift_m = 1e-3;
constexpr double kZero = 10e-3;
constexpr double kReading = 1e-3;
constexpr double kOffset_m = 0.05;
constexpr double kUnknownScale = 0.05;  // that of an air temperature wrong by 30 K
// The proximal term's lengths where the prior is no measure of a step.
constexpr double kProximalTurn = 5e-3;
constexpr double kProximal_m = 5e-3;

constexpr double squared(double x) { return x * x; }

}  // namespace

double Engine::prior_variance(std::size_t column) const {
  if (column < 3) return squared(kBaseTurn);
  if (column < joint_column(0)) return squared(kFarAway_m);
  if (column >= gravity_column()) {
    const GravityTerm& term = model_.gravity[column - gravity_column()];
    return scales_.gravity * squared(map_unit(model_.joints[term.joint].type));
  }
  if (column >= further_column()) {
    const Parameter& parameter = model_.further[column - further_column()];
    if (of_reading(parameter)) return scales_.reading * squared(kReading);
    return squared(parameter.kind == ParameterKind::kScale ? kUnknownScale : kOffset_m);
  }
  switch ((column - joint_column(0)) % kDeviations) {
    case 0:
    case 1:
      return scales_.rotation * squared(kRotation);
    case 2:
    case 3:
      return scales_.shift * squared(kShift_m);
    default:
      return scales_.zero * squared(kZero);
  }
}

double Engine::proximal_variance(std::size_t column) const {
  const double unit = column < 3                 ? squared(kProximalTurn)
                      : column < joint_column(0) ? squared(kProximal_m)
                                                 : prior_variance(column);
  return squared(trust_) * unit;
}

// How far the model is from where its prior would have it.
double Engine::deviation(std::size_t column) const {
  if (column < 6) return base_moved_[column];
  if (column < joint_column(0)) {
    const ModelTarget& target = targets_[(column - 6) / 3];
    const auto c = static_cast<Eigen::Index>((column - 6) % 3);
    return target.p_L[c] - target.start_L[c];
  }
  if (column >= gravity_column()) return model_.gravity[column - gravity_column()].coefficient;
  if (column >= further_column()) {
    return value_of(std::as_const(model_), model_.further[column - further_column()]);
  }
  const std::size_t k = column - joint_column(0);
  return model_.joints[k / kDeviations].deviation[k % kDeviations];
}

double Engine::prior_squares() const {
  double sum = 0;
  for (std::size_t c = 0; c < columns_; ++c) sum += squared(deviation(c)) / prior_variance(c);
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    if (!has_map(j)) continue;
    sum += map_prior_squares(model_.joints[j].map) / scales_.map[j];
  }
  return sum + play_squares();
}

// Visits the columns that move the target: with its derivative by each.
template <typename Visit>
void Engine::for_columns(const ChainFrames& frames, std::size_t target, Visit visit) const {
  const ModelTarget& fixed = targets_[target];
  const Vector3 p_S = frames.X_SL * fixed.p_L;
  const Vector3 from_base = p_S - model_.X_SB.p;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector3 unit = Vector3::Unit(static_cast<Eigen::Index>(c));
    visit(c, unit.cross(from_base));
    visit(3 + c, unit);
    visit(target_column(target) + c, frames.X_SL.R.col(static_cast<Eigen::Index>(c)));
  }
  std::array<Vector3, kMaxJoints> motion;
  for (std::size_t j = 0; j < fixed.link; ++j) {
    const Pose& X_SJ = frames.X_SJ[j];
    const std::size_t first = joint_column(j);
    const Vector3 from_joint = p_S - X_SJ.p;
    motion[j] = motion_of(model_.joints[j].type == JointType::kRevolute, X_SJ, p_S);
    visit(first, X_SJ.R.col(0).cross(from_joint));
    visit(first + 1, X_SJ.R.col(1).cross(from_joint));
    visit(first + 2, X_SJ.R.col(0));
    visit(first + 3, X_SJ.R.col(1));
    visit(first + 4, motion[j]);
  }
  for (std::size_t k = 0; k < model_.further.size(); ++k) {
    const Parameter& parameter = model_.further[k];
    const std::size_t j = parameter.index;
    if (!of_reading(parameter) || j >= fixed.link) continue;
    visit(further_column() + k, turn_by(parameter, frames.effective[j]) * motion[j]);
  }
  for (std::size_t t = 0; t < model_.gravity.size(); ++t) {
    const std::size_t j = model_.gravity[t].joint;
    if (j < fixed.link) visit(gravity_column() + t, frames.levers[t] * motion[j]);
  }
}

// Of what a row measured: of a range, its derivatives are those along its way.
template <typename Visit>
void Engine::for_columns(const FitRow& row, const ChainFrames& frames, Visit visit) const {
  for_columns(frames, row.target, visit);
  for (std::size_t k = 0; k < model_.further.size(); ++k) {
    const Parameter& parameter = model_.further[k];
    if (of_reading(parameter)) continue;
    const Vector3 p_S = frames.X_SL * targets_[row.target].p_L;
    Vector3 value = Vector3::Zero();
    if (parameter.kind == ParameterKind::kScale) {
      value = row.is_range() ? Vector3(p_S - model_.sensor.receivers[row.receiver]) : p_S;
    } else if (row.is_range() && row.receiver == parameter.index) {
      value = row.p_S;
    }
    visit(further_column() + k, value);
  }
}

namespace {

// Writes columns where all are zero.
auto into(GeometryColumns& columns, std::size_t count) {
  for (auto& row : columns.d) std::fill_n(row.begin(), count, 0.0);
  return [&columns](std::size_t column, const Vector3& value) {
    for (std::size_t c = 0; c < 3; ++c) columns.d[c][column] = value[static_cast<Eigen::Index>(c)];
  };
}

}  // namespace

void Engine::fill(const ChainFrames& frames, std::size_t target, GeometryColumns& columns) const {
  for_columns(frames, target, into(columns, columns_));
}

void Engine::fill(const FitRow& row, const ChainFrames& frames, GeometryColumns& columns) const {
  for_columns(row, frames, into(columns, columns_));
}

// J^T W J of the rows, for every block.
void Engine::begin_assembly() {
  for (std::size_t i = 0; i < columns_; ++i) {
    for (std::size_t j = i; j < columns_; ++j) upper(i, j) = 0;
  }
  for (CyclicBand& band : work_.band) band = {};
  if (play_ != nullptr) play_->information.setZero();
}

void Engine::assemble(Units rows) {
  GeometryColumns J;
  GeometryColumns WJ;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    const FitRow& row = rows_[k];
    if (row.held_out || row.weight == 0) continue;
    const ChainFrames& frames = frames_of(k);
    fill(row, frames, J);
    const Matrix3 W = row.weight * precision(row);
    assemble_play(row, frames, W);
    for (std::size_t c = 0; c < columns_; ++c) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto r = static_cast<Eigen::Index>(i);
        WJ.d[i][c] = W(r, 0) * J.d[0][c] + W(r, 1) * J.d[1][c] + W(r, 2) * J.d[2][c];
      }
    }
    for (std::size_t a = 0; a < columns_; ++a) {
      const double x = WJ.d[0][a];
      const double y = WJ.d[1][a];
      const double z = WJ.d[2][a];
      if (x == 0 && y == 0 && z == 0) continue;
      double* sums = &upper(a, 0);
      for (std::size_t b = a; b < columns_; ++b) {
        sums[b] += x * J.d[0][b] + y * J.d[1][b] + z * J.d[2][b];
      }
    }
    assemble_maps(row, frames, J, WJ);
  }
}

void Engine::assemble_maps(const FitRow& row, const ChainFrames& frames, const GeometryColumns& J,
                           const GeometryColumns& WJ) {
  for (std::size_t j = 0; j < targets_[row.target].link; ++j) {
    if (!has_map(j)) continue;
    const std::size_t zero = joint_column(j) + 4;
    double squares = 0;
    for (std::size_t i = 0; i < 3; ++i) squares += J.d[i][zero] * WJ.d[i][zero];
    squares *= squared(map_unit(model_.joints[j].type));
    const SplineSupport& support = frames.support[j];
    for (std::size_t a = 0; a < kSplines; ++a) {
      for (std::size_t b = a; b < kSplines; ++b) {
        work_.band[j][support.knot(a)][b - a] +=
            static_cast<float>(squares * support.weight[a] * support.weight[b]);
      }
    }
  }
}

// Row by row, and in a row what a number takes from those behind it as soon as it is known: they
// wait for it alone.
void Engine::factorise_geometry(Units columns) {
  for (std::size_t i = columns.first; i < columns.last; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const bool held = is_held(i) || is_held(j);
      lower(i, j) = held ? (i == j ? 1 : 0) : upper(j, i) / scales_.sigma_squared;
    }
    if (!is_held(i)) {
      lower(i, i) += 1 / prior_variance(i);
      if (proximal_) lower(i, i) += 1 / proximal_variance(i);
    }
    for (std::size_t k = 0; k < i; ++k) {
      const double known = lower(i, k) /= lower(k, k);
      for (std::size_t j = k + 1; j < i; ++j) lower(i, j) -= known * lower(j, k);
      lower(i, i) -= known * known;
    }
    lower(i, i) = std::sqrt(lower(i, i));
  }
}

void Engine::solve_lower(std::array<double, kMaxGeometry>& b, std::size_t first) const {
  for (std::size_t k = first; k < columns_; ++k) {
    const double known = b[k] /= lower(k, k);
    for (std::size_t i = k + 1; i < columns_; ++i) b[i] -= lower(i, k) * known;
  }
}

void Engine::solve_upper(std::array<double, kMaxGeometry>& b) const {
  for (std::size_t i = columns_; i-- > 0;) {
    b[i] /= lower(i, i);
    for (std::size_t k = 0; k < i; ++k) b[k] -= lower(i, k) * b[i];
  }
}

void Engine::begin_geometry() {
  for (std::size_t c = 0; c < columns_; ++c) {
    work_.gradient[c] = probes_ ? -work_.step[c] / prior_variance(c)
                                : -(deviation(c) + work_.step[c]) / prior_variance(c) -
                                      work_.step[c] / proximal_variance(c);
  }
}

void Engine::pull_geometry(Units rows) {
  auto& x = work_.gradient;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    const FitRow& row = rows_[k];
    if (row.held_out || row.weight == 0) continue;
    const Vector3 r = row.weight / scales_.sigma_squared * (precision(row) * row.residual);
    for_columns(row, frames_of(k),
                [&](std::size_t column, const Vector3& by) { x[column] += by.dot(r); });
  }
}

void Engine::solve_geometry() {
  auto& x = work_.gradient;
  for (std::size_t c = 0; c < columns_; ++c) {
    if (is_held(c)) x[c] = 0;
  }
  solve_lower(x, 0);
  solve_upper(x);
  for (std::size_t c = 0; c < columns_; ++c) work_.step[c] += x[c];
}

void Engine::follow_geometry(Units rows) {
  const auto& x = work_.gradient;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    FitRow& row = rows_[k];
    if (row.held_out) continue;
    Vector3 moved = Vector3::Zero();
    for_columns(row, frames_of(k),
                [&](std::size_t column, const Vector3& by) { moved += x[column] * by; });
    row.residual -= moved;
  }
}

}  // namespace armsig::calibration
