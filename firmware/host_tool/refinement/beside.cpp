// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/beside.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/calibration/standing_still.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/refinement/weights_along.hpp"

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

// Of all measured rows that it stands for.
double squares_of(const FitRow& row) {
  return row.merged.count * row.residual.squaredNorm() + row.merged.scatter_m2;
}

}  // namespace

Beside::Beside(const CalibrationLog& log, std::vector<FitRow> rows, FitStart at,
               const calibration::PlayBlock::Numbers& half, Asked asked) {
  if (asked == Asked::kVertical) {
    at.model.gravity.clear();
  } else if (at.model.gravity.empty()) {
    calibration::choose_gravity_terms(log.nominal, at.model);
  }
  const std::size_t columns = Engine::columns(at.model, at.targets.size());
  if (columns > calibration::kMaxGeometry || rows.empty()) return;
  std::vector<double> matrix(calibration::matrix_size(columns));
  const auto work = std::make_unique<calibration::WorkspaceFor<kMaxJoints>>();
  calibration::PlayBlock play;
  play.half = half;
  Engine engine(at.model, at.targets, rows, {}, matrix, *work);
  engine.find_play(play);
  engine.evaluate();
  prior_.resize(static_cast<Eigen::Index>(columns));
  for (std::size_t c = 0; c < columns; ++c) {
    prior_[static_cast<Eigen::Index>(c)] = 1 / (kWider * engine.prior_variance(c));
  }
  weights_ = at.model;
  weights_.gravity.clear();
  at_up_0_ = at.model.up_0;
  choose_unknowns(log.nominal, rows);
  if (asked == Asked::kVertical) choose_weights(log.nominal);
  calibration::GeometryColumns J;
  ChainFrames frames;
  sum(rows, [&](const FitRow& row, Columns& all) {
    calibration::evaluate_chain(at.model, row.readings, at.targets[row.target].link, frames);
    engine.fill(row, frames, J);
    all.setZero(3, prior_.size() + static_cast<Eigen::Index>(unknowns_.size()));
    for (Eigen::Index c = 0; c < prior_.size(); ++c) {
      for (Eigen::Index i = 0; i < 3; ++i) {
        all(i, c) = J.d[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
      }
    }
    add_beside(row, frames, at, all);
    if (row.is_range()) all = (row.p_S * (row.p_S.transpose() * all)).eval();
  });
}

// Weighted sums by one scale of what is a blunder.
class Beside::Batch {
 public:
  Batch(double scale_m, Eigen::Index size)
      : scale_m_(scale_m),
        sums_{.squares = Eigen::MatrixXd::Zero(size, size), .pull = Eigen::VectorXd::Zero(size)},
        rows_(Eigen::MatrixXd::Zero(3 * kRowsABatch, size)) {}

  void add(const FitRow& row, double length_m, const Columns& J, bool last) {
    const double share = length_m / (kSofter * scale_m_);
    const double root = 1 / (1 + share * share);  // of the weight
    const double count = row.merged.count;
    sums_.pull.noalias() += count * root * root * (J.transpose() * row.residual);
    sums_.residuals += root * root * squares_of(row);
    sums_.numbers += root * root * static_cast<double>(row.scalars());
    rows_.middleRows<3>(3 * filled_) = std::sqrt(count) * root * J;
    if (++filled_ < kRowsABatch && !last) return;
    const auto filled = rows_.topRows(3 * filled_);
    sums_.squares.selfadjointView<Eigen::Lower>().rankUpdate(filled.transpose());
    filled_ = 0;
  }

  [[nodiscard]] Sums take() {
    sums_.squares.triangularView<Eigen::StrictlyUpper>() = sums_.squares.transpose();
    return std::move(sums_);
  }

 private:
  double scale_m_;
  Sums sums_;
  Eigen::MatrixXd rows_;
  Eigen::Index filled_ = 0;
};

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

// The furthest origin of every joint first, so that few rows have one weight for each joint. Those
// of a prismatic joint do not depend on the origin: one is enough.
void Beside::choose_weights(const Arm& arm) {
  std::erase_if(unknowns_, [](const Unknown& unknown) { return unknown.of != Of::kGain; });
  const std::size_t n = arm.joints.size();
  for (std::size_t origin = n; origin > 0; --origin) {
    for (std::size_t j = 0; j < origin; ++j) {
      if (weights_.gravity.full()) return;
      if (origin < n && arm.joints[j].type != JointType::kRevolute) continue;
      const auto joint = static_cast<std::uint8_t>(j);
      weights_.gravity.push_back({joint, static_cast<std::uint8_t>(origin), 0});
      for (std::uint8_t axis = 0; axis < 3; ++axis) unknowns_.push_back({Of::kWeight, joint, axis});
    }
  }
}

void Beside::add_beside(const FitRow& row, const ChainFrames& frames, const FitStart& at,
                        Columns& J) {
  const calibration::ModelTarget& target = at.targets[row.target];
  const Vector3 p_S = frames.X_SL * target.p_L;
  const std::array<calibration::GravityLevers, 3> levers = levers_along_axes(frames.effective);
  Eigen::Index column = prior_.size();
  std::size_t weight = 0;  // three unknowns each
  for (const Unknown& unknown : unknowns_) {
    const std::size_t j = unknown.joint;
    const Eigen::Index own = column++;
    const double factor = unknown.of == Of::kWeight
                              ? levers[unknown.from][weight++ / 3]
                              : factor_of(unknown.of, row, frames, j, unknown.from);
    if (j < target.link) J.col(own) = factor * motion_beside(at, frames, j, p_S);
  }
}

// Of all weights, with each axis of the base frame as the vertical.
std::array<calibration::GravityLevers, 3> Beside::levers_along_axes(const JointVector& effective) {
  std::array<calibration::GravityLevers, 3> levers{};
  for (Eigen::Index axis = 0; axis < 3 && !weights_.gravity.empty(); ++axis) {
    weights_.up_0 = Vector3::Unit(axis);
    calibration::gravity_levers(weights_, effective, levers[static_cast<std::size_t>(axis)]);
  }
  return levers;
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
    case Of::kWeight:
    case Of::kCoupling:
      break;
  }
  return row.readings[from];
}

// `fill(row, J)` gives the columns of a row; of a range, what is along its way.
template <typename Fill>
void Beside::sum(const std::vector<FitRow>& rows, Fill fill) {
  std::vector<double> lengths_m;
  double squares = 0;
  double measured = 0;
  for (const FitRow& row : rows) {
    lengths_m.push_back(std::sqrt(squares_of(row) / row.merged.count));
    squares += squares_of(row);
    measured += row.merged.count;
  }
  const double fine_m = std::max(kLeastSigma_m, sigma_by_median(lengths_m));
  const double coarse_m = std::max(fine_m, std::sqrt(squares / (3 * measured)));
  const Eigen::Index size = prior_.size() + static_cast<Eigen::Index>(unknowns_.size());
  std::array<Batch, 2> batches{Batch(fine_m, size), Batch(coarse_m, size)};
  Columns J;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    fill(rows[k], J);
    for (Batch& batch : batches) batch.add(rows[k], lengths_m[k], J, k + 1 == rows.size());
  }
  for (Batch& batch : batches) sums_.push_back(batch.take());
}

bool Beside::tells(Eigen::Index columns) const {
  return !sums_.empty() &&
         sums_.front().numbers >= kNumbersAnUnknown * static_cast<double>(columns);
}

// The coefficient of each weight is an unknown, and two of the vertical they have in common.
Eigen::Index Beside::weights_told() const {
  auto count = static_cast<Eigen::Index>(weights_.gravity.size());
  while (count > 0 && !tells(first_of(Of::kWeight) + count + 2)) --count;
  return count;
}

Eigen::Index Beside::first_of(Of of) const {
  return prior_.size() + (std::ranges::find(unknowns_, of, &Unknown::of) - unknowns_.begin());
}

// Of `count` columns from `first` on, the columns before `before` taken out.
Beside::Reduced Beside::reduced(const Sums& sums, Eigen::Index first, Eigen::Index count,
                                Eigen::Index before) const {
  Reduced reduced;
  reduced.freedom = std::max(1.0, sums.numbers - static_cast<double>(before));
  Eigen::MatrixXd H = sums.squares.topLeftCorner(before, before);
  const double variance = sums.residuals / reduced.freedom;
  H.diagonal().head(prior_.size()) += variance * prior_;
  // What is beside the fit is not known beforehand: next to nothing holds it.
  H.diagonal().array() += 1e-12 * H.diagonal().mean();
  const Eigen::LDLT<Eigen::MatrixXd> factor(H);
  const Eigen::VectorXd pull = sums.pull.head(before);
  const Eigen::VectorXd step = factor.solve(pull);
  reduced.left = std::max(sums.residuals - pull.dot(step), 1e-9 * sums.residuals);
  const Eigen::MatrixXd across = sums.squares.block(0, first, before, count);
  reduced.own =
      sums.squares.block(first, first, count, count) - across.transpose() * factor.solve(across);
  reduced.own.diagonal() += 1e-6 * sums.squares.diagonal().segment(first, count);
  reduced.score = sums.pull.segment(first, count) - across.transpose() * step;
  return reduced;
}

Beside::Worth Beside::worth(const Sums& sums, Eigen::Index first, Eigen::Index count,
                            Eigen::Index before) const {
  const auto [own, score, left, freedom] = reduced(sums, first, count, before);
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
  const Eigen::Index before = first_of(Of::kCoupling);
  return before > first_of(Of::kPlay) && tells(before) ? worth_of_play().nats : 0;
}

std::uint8_t Beside::first_sides() const {
  std::uint8_t up = 0;
  const Eigen::Index before = first_of(Of::kCoupling);
  if (before == first_of(Of::kPlay) || !tells(before)) return up;
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
  const Eigen::Index before = first_of(Of::kCoupling);
  if (!tells(before + 1)) return all;
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

bool Beside::tells_pairs_apart() const {
  return tells(prior_.size() + static_cast<Eigen::Index>(unknowns_.size()));
}

SuspectedVertical Beside::vertical() const {
  SuspectedVertical best{.up_0 = at_up_0_};
  const Eigen::Index first = first_of(Of::kWeight);
  const Eigen::Index count = 3 * weights_told();
  if (count == 0) return best;
  for (const Sums& sums : sums_) {
    const auto [own, score, left, freedom] = reduced(sums, first, count, first);
    WeightsAlong weights(own, score, left / freedom);
    const double along_own = weights.gain(at_up_0_);
    const auto [up_0, gain] = weights.best();
    const double share = (left - std::min(gain, (1 - 1e-9) * left)) / (left - along_own);
    const double nats = -0.5 * freedom * std::log(share) - std::log(freedom);
    if (nats > best.nats) best = {up_0, nats, std::sqrt(share)};
  }
  return best;
}

}  // namespace armsig::tool
