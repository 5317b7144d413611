// SPDX-License-Identifier: MIT
// The joints' play, the other unknowns as they are.
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

using Index = Eigen::Index;

constexpr Index kUnknowns = kMaxJoints;

// Over all blocks. Twice as many change what is stated by less than a hundredth.
constexpr int kProbePasses = 4;

}  // namespace

// False: the row tells no side.
bool Engine::fill(const FitRow& row, const ChainFrames& frames, PlayColumns& columns) const {
  if (play_ == nullptr || row.sided == 0) return false;
  const ModelTarget& target = targets_[row.target];
  const Vector3 p_S = frames.X_SL * target.p_L;
  columns.fill(Vector3::Zero());
  for (std::size_t j = 0; j < target.link; ++j) {
    const double side = side_at(row, j);
    if (side == 0) continue;
    const bool revolute = model_.joints[j].type == JointType::kRevolute;
    columns[j] = -side * motion_of(revolute, frames.X_SJ[j], p_S);
  }
  return true;
}

// By how much play has moved the row's target.
Vector3 Engine::behind(const FitRow& row, const ChainFrames& frames) const {
  PlayColumns columns;
  Vector3 sum = Vector3::Zero();
  if (!fill(row, frames, columns)) return sum;
  for (std::size_t j = 0; j < kMaxJoints; ++j) {
    sum += play_->half(static_cast<Index>(j)) * columns[j];
  }
  return sum;
}

double Engine::play_variance(std::size_t joint) const {
  const double unit = joint < model_.joint_count() ? map_unit(model_.joints[joint].type) : 1;
  return scales_.play * unit * unit;
}

double Engine::play_squares() const {
  double sum = 0;
  for (std::size_t j = 0; play_on_ && j < model_.joint_count(); ++j) {
    const double half = play_->half(static_cast<Index>(j));
    sum += half * half / play_variance(j);
  }
  return sum;
}

void Engine::assemble_play(const FitRow& row, const ChainFrames& frames, const Matrix3& W) {
  PlayColumns columns;
  if (!fill(row, frames, columns)) return;
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    const Vector3 pulled = W * columns[j];
    for (std::size_t k = 0; k <= j; ++k) {
      const double sum = pulled.dot(columns[k]);
      play_->information(static_cast<Index>(j), static_cast<Index>(k)) += sum;
      if (k < j) play_->information(static_cast<Index>(k), static_cast<Index>(j)) += sum;
    }
  }
}

void Engine::factorise_play() {
  play_->factor = play_->information / scales_.sigma_squared;
  for (std::size_t j = 0; j < kMaxJoints; ++j) {
    play_->factor(static_cast<Index>(j), static_cast<Index>(j)) += 1 / play_variance(j);
  }
  if (!numerics::factor_positive(play_->factor, kUnknowns)) failed_ = Error::kSingular;
}

void Engine::improve_play() {
  if (!play_on_ || probes_) return;
  const std::size_t work = frames_work() + kPlayRow;
  agenda_.put({&Engine::begin_play,
               of_rows(&Engine::pull_play, work),
               {&Engine::solve_play, kPlayFactor},
               of_rows(&Engine::follow_play, work)});
}

void Engine::begin_play() {
  for (std::size_t j = 0; j < kMaxJoints; ++j) {
    const auto k = static_cast<Index>(j);
    play_->gradient(k) = -(play_->half(k) + play_->step(k)) / play_variance(j);
  }
}

void Engine::add_pull(Units rows, double* of_joints) {
  PlayColumns columns;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    const FitRow& row = rows_[k];
    if (row.held_out || row.weight == 0 || !fill(row, frames_of(k), columns)) continue;
    const Vector3 r = row.weight / scales_.sigma_squared * (precision(row) * row.residual);
    for (std::size_t j = 0; j < kMaxJoints; ++j) {
      of_joints[j] += columns[j].dot(r);
    }
  }
}

void Engine::pull_play(Units rows) { add_pull(rows, play_->gradient.data()); }

void Engine::solve_play() {
  factorise_play();
  numerics::solve_lower(play_->factor, play_->gradient, kUnknowns);
  numerics::solve_lower_transposed(play_->factor, play_->gradient, kUnknowns);
  play_->step += play_->gradient;
}

void Engine::follow_play(Units rows) {
  PlayColumns columns;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    FitRow& row = rows_[k];
    if (row.held_out || !fill(row, frames_of(k), columns)) continue;
    for (std::size_t j = 0; j < kMaxJoints; ++j) {
      row.residual -= play_->gradient(static_cast<Index>(j)) * columns[j];
    }
  }
}

// One scale for all joints: of a few numbers each would be found by itself, and by chance.
PriorGroup Engine::play_group() {
  factorise_play();
  PriorGroup group;
  for (std::size_t j = 0; j < model_.joint_count(); ++j) {
    const auto k = static_cast<Index>(j);
    if (!(play_->information(k, k) > 0)) continue;
    const double unit = play_variance(j) / scales_.play;
    PlayBlock::Numbers e = PlayBlock::Numbers::Unit(k);
    numerics::solve_lower(play_->factor, e, kUnknowns);
    group.squares += play_->half(k) * play_->half(k) / unit;
    group.trace += e.squaredNorm() / unit;
    group.unknowns += 1;
  }
  return group;
}

void Engine::cover_play() {
  if (!play_on_) return;
  factorise_play();
  play_->gradient.setZero();
  play_->told.setZero();
  joint_probed_ = 0;
  agenda_.put({of_rows(&Engine::pull_play, frames_work() + kPlayRow), &Engine::probe_next_play});
}

// How far the other unknowns follow a joint's play: they are fitted to its column of the rows.
void Engine::probe_next_play() {
  while (joint_probed_ < model_.joint_count() &&
         !(play_->information(static_cast<Index>(joint_probed_),
                              static_cast<Index>(joint_probed_)) > 0)) {
    ++joint_probed_;
  }
  probes_ = joint_probed_ < model_.joint_count();
  if (!probes_) {
    agenda_.put({evaluation()});
    return;
  }
  clear_steps();
  passes_left_ = kProbePasses;
  const std::size_t work = frames_work() + kPlayRow;
  agenda_.put({of_rows(&Engine::lay_play, work), &Engine::improve_geometry, &Engine::improve_maps,
               of_rows(&Engine::add_left_of_play, work), &Engine::end_probe});
}

void Engine::lay_play(Units rows) {
  PlayColumns columns;
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    FitRow& row = rows_[k];
    if (row.held_out) continue;
    const bool tells = fill(row, frames_of(k), columns);
    row.residual = tells ? columns[joint_probed_] : Vector3::Zero();
  }
}

void Engine::add_left_of_play(Units rows) {
  add_pull(rows, play_->told.col(static_cast<Index>(joint_probed_)).data());
}

void Engine::end_probe() {
  ++joint_probed_;
  probe_next_play();
}

Matrix3 Engine::play_covariance(const FitRow& row, const ChainFrames& frames) const {
  PlayColumns columns;
  Matrix3 sum = Matrix3::Zero();
  if (!play_on_ || !fill(row, frames, columns)) return sum;
  std::array<PlayBlock::Numbers, 3> whitened;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < kMaxJoints; ++j) {
      whitened[i](static_cast<Index>(j)) = columns[j](static_cast<Index>(i));
    }
    numerics::solve_lower(play_->factor, whitened[i], kUnknowns);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum(static_cast<Index>(i), static_cast<Index>(k)) = whitened[i].dot(whitened[k]);
    }
  }
  return sum;
}

}  // namespace armsig::calibration
