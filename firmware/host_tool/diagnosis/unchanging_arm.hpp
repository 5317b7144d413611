// SPDX-License-Identifier: MIT
// What an arm that stays as it is can do about the residuals of its rows: it deviates from its
// drawing, its gears and leads are not quite those of the drawing, its joints have backlash, and
// gravity bends it, which a drive from one end of a joint to the other shows as if something crept.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "firmware/host_tool/diagnosis/deviating_chain.hpp"
#include "firmware/host_tool/diagnosis/gravity_columns.hpp"

namespace armsig::tool {

// The inverse of a matrix of normal equations; what the rows do not tell is left as it is. `scale`:
// what the diagonal would be if the rows told everything.
[[nodiscard]] Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& normal,
                                         const Eigen::VectorXd& scale);

// What each joint moves a row's point by, for a unit share of what it turns: a column a joint.
[[nodiscard]] Eigen::Matrix3Xd by_gears(const Arm& arm, const DeviatingChain& chain,
                                        const EvidenceRow& row);

// Whether its joints may have backlash, which sweeps alone show as a step between two of them.
enum class Backlash : std::uint8_t { kNone, kPossible };

class UnchangingArm {
 public:
  // All are kept as references.
  UnchangingArm(const Evidence& evidence, const DeviatingChain& chain,
                const std::vector<Vector3>& residuals_S, Backlash backlash = Backlash::kPossible);

  // Unknowns: those of the chain that may change or move any row, then gravity's, then of every
  // joint by which share it turns farther than it reads, where backlash is possible half of it and
  // the same before the joint's first move, and by which share the sensor sees all too far from its
  // origin. An unchanging arm does nothing by the last, nor by its lengths.
  [[nodiscard]] Eigen::Index size() const { return size_; }
  // What is not the chain's, as if it were in its derivatives, behind all others.
  [[nodiscard]] DeviatingChain::Columns of_load() const {
    const auto [first, count] = gravity_.of_tool();
    return {chain_.all().count + first, count};
  }
  [[nodiscard]] DeviatingChain::Columns of_gear(std::size_t joint) const {
    return {chain_.all().count + gravity_.count() + static_cast<Eigen::Index>(joint), 1};
  }
  [[nodiscard]] DeviatingChain::Columns of_sight() const {
    return {chain_.all().count + beyond_chain() - 1, 1};
  }
  [[nodiscard]] Eigen::Index beyond_chain() const { return size_ - stiff_; }
  [[nodiscard]] DeviatingChain::Columns place_of(const DeviatingChain::Columns& of_chain) const;

  [[nodiscard]] std::size_t rows() const { return weights_.size(); }
  [[nodiscard]] const Eigen::Matrix3Xd& derivatives(std::size_t row) const {
    return derivatives_[row];
  }
  [[nodiscard]] double weight(std::size_t row) const { return weights_[row]; }
  [[nodiscard]] double weight() const { return weight_; }  // of all rows

  [[nodiscard]] const Eigen::MatrixXd& inverse() const { return inverse_; }
  // What the arm would still do about the residuals, and their weighted squares after that.
  [[nodiscard]] const Eigen::VectorXd& step() const { return step_; }
  [[nodiscard]] double squares() const { return squares_; }
  [[nodiscard]] double missed_m() const { return std::sqrt(squares_ / weight_); }

  // What gravity and backlash move each row's point by, as the rows tell it beside an arm near its
  // drawing; and what the leads of prismatic joints do.
  [[nodiscard]] std::vector<Vector3> bent_S() const;
  [[nodiscard]] std::vector<Vector3> by_leads_S() const;

  // The residuals that such an arm leaves.
  [[nodiscard]] std::vector<Vector3> left_S() const;

  // All unknowns of the chain after a score, of a fit that knows nothing of gravity.
  [[nodiscard]] Eigen::VectorXd without_gravity(const Eigen::VectorXd& score) const;

 private:
  [[nodiscard]] Eigen::Index gears() const {
    return static_cast<Eigen::Index>(evidence_.arm.joints.size());
  }
  [[nodiscard]] Eigen::Index first_gear() const { return stiff_ + gravity_.count(); }
  [[nodiscard]] Eigen::Index first_backlash() const { return first_gear() + gears(); }
  [[nodiscard]] Eigen::Index backlashes() const { return has_backlash_ ? 2 * gears() : 0; }
  [[nodiscard]] Eigen::Matrix3Xd by_backlash(const EvidenceRow& row) const;
  [[nodiscard]] Eigen::VectorXd gear_weights() const;
  [[nodiscard]] Eigen::VectorXd backlash_weights() const;
  void weigh();
  void choose_unknowns();
  void differentiate();
  void invert(const Eigen::MatrixXd& squares);

  const Evidence& evidence_;
  const DeviatingChain& chain_;
  const std::vector<Vector3>& residuals_;
  GravityColumns gravity_;
  bool has_backlash_;
  std::vector<Eigen::Index> of_chain_;  // the chain's unknowns among these
  Eigen::Index stiff_ = 0;              // their number
  Eigen::Index size_ = 0;
  std::vector<double> weights_;
  double weight_ = 0;
  std::vector<Eigen::Matrix3Xd> derivatives_;
  Eigen::VectorXd pull_;  // of the rows and of the drawing
  Eigen::MatrixXd inverse_;
  Eigen::MatrixXd stiff_inverse_;
  Eigen::VectorXd step_;
  double squares_ = 0;
};

}  // namespace armsig::tool
