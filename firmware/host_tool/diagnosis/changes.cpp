// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/changes.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/base/low_discrepancy.hpp"
#include "firmware/host_tool/diagnosis/reading_order.hpp"
#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"

namespace armsig::tool {

Matrix3 strain_of(const Strains& e) {
  Matrix3 strain;
  strain << e[0], e[2], e[3], e[2], e[1], e[4], e[3], e[4], -e[0] - e[1];
  return strain;
}

namespace {

constexpr std::size_t kFewestRows = 24;
constexpr std::size_t kFewestOfPart = 4;  // rows before and after
constexpr double kFarthest = 30;
constexpr double kUsualSize = 0.03;  // of a change, 1 sigma: metres, radians, a share
// Of the difference between two axes of a sensor. A test of first order tells nothing of more, and
// no sensor has it.
constexpr double kLargestStrain = 0.1;

// How much less usual than a sensor that was moved, as a logarithm of odds. An arm or a sensor that
// imitates another cause exactly is thereby named by the most usual one.
double surprise(Change::Of of) {
  switch (of) {
    case Change::Of::kSensor:
      return 0;
    case Change::Of::kTarget:
      return 1;
    case Change::Of::kZero:
      return 2;
    case Change::Of::kSensorAndTarget:
    case Change::Of::kLoad:
      return 3;
    case Change::Of::kZeros:
      return 4;
    case Change::Of::kGear:
    case Change::Of::kSight:
    case Change::Of::kLag:
      return 5;
    case Change::Of::kLengths:
      return 6;
    case Change::Of::kLink:
    case Change::Of::kStrain:
      return 8;
  }
  return 0;
}

struct Candidate {
  Change::Of of;
  std::size_t index;
  std::vector<DeviatingChain::Columns> columns;  // of the chain, or beyond them
  enum class Pace : std::uint8_t { kAny, kAtOnce, kSlow } pace = Pace::kAny;
};

std::vector<Candidate> candidates_of(const Evidence& evidence, const DeviatingChain& chain,
                                     const UnchangingArm& arm) {
  std::vector<Candidate> all{
      {Change::Of::kSensor, 0, {chain.of_base()}},
      {Change::Of::kLengths, 0, {chain.of_lengths()}, Candidate::Pace::kSlow},
      {Change::Of::kSight, 0, {arm.of_sight()}, Candidate::Pace::kSlow}};
  Candidate zeros{Change::Of::kZeros, 0, {}, Candidate::Pace::kAtOnce};
  for (std::size_t j = 0; j < evidence.arm.joints.size(); ++j) {
    zeros.columns.push_back(chain.of_zero(j));
    all.push_back({Change::Of::kZero, j, {chain.of_zero(j)}});
    all.push_back({Change::Of::kGear, j, {arm.of_gear(j)}, Candidate::Pace::kAtOnce});
    if (j + 1 < evidence.arm.joints.size()) {
      all.push_back({Change::Of::kLink, j, {chain.of_link(j)}});
    }
  }
  all.push_back(zeros);
  all.push_back({Change::Of::kLoad, 0, {arm.of_load()}, Candidate::Pace::kAtOnce});
  for (std::size_t t = 0; t < chain.targets().size(); ++t) {
    const auto number = static_cast<std::size_t>(chain.targets()[t].number);
    all.push_back({Change::Of::kTarget, number, {chain.of_target(t)}});
    all.push_back({Change::Of::kSensorAndTarget,
                   number,
                   {chain.of_base(), chain.of_target(t)},
                   Candidate::Pace::kAtOnce});
  }
  return all;
}

Eigen::Matrix<double, 3, kStrains> moved_by_strains(const Vector3& p) {
  Eigen::Matrix<double, 3, kStrains> moved;
  for (Eigen::Index i = 0; i < kStrains; ++i) moved.col(i) = strain_of(Strains::Unit(i)) * p;
  return moved;
}

// Sums over the rows, each weighed by its share of the change.
struct Sums {
  explicit Sums(Eigen::Index size)
      : once(Eigen::MatrixXd::Zero(size, size)),
        twice(Eigen::MatrixXd::Zero(size, size)),
        score(Eigen::VectorXd::Zero(size)) {}

  void add(const Eigen::Matrix3Xd& J, const Vector3& residual, double weight) {
    once.noalias() += weight * (J.transpose() * J);
    score.noalias() += weight * (J.transpose() * residual);
  }
  void add_share(const Eigen::Matrix3Xd& J, const Vector3& residual, double weight, double share) {
    add(J, residual, weight * share);
    twice.noalias() += weight * share * share * (J.transpose() * J);
  }

  Eigen::MatrixXd once;
  Eigen::MatrixXd twice;  // by the square of the share; not of whole ones, where it is `once`
  Eigen::VectorXd score;
};

class ScoreTest {
 public:
  ScoreTest(const Evidence& evidence, const DeviatingChain& chain,
            const std::vector<Vector3>& residuals_S, Backlash backlash)
      : evidence_(evidence),
        chain_(chain),
        residuals_(residuals_S),
        order_(evidence),
        arm_(evidence, chain, residuals_S, backlash) {}

  // Whether an unchanging arm misses no more than what rounding leaves, of which nothing can be
  // said.
  [[nodiscard]] bool is_computed() const {
    return !(arm_.squares() > kComputed_m * kComputed_m * arm_.weight());
  }

  [[nodiscard]] const UnchangingArm& arm() const { return arm_; }

  void consider(const std::vector<Candidate>& candidates, const Sums& sums, bool slow,
                std::size_t from) {
    const Eigen::MatrixXd& squares = slow ? sums.twice : sums.once;
    const Eigen::MatrixXd of_all = sums.once(Eigen::all, moved_);
    const Eigen::MatrixXd taken = arm_.inverse() * of_all;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const Candidate& candidate = candidates[c];
      if (candidate.pace == (slow ? Candidate::Pace::kAtOnce : Candidate::Pace::kSlow)) continue;
      const std::vector<Eigen::Index>& own = places_[c];
      const Eigen::MatrixXd across = of_all(Eigen::all, among_moved_[c]);
      const Eigen::MatrixXd of_own = squares(own, own);
      Scored scored{.across = across,
                    .usual = of_own,
                    .left = of_own - across.transpose() * taken(Eigen::all, among_moved_[c]),
                    .score = sums.score(own) - across.transpose() * arm_.step()};
      score_of(scored, candidates.size());
      scored.evidence -= surprise(candidate.of);
      if (best_ && scored.evidence <= best_->evidence) continue;
      const double shift_m = moved_by(own, scored.size, from);
      if (!is_told(shift_m)) continue;
      best_ = change_of(scored);
      best_->of = candidate.of;
      best_->index = candidate.index;
      best_->slow = slow;
      best_->first_line = evidence_.rows[from].line;
      best_->shift_m = shift_m;
      note_parts(candidate, from, *best_);
    }
  }

  // A strain is no unknown of the arm: rows know it by where they are.
  [[nodiscard]] std::optional<Change> strain() const {
    Vector3 middle = Vector3::Zero();
    for (const EvidenceRow& row : evidence_.rows) middle += row.p_S;
    middle /= static_cast<double>(evidence_.rows.size());
    std::vector<Eigen::Matrix3Xd> moved;
    for (const EvidenceRow& row : evidence_.rows) {
      moved.emplace_back(moved_by_strains(row.p_S - middle));
    }
    Change found = all_along(Change::Of::kStrain, moved);
    const Vector3 along_axes = strain_of(found.size).selfadjointView<Eigen::Lower>().eigenvalues();
    if (along_axes.maxCoeff() - along_axes.minCoeff() > kLargestStrain) return std::nullopt;
    return found;
  }

  // Positions that were taken while the arm was still on its way from the row before: by one share
  // of the way of all joints.
  [[nodiscard]] Change lag() const {
    std::vector<Eigen::Matrix3Xd> moved;
    for (const EvidenceRow& row : evidence_.rows) {
      moved.emplace_back(Vector3::Zero());
      if (row.earlier[0].q.empty()) continue;
      const JointVector there = effective_readings(evidence_.arm, row.q);
      const JointVector before = effective_readings(evidence_.arm, row.earlier[0].q);
      const Eigen::Matrix3Xd motions = chain_.motions(row);
      for (std::size_t j = 0; j < there.size(); ++j) {
        moved.back() += (before[j] - there[j]) * motions.col(static_cast<Eigen::Index>(j));
      }
    }
    return all_along(Change::Of::kLag, moved);
  }

  std::optional<Change> run(const std::vector<Candidate>& candidates) {
    find_places(candidates);
    Sums sums(arm_.size());
    const std::size_t rows = arm_.rows();
    for (std::size_t k = rows; k-- > kFewestOfPart;) {
      sums.add(arm_.derivatives(k), residuals_[k], arm_.weight(k));
      // What another configuration does as well is not asserted of time.
      if (k + kFewestOfPart <= rows && !order_.parts_at(k)) consider(candidates, sums, false, k);
    }
    if (order_.runs()) return best_;
    Sums growing(arm_.size());
    for (std::size_t k = 0; k < rows; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(rows - 1);
      growing.add_share(arm_.derivatives(k), residuals_[k], arm_.weight(k), share);
    }
    consider(candidates, growing, true, 0);
    return best_;
  }

 private:
  // A candidate: what the rows say of it, and what that makes of it.
  struct Scored {
    Eigen::MatrixXd across;  // with the unknowns of an unchanging arm
    Eigen::MatrixXd usual;   // of its own
    Eigen::MatrixXd left;    // of that, what an unchanging arm can not do
    Eigen::VectorXd score;   // and of the residuals
    Eigen::VectorXd size = {};
    Eigen::VectorXd sigma = {};
    double gain = 0;
    double evidence = 0;
  };

  // `moved`: how each row is moved, a column an unknown that an arm does not have.
  [[nodiscard]] Change all_along(Change::Of of, const std::vector<Eigen::Matrix3Xd>& moved) const {
    const Eigen::Index own = moved.back().cols();
    Eigen::MatrixXd across = Eigen::MatrixXd::Zero(arm_.size(), own);
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(own, own);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(own);
    for (std::size_t k = 0; k < arm_.rows(); ++k) {
      across.noalias() += arm_.weight(k) * (arm_.derivatives(k).transpose() * moved[k]);
      squares.noalias() += arm_.weight(k) * (moved[k].transpose() * moved[k]);
      score.noalias() += arm_.weight(k) * (moved[k].transpose() * residuals_[k]);
    }
    Scored scored{.across = across,
                  .usual = squares,
                  .left = squares - across.transpose() * arm_.inverse() * across,
                  .score = score - across.transpose() * arm_.step()};
    score_of(scored, 1);
    scored.evidence -= surprise(of);
    Change found = change_of(scored);
    found.of = of;
    found.first_line = evidence_.rows.front().line;
    double moved_squares = 0;
    for (const Eigen::Matrix3Xd& row : moved) moved_squares += (row * found.size).squaredNorm();
    found.shift_m = std::sqrt(moved_squares / static_cast<double>(moved.size()));
    return found;
  }

  void score_of(Scored& scored, std::size_t candidates) const {
    constexpr double kWeight = 1 / (kUsualSize * kUsualSize);
    scored.usual.diagonal().array() += kWeight;
    scored.left.diagonal().array() += kWeight;
    const Eigen::MatrixXd inverse = inverse_of(scored.left, scored.usual.diagonal());
    scored.size = inverse * scored.score;
    scored.gain = std::clamp(scored.score.dot(scored.size), 0.0, (1 - 1e-12) * arm_.squares());
    const double freedom = 3 * static_cast<double>(arm_.rows()) - static_cast<double>(arm_.size());
    const double variance = (arm_.squares() - scored.gain) / std::max(1.0, freedom);
    scored.sigma = (variance * inverse.diagonal()).cwiseSqrt();
    const auto tried = static_cast<double>(candidates * arm_.rows());
    scored.evidence = -0.5 * freedom * std::log1p(-scored.gain / arm_.squares()) -
                      0.5 * static_cast<double>(scored.size.size()) * std::log(freedom) -
                      std::log(tried);
  }

  // What moves the rows by far more than they miss is hardly told from the arm itself.
  [[nodiscard]] bool is_told(double shift_m) const {
    return shift_m <= kFarthest * arm_.missed_m();
  }

  [[nodiscard]] Change change_of(const Scored& scored) const {
    Change change;
    change.last_line = evidence_.rows.back().line;
    change.size = scored.size;
    change.sigma = scored.sigma;
    change.before_m = arm_.missed_m();
    change.after_m = std::sqrt((arm_.squares() - scored.gain) / arm_.weight());
    change.evidence = scored.evidence;
    change.before_it = Eigen::VectorXd::Zero(chain_.all().count + arm_.beyond_chain());
    change.before_it.head(chain_.all().count) = arm_.without_gravity(scored.across * scored.size);
    change.after_it = change.before_it;
    return change;
  }

  // Of columns of the chain, among the unknowns of an unchanging arm.
  [[nodiscard]] std::vector<Eigen::Index> places_of(
      std::span<const DeviatingChain::Columns> columns) const {
    std::vector<Eigen::Index> places;
    for (const DeviatingChain::Columns& part : columns) {
      const auto [first, count] = arm_.place_of(part);
      for (Eigen::Index i = 0; i < count; ++i) places.push_back(first + i);
    }
    return places;
  }

  // Of every candidate; several have the same columns.
  void find_places(const std::vector<Candidate>& candidates) {
    for (const Candidate& candidate : candidates) {
      places_.push_back(places_of(candidate.columns));
      among_moved_.emplace_back();
      for (const Eigen::Index place : places_.back()) {
        const auto known = std::ranges::find(moved_, place);
        among_moved_.back().push_back(known - moved_.begin());
        if (known == moved_.end()) moved_.push_back(place);
      }
    }
  }

  [[nodiscard]] double moved_by(const std::vector<Eigen::Index>& places,
                                const Eigen::VectorXd& size, std::size_t from) const {
    double squares = 0;
    for (std::size_t k = from; k < arm_.rows(); ++k) {
      squares += (arm_.derivatives(k)(Eigen::all, places) * size).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(arm_.rows() - from));
  }

  // By what each part of it moves the rows, and what of the chain is off after it.
  void note_parts(const Candidate& candidate, std::size_t from, Change& change) const {
    Eigen::Index at = 0;
    for (const DeviatingChain::Columns& part : candidate.columns) {
      const Eigen::VectorXd own = change.size.segment(at, part.count);
      at += part.count;
      change.after_it.segment(part.first, part.count) -= own;
      change.parts_m.push_back(moved_by(places_of({&part, 1}), own, from));
    }
  }

  const Evidence& evidence_;
  const DeviatingChain& chain_;
  const std::vector<Vector3>& residuals_;
  ReadingOrder order_;
  UnchangingArm arm_;
  std::vector<Eigen::Index> moved_;                // by any candidate: places among the unknowns
  std::vector<std::vector<Eigen::Index>> places_;  // of each candidate
  std::vector<std::vector<Eigen::Index>> among_moved_;  // the same, by their places in `moved_`
  std::optional<Change> best_;
};

}  // namespace

std::optional<Change> likeliest_change(const Evidence& evidence, const DeviatingChain& chain,
                                       const std::vector<Vector3>& residuals_S, Backlash backlash) {
  if (evidence.rows.size() < kFewestRows) return std::nullopt;
  ScoreTest test(evidence, chain, residuals_S, backlash);
  if (test.is_computed()) return std::nullopt;
  auto change = test.run(candidates_of(evidence, chain, test.arm()));
  const auto take = [&](const Change& other) {
    if (!change || other.evidence > change->evidence) change = other;
  };
  take(test.lag());
  if (const auto strain = test.strain()) take(*strain);
  if (!change || !(change->evidence > 0)) return std::nullopt;
  return change;
}

std::vector<Vector3> moved_by_change(const Change& change, const Evidence& evidence,
                                     const DeviatingChain& chain) {
  const auto tool =
      std::ranges::find(chain.targets(), evidence.arm.joints.size(), &SeenTarget::link);
  if (tool == chain.targets().end()) return {};
  EvidenceRow row;
  row.target = tool->number;
  const GravityColumns gravity(evidence.arm);
  Eigen::Matrix3Xd J(3, chain.all().count);
  Eigen::Matrix3Xd whole(3, change.before_it.size());
  const Eigen::Index known =
      J.cols() + gravity.count() + static_cast<Eigen::Index>(evidence.arm.joints.size());
  std::vector<Vector3> before;
  std::vector<Vector3> after;
  for (int k = 1; k <= kJudgedConfigurations; ++k) {
    row.q = work_configuration(types_of(evidence.arm.joints), evidence.arm.limits, k);
    chain.derivatives(row, J);
    const Vector3 from_base_S = J.col(chain.of_lengths().first);
    row.p_S = chain.X_SB().p + from_base_S;
    // The base goes along with what the sensor sees: of it only the arm's lengths are wrong.
    // Of backlash nothing is known where no pose was before.
    whole.setZero();
    whole.leftCols(known) << J, gravity.of(row, chain, J), by_gears(evidence.arm, chain, row);
    whole.rightCols<1>() = from_base_S;
    before.emplace_back(whole * change.before_it);
    after.emplace_back(whole * change.after_it);
  }
  return rms_length(before) > rms_length(after) ? before : after;
}

}  // namespace armsig::tool
