// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace armsig::tool {
namespace {

// Beyond this part of the scale only rounding is left.
constexpr double kTold = 1e-9;
// Joints give way by so much under a weight one metre out, 1 sigma [rad, or m of a slide].
constexpr double kUsualSag = 0.01;
// A gear or a lead is off by such a share, 1 sigma. A sweep of a joint tells its gear from nothing
// else that it does: there an arm is taken to have the gears of its drawing.
constexpr double kUsualGear = 0.01;
constexpr double kGearInSweeps = 1e-6;
// Half of a joint's backlash, 1 sigma.
constexpr double kUsualBacklash_rad = 1e-3;
constexpr double kUsualBacklash_m = 0.05e-3;

}  // namespace

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal, const Eigen::VectorXd& scale) {
  const Eigen::VectorXd unit =
      scale.unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> in(unit.asDiagonal() * normal *
                                                          unit.asDiagonal());
  const Eigen::VectorXd inverse =
      in.eigenvalues().unaryExpr([](double x) { return x > kTold ? 1 / x : 0.0; });
  return unit.asDiagonal() * in.eigenvectors() * inverse.asDiagonal() *
         in.eigenvectors().transpose() * unit.asDiagonal();
}

Eigen::Matrix3Xd by_gears(const Arm& arm, const DeviatingChain& chain, const EvidenceRow& row) {
  Eigen::Matrix3Xd columns = chain.motions(row);
  const JointVector turned = effective_readings(arm, row.q);
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    columns.col(j) *= turned[static_cast<std::size_t>(j)];
  }
  return columns;
}

UnchangingArm::UnchangingArm(const Evidence& evidence, const DeviatingChain& chain,
                             const std::vector<Vector3>& residuals_S, Backlash backlash)
    : evidence_(evidence),
      chain_(chain),
      residuals_(residuals_S),
      gravity_(evidence.arm),
      has_backlash_(backlash == Backlash::kPossible &&
                    std::ranges::none_of(evidence.rows,
                                         [](const EvidenceRow& row) { return row.sweep == 0; })) {
  weigh();
  choose_unknowns();
  differentiate();
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(size_, size_);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(size_);
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    squares.noalias() += weights_[k] * (derivatives_[k].transpose() * derivatives_[k]);
    score.noalias() += weights_[k] * (derivatives_[k].transpose() * residuals_S[k]);
    squares_ += weights_[k] * residuals_S[k].squaredNorm();
  }
  pull_ = score;
  invert(squares);
  step_ = inverse_ * score;
  squares_ -= score.dot(step_);
}

void UnchangingArm::weigh() {
  std::vector<double> lengths;
  for (const Vector3& residual : residuals_) lengths.push_back(residual.norm());
  const double sigma_m = std::max(kLeastSigma_m, sigma_by_median(lengths));
  for (const double length : lengths) {
    weights_.push_back(huber_weight(length, sigma_m));
    weight_ += weights_.back();
  }
}

// Without the sensor's second place, the factor of the readings and the last link, which no row
// knows.
void UnchangingArm::choose_unknowns() {
  const auto add = [&](const DeviatingChain::Columns& columns) {
    for (Eigen::Index i = 0; i < columns.count; ++i) of_chain_.push_back(columns.first + i);
  };
  add(chain_.of_base());
  add(chain_.of_lengths());
  for (std::size_t j = 0; j + 1 < evidence_.arm.joints.size(); ++j) {
    add(chain_.of_link(j));
    add(chain_.of_zero(j));
    if (chain_.twists(j)) add(chain_.of_twist(j));
  }
  add(chain_.of_zero(evidence_.arm.joints.size() - 1));
  for (std::size_t t = 0; t < chain_.targets().size(); ++t) add(chain_.of_target(t));
  stiff_ = static_cast<Eigen::Index>(of_chain_.size());
  size_ = first_backlash() + backlashes() + 1;
}

void UnchangingArm::differentiate() {
  Eigen::Matrix3Xd J(3, chain_.all().count);
  for (const EvidenceRow& row : evidence_.rows) {
    chain_.derivatives(row, J);
    derivatives_.emplace_back(3, size_);
    derivatives_.back() << J(Eigen::all, of_chain_), gravity_.of(row, chain_, J),
        by_gears(evidence_.arm, chain_, row), by_backlash(row), row.p_S;
  }
}

// Joints turn back between two sweeps, and backlash is a step there. From which side a joint came
// before its first move nobody knows. Of free poses the refinement finds it.
Eigen::Matrix3Xd UnchangingArm::by_backlash(const EvidenceRow& row) const {
  Eigen::Matrix3Xd columns = Eigen::Matrix3Xd::Zero(3, backlashes());
  if (columns.cols() == 0) return columns;
  const Eigen::Matrix3Xd motions = chain_.motions(row);
  for (Eigen::Index j = 0; j < gears(); ++j) {
    const bool known = (row.sided >> j & 1) != 0;
    const bool up = (row.sides >> j & 1) != 0;
    columns.col(known ? j : gears() + j) = (known && up ? -1 : 1) * motions.col(j);
  }
  return columns;
}

DeviatingChain::Columns UnchangingArm::place_of(const DeviatingChain::Columns& of_chain) const {
  const Eigen::Index beyond = of_chain.first - chain_.all().count;
  if (beyond >= 0) return {stiff_ + beyond, of_chain.count};
  return {std::ranges::lower_bound(of_chain_, of_chain.first) - of_chain_.begin(), of_chain.count};
}

Eigen::VectorXd UnchangingArm::gear_weights() const {
  const bool swept =
      std::ranges::any_of(evidence_.rows, [](const EvidenceRow& row) { return row.sweep != 0; });
  Eigen::VectorXd weights(gears());
  for (Eigen::Index j = 0; j < weights.size(); ++j) {
    const JointType type = evidence_.arm.joints[static_cast<std::size_t>(j)].type;
    const double sigma = swept && type == JointType::kRevolute ? kGearInSweeps : kUsualGear;
    weights[j] = 1 / (sigma * sigma);
  }
  return weights;
}

Eigen::VectorXd UnchangingArm::backlash_weights() const {
  Eigen::VectorXd weights(backlashes());
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    const JointType type = evidence_.arm.joints[static_cast<std::size_t>(k % gears())].type;
    const double sigma = type == JointType::kRevolute ? kUsualBacklash_rad : kUsualBacklash_m;
    weights[k] = 1 / (sigma * sigma);
  }
  return weights;
}

// `squares`: of the derivatives. Neither the lengths nor the sensor's are unknowns of an unchanging
// arm.
void UnchangingArm::invert(const Eigen::MatrixXd& squares) {
  constexpr double kWeight = 1 / (kUsualSag * kUsualSag);
  const Eigen::Index lengths = place_of(chain_.of_lengths()).first;
  const Eigen::Index sight = size_ - 1;
  const DeviatingChain::Normal normal = chain_.normal(evidence_, residuals_, weights_);
  pull_.head(stiff_) = normal.g(of_chain_);
  Eigen::MatrixXd H = squares;
  H.topLeftCorner(stiff_, stiff_) = normal.H(of_chain_, of_chain_);
  H.bottomRows(size_ - stiff_).col(lengths).setZero();
  H.row(lengths).tail(size_ - stiff_).setZero();
  H.col(sight).setZero();
  H.row(sight).setZero();
  H.diagonal().segment(stiff_, gravity_.count()).array() += kWeight;
  H.diagonal().segment(first_gear(), gears()) += gear_weights();
  H.diagonal().segment(first_backlash(), backlashes()) += backlash_weights();
  stiff_inverse_ = inverse_of(H.topLeftCorner(stiff_, stiff_), H.diagonal().head(stiff_));
  inverse_ = inverse_of(H, H.diagonal());
  for (Eigen::MatrixXd* inverse : {&stiff_inverse_, &inverse_}) {
    inverse->row(lengths).setZero();
    inverse->col(lengths).setZero();
  }
  inverse_.row(sight).setZero();
  inverse_.col(sight).setZero();
}

std::vector<Vector3> UnchangingArm::bent_S() const {
  const Eigen::VectorXd unknowns = inverse_ * pull_;
  std::vector<Vector3> bent_S;
  for (const Eigen::Matrix3Xd& J : derivatives_) {
    const auto by = [&](Eigen::Index first, Eigen::Index count) -> Vector3 {
      return J.middleCols(first, count) * unknowns.segment(first, count);
    };
    bent_S.emplace_back(by(stiff_, gravity_.count()) + by(first_backlash(), backlashes()));
  }
  return bent_S;
}

std::vector<Vector3> UnchangingArm::by_leads_S() const {
  const Eigen::VectorXd unknowns = inverse_ * pull_;
  std::vector<Vector3> moved_S(derivatives_.size(), Vector3::Zero());
  for (std::size_t j = 0; j < evidence_.arm.joints.size(); ++j) {
    if (evidence_.arm.joints[j].type != JointType::kPrismatic) continue;
    const Eigen::Index lead = first_gear() + static_cast<Eigen::Index>(j);
    for (std::size_t k = 0; k < moved_S.size(); ++k) {
      moved_S[k] += derivatives_[k].col(lead) * unknowns[lead];
    }
  }
  return moved_S;
}

std::vector<Vector3> UnchangingArm::left_S() const {
  std::vector<Vector3> left_S;
  for (std::size_t k = 0; k < derivatives_.size(); ++k) {
    left_S.emplace_back(residuals_[k] - derivatives_[k] * step_);
  }
  return left_S;
}

Eigen::VectorXd UnchangingArm::without_gravity(const Eigen::VectorXd& score) const {
  Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(chain_.all().count);
  unknowns(of_chain_) = stiff_inverse_ * score.head(stiff_);
  return unknowns;
}

}  // namespace armsig::tool
