// SPDX-License-Identifier: MIT
// An arm that differs from its drawing a little at every joint, and how its targets then move.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "firmware/formats/arm_limits.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

// How the axis beyond a joint lies against the drawing, in the link of that joint.
struct Deviation {
  double tilt_rad = 0;
  double shift_m = 0;
  double zero = 0;  // of the joint's reading: radians or metres
};

// Unknowns: base (6), the sensor's second place (6), the factors of lengths and of readings (2),
// per joint but the last rotation, shift and zero (7) and, where the drawing's frame is metres
// away, the twist there (1), targets (3 each).
class DeviatingChain {
 public:
  DeviatingChain(const Evidence& evidence, const ArmLimits& limits);

  void place(const Pose& X_SB, const std::vector<Vector3>& p_LT);
  void move(const Eigen::VectorXd& x);

  [[nodiscard]] std::vector<Vector3> residuals(const Evidence& evidence) const;

  struct Normal {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
  };
  // Of the weighted squares of the residuals and the priors.
  [[nodiscard]] Normal normal(const Evidence& evidence, const std::vector<Vector3>& residuals,
                              const std::vector<double>& weights) const;
  [[nodiscard]] double prior_squares() const;

  // The unknowns by their places in a row's derivatives: of the point seen, in the sensor frame.
  struct Columns {
    Eigen::Index first = 0;
    Eigen::Index count = 0;
  };
  [[nodiscard]] Columns all() const { return {0, target_column(targets_.size())}; }
  [[nodiscard]] Columns of_base() const { return {0, kPlace}; }
  [[nodiscard]] Columns of_lengths() const { return {kScale, 1}; }
  [[nodiscard]] Columns of_link(std::size_t joint) const { return {link_column(joint), 6}; }
  [[nodiscard]] Columns of_zero(std::size_t joint) const { return {link_column(joint) + 6, 1}; }
  // Where the drawing's frame is metres away.
  [[nodiscard]] bool twists(std::size_t joint) const {
    return links_[joint].inverse_sigma[7] < 1e8;
  }
  [[nodiscard]] Columns of_twist(std::size_t joint) const { return {link_column(joint) + 7, 1}; }
  [[nodiscard]] Columns of_target(std::size_t target) const { return {target_column(target), 3}; }
  [[nodiscard]] const std::vector<SeenTarget>& targets() const { return targets_; }
  void derivatives(const EvidenceRow& row, Eigen::Matrix3Xd& J) const {
    derivatives(row, target_of(row.target), J);
  }
  // The same by what each joint turns or slides: a column a joint, zero beyond the target's link.
  [[nodiscard]] Eigen::Matrix3Xd motions(const EvidenceRow& row) const;

  [[nodiscard]] std::vector<Deviation> deviations() const;
  [[nodiscard]] double reach_m() const { return reach_m_; }
  [[nodiscard]] double scale() const { return std::exp(log_scale_); }
  [[nodiscard]] double gain() const { return 1 / std::exp(log_turn_); }
  [[nodiscard]] const Pose& X_SB() const { return X_SB_; }
  [[nodiscard]] const Pose& X_SM() const { return X_SM_; }

 private:
  static constexpr Eigen::Index kPlace = 6;
  static constexpr Eigen::Index kSecond = 6;
  static constexpr Eigen::Index kFactors = 2;
  static constexpr Eigen::Index kOfLink = 8;
  static constexpr Eigen::Index kScale = kPlace + kSecond;
  static constexpr Eigen::Index kTurn = kScale + 1;
  static constexpr Eigen::Index kFixed = kScale + kFactors;

  struct Link {
    DhJoint drawn;
    Vector3 centre_L = Vector3::Zero();  // about which it deviates, in its own frame
    bool next_is_revolute = false;
    Eigen::Matrix<double, kOfLink, 1> deviation = Eigen::Matrix<double, kOfLink, 1>::Zero();
    Eigen::Matrix<double, kOfLink, 1> inverse_sigma = Eigen::Matrix<double, kOfLink, 1>::Zero();

    // What no reading changes.
    Matrix3 R_x = Matrix3::Identity();  // of the drawn twist
    Pose deviating{};

    [[nodiscard]] Pose drawn_part(double reading) const;
    void deviate();  // sets `deviating` by the deviation
  };
  struct Placed {
    std::array<Pose, kMaxFrames> drawn;  // X_B of each link before its own deviation
    std::array<Pose, kMaxFrames> full;   // after it
  };

  // A point, and how the sensor sees displacements of it in the base: turned and scaled by R.
  struct Seen {
    Vector3 p_B;
    Matrix3 R;

    // Of unit turns about the axes of R_B through `centre_B`, then of unit shifts along them.
    void turn_and_shift(const Matrix3& R_B, const Vector3& centre_B, Eigen::Index column,
                        Eigen::Matrix3Xd& J) const;
  };

  void add_links(const Arm& arm, const JointVector& middle);
  void set_priors(const ArmLimits& limits);
  [[nodiscard]] static Eigen::Index link_column(std::size_t joint) {
    return kFixed + kOfLink * static_cast<Eigen::Index>(joint);
  }
  [[nodiscard]] Eigen::Index target_column(std::size_t target) const {
    return link_column(links_.size()) + 3 * static_cast<Eigen::Index>(target);
  }
  [[nodiscard]] std::size_t target_of(int number) const;
  [[nodiscard]] std::vector<Eigen::Index> spoken_of() const;
  [[nodiscard]] Placed placed(const JointVector& effective, std::size_t last) const;
  void sum_rows(const Evidence& evidence, const std::vector<Vector3>& residuals,
                const std::vector<double>& weights, Normal& normal) const;
  void derivatives(const EvidenceRow& row, std::size_t target, Eigen::Matrix3Xd& J) const;
  void link_derivatives(const Placed& at, std::size_t last, const Seen& seen,
                        Eigen::Matrix3Xd& J) const;
  [[nodiscard]] Seen seen_of(const EvidenceRow& row, std::size_t target, const Placed& at) const;
  [[nodiscard]] Vector3 motion(const Placed& at, std::size_t joint, const Seen& seen) const;
  [[nodiscard]] Vector3 turn_derivative(const Placed& at, std::size_t last, const Seen& seen,
                                        const JointVector& turned) const;
  // How far the joints turn for what was read, couplings applied; and of it what the factor acts
  // on.
  [[nodiscard]] JointVector effective(const JointVector& read) const;
  [[nodiscard]] JointVector turned_by_factor(const JointVector& read) const;

  JointCouplings couplings_;
  std::vector<Link> links_;
  std::vector<SeenTarget> targets_;
  std::vector<Vector3> p_LT_;
  Pose X_SB_;
  Pose X_SM_;
  double reach_m_ = 0;
  bool two_places_ = false;
  bool free_scale_ = false;
  std::uint32_t free_gain_ = 0;
  double log_scale_ = 0;  // of the lengths seen
  double log_turn_ = 0;   // of what the joints turn against what was read
};

}  // namespace armsig::tool
