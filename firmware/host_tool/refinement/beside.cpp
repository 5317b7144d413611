// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/beside.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/calibration/standing_still.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

using calibration::ChainFrames;
using calibration::Engine;
using calibration::FitRow;

namespace {

// Of the engine's priors, in variance: what the fit could do is taken out generously.
constexpr double kWider = 25;
// Of the scale of the residuals, where a row weighs a quarter.
constexpr double kSofter = 4;
// Numbers for an unknown, from which on few rows do not look like play by chance.
constexpr double kNumbersAnUnknown = 2;

Vector3 motion_beside(const FitStart& at, const ChainFrames& frames, std::size_t joint,
                      const Vector3& p_S) {
  const Pose& X_SJ = frames.X_SJ[joint];
  const Vector3 z = X_SJ.R.col(2);
  const bool turns = at.model.joints[joint].type == JointType::kRevolute;
  return turns ? Vector3(z.cross(p_S - X_SJ.p)) : z;
}

}  // namespace

Beside::Beside(const CalibrationLog& log, std::vector<FitRow> rows, FitStart at,
               const calibration::PlayBlock::Numbers& half) {
  if (at.model.gravity.empty()) calibration::choose_gravity_terms(log.nominal, at.model);
  const std::size_t columns = Engine::columns(at.model, at.targets.size());
  if (columns > calibration::kMaxGeometry || rows.empty()) return;
  std::vector<ChainFrames> cache(rows.size());
  std::vector<double> matrix(calibration::matrix_size(columns));
  const auto work = std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  calibration::PlayBlock play;
  play.half = half;
  Engine engine(at.model, at.targets, rows, cache, matrix, *work);
  engine.find_play(play);
  engine.evaluate();
  prior_.resize(static_cast<Eigen::Index>(columns));
  for (std::size_t c = 0; c < columns; ++c) {
    prior_[static_cast<Eigen::Index>(c)] = 1 / (kWider * engine.prior_variance(c));
  }
  choose_unknowns(log.nominal, rows);
  std::vector<Columns> all;
  calibration::GeometryColumns J;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    engine.fill(rows[k], cache[k], J);
    all.emplace_back(Columns::Zero(3, prior_.size() + static_cast<Eigen::Index>(unknowns_.size())));
    for (Eigen::Index c = 0; c < prior_.size(); ++c) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        all.back()(i, c) = J.d[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
      }
    }
    add_beside(rows[k], cache[k], at, all.back());
  }
  sum(rows, all);
}

void Beside::choose_unknowns(const Arm& arm, const std::vector<FitRow>& rows) {
  std::array<bool, kMaxJoints> moved{};
  const auto add = [&](Of of, std::size_t joint, std::size_t from) {
    unknowns_.push_back({of, static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(from)});
  };
  const std::size_t n = arm.joints.size();
  for (std::size_t j = 0; j < n; ++j) {
    moved[j] = !calibration::stood_still(
        rows, [](const FitRow& row) { return row.readings; }, j, arm.joints[j].type);
    if (moved[j]) add(Of::kGain, j, j);
  }
  std::uint8_t some = 0;
  std::uint8_t all = 0xFF;
  for (const FitRow& row : rows) {
    some = static_cast<std::uint8_t>(some | row.sided);
    all = static_cast<std::uint8_t>(all & row.sided);
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (moved[j] && (some >> j & 1U) != 0) add(Of::kPlay, j, j);
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (moved[j] && (some & ~all) >> j & 1U) add(Of::kFirst, j, j);
  }
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      if (i == j || !moved[i] || !moved[j] || arm.joints[i].type != arm.joints[j].type) continue;
      add(Of::kCoupling, j, i);
    }
  }
}

void Beside::add_beside(const FitRow& row, const ChainFrames& frames, const FitStart& at,
                        Columns& J) const {
  const calibration::ModelTarget& target = at.targets[row.target];
  const Vector3 p_S = frames.X_SL * target.p_L;
  Eigen::Index column = prior_.size();
  for (const Unknown& unknown : unknowns_) {
    const std::size_t j = unknown.joint;
    const Eigen::Index own = column++;
    if (j >= target.link) continue;
    J.col(own) =
        factor_of(unknown.of, row, frames, j, unknown.from) * motion_beside(at, frames, j, p_S);
  }
}

// What of the joint's motion an unknown of unit size is.
double Beside::factor_of(Of of, const FitRow& row, const ChainFrames& frames, std::size_t joint,
                         std::size_t from) {
  switch (of) {
    case Of::kGain:
      return frames.effective[joint];
    case Of::kPlay:
      return -calibration::side_at(row, joint);
    case Of::kFirst:
      return (row.sided >> joint & 1U) == 0 ? -1 : 0;
    case Of::kCoupling:
      break;
  }
  return row.readings[from];
}

// Of a range, only what is along its way counts.
void Beside::sum(const std::vector<FitRow>& rows, const std::vector<Columns>& all) {
  std::vector<double> lengths_m;
  double squares = 0;
  for (const FitRow& row : rows) {
    lengths_m.push_back(row.residual.norm());
    squares += row.residual.squaredNorm();
  }
  const double fine_m = std::max(kLeastSigma_m, sigma_by_median(lengths_m));
  const double coarse_m =
      std::max(fine_m, std::sqrt(squares / (3 * static_cast<double>(rows.size()))));
  const Eigen::Index size = prior_.size() + static_cast<Eigen::Index>(unknowns_.size());
  for (const double scale_m : {fine_m, coarse_m}) {
    Sums sums{.squares = Eigen::MatrixXd::Zero(size, size), .pull = Eigen::VectorXd::Zero(size)};
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double share = lengths_m[k] / (kSofter * scale_m);
      const double weight = 1 / ((1 + share * share) * (1 + share * share));
      Columns J = all[k];
      if (rows[k].is_range()) J = rows[k].p_S * (rows[k].p_S.transpose() * J);
      sums.squares.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose(), weight);
      sums.pull.noalias() += weight * (J.transpose() * rows[k].residual);
      sums.residuals += weight * rows[k].residual.squaredNorm();
      sums.numbers += weight * static_cast<double>(rows[k].scalars());
    }
    sums.squares.triangularView<Eigen::StrictlyUpper>() = sums.squares.transpose();
    sums_.push_back(std::move(sums));
  }
}

bool Beside::tells() const {
  if (sums_.empty()) return false;
  const auto size = static_cast<double>(sums_.front().pull.size());
  return sums_.front().numbers >= kNumbersAnUnknown * size;
}

Eigen::Index Beside::first_of(Of of) const {
  return prior_.size() + (std::ranges::find(unknowns_, of, &Unknown::of) - unknowns_.begin());
}

// Of `count` columns from `first` on, the columns before `before` taken out.
Beside::Worth Beside::worth(const Sums& sums, Eigen::Index first, Eigen::Index count,
                            Eigen::Index before) const {
  const double freedom = std::max(1.0, sums.numbers - static_cast<double>(before));
  Eigen::MatrixXd H = sums.squares.topLeftCorner(before, before);
  const double variance = sums.residuals / freedom;
  H.diagonal().head(prior_.size()) += variance * prior_;
  // What is beside the fit is not known beforehand: next to nothing holds it.
  H.diagonal().array() += 1e-12 * H.diagonal().mean();
  const Eigen::LDLT<Eigen::MatrixXd> factor(H);
  const Eigen::VectorXd pull = sums.pull.head(before);
  const Eigen::VectorXd step = factor.solve(pull);
  const double left = std::max(sums.residuals - pull.dot(step), 1e-9 * sums.residuals);
  const Eigen::MatrixXd across = sums.squares.block(0, first, before, count);
  Eigen::MatrixXd own =
      sums.squares.block(first, first, count, count) - across.transpose() * factor.solve(across);
  own.diagonal() += 1e-6 * sums.squares.diagonal().segment(first, count);
  const Eigen::VectorXd score = sums.pull.segment(first, count) - across.transpose() * step;
  const Eigen::LDLT<Eigen::MatrixXd> of_own(own);
  Worth worth;
  worth.size = of_own.solve(score);
  const double gain = std::clamp(score.dot(worth.size), 0.0, (1 - 1e-9) * left);
  worth.nats = -0.5 * freedom * std::log1p(-gain / left) -
               0.5 * static_cast<double>(count) * std::log(freedom);
  const Eigen::MatrixXd inverse = of_own.solve(Eigen::MatrixXd::Identity(count, count));
  worth.sigma = ((left - gain) / freedom * inverse.diagonal()).cwiseSqrt();
  return worth;
}

Beside::Worth Beside::worth_of_play() const {
  const Eigen::Index first = first_of(Of::kPlay);
  const Eigen::Index count = first_of(Of::kCoupling) - first;
  Worth most;
  for (const Sums& sums : sums_) {
    Worth one = worth(sums, first, count, first);
    if (most.size.size() == 0 || one.nats > most.nats) most = std::move(one);
  }
  return most;
}

double Beside::nats_of_play() const {
  return tells() && first_of(Of::kCoupling) > first_of(Of::kPlay) ? worth_of_play().nats : 0;
}

std::uint8_t Beside::first_sides() const {
  std::uint8_t up = 0;
  if (!tells() || first_of(Of::kCoupling) == first_of(Of::kPlay)) return up;
  const Eigen::VectorXd size = worth_of_play().size;
  const Eigen::Index first = first_of(Of::kPlay) - prior_.size();
  const auto at = [&](Of of, std::uint8_t joint) {
    for (std::size_t k = 0; k < unknowns_.size(); ++k) {
      if (unknowns_[k].of == of && unknowns_[k].joint == joint) {
        return size[static_cast<Eigen::Index>(k) - first];
      }
    }
    return 0.0;
  };
  for (std::uint8_t j = 0; j < kMaxJoints; ++j) {
    if (at(Of::kPlay, j) * at(Of::kFirst, j) > 0) up = static_cast<std::uint8_t>(up | 1U << j);
  }
  return up;
}

std::vector<SuspectedPair> Beside::pairs() const {
  std::vector<SuspectedPair> all;
  if (!tells()) return all;
  const Eigen::Index before = first_of(Of::kCoupling);
  const auto tried =
      static_cast<double>(prior_.size() + static_cast<Eigen::Index>(unknowns_.size()) - before);
  for (std::size_t k = 0; k < unknowns_.size(); ++k) {
    const Unknown& unknown = unknowns_[k];
    if (unknown.of != Of::kCoupling) continue;
    SuspectedPair best;
    for (const Sums& sums : sums_) {
      const Worth one = worth(sums, prior_.size() + static_cast<Eigen::Index>(k), 1, before);
      const double nats = one.nats - std::log(tried);
      if (best.sigma > 0 && nats <= best.nats) continue;
      best = {{unknown.joint, unknown.from, one.size[0]}, one.sigma[0], nats};
    }
    all.push_back(best);
  }
  std::ranges::sort(all, std::ranges::greater(), &SuspectedPair::nats);
  return all;
}

}  // namespace armsig::tool
