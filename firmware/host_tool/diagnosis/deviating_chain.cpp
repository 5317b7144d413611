// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/deviating_chain.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/links.hpp"
#include "core/base/sine_cosine.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::tool {
namespace {

// The priors are a third of what is allowed; zeros may be far, and cost little.
constexpr double kPriorShare = 1.0 / 3;
// Beyond this the frame of a drawing row is not where the arm is: near-parallel axes.
constexpr double kFarFrame_m = 5;
constexpr double kTwistSigma_rad = radians(0.5);
constexpr double kSecondPlace_m = 2;  // how far a sensor is carried, 1 sigma
constexpr double kSecondPlace_rad = 1;
constexpr double kFactorSigma = 0.2;  // of the logarithm of a factor that is looked for
constexpr double kLeastReach_m = 1e-3;

Pose turned(const Vector3& rotation, const Vector3& shift) {
  return {numerics::rotation_by(rotation), shift};
}

JointVector middle_readings(const Evidence& evidence) {
  JointVector middle;
  middle.resize(evidence.arm.joints.size(), 0);
  for (const EvidenceRow& row : evidence.rows) {
    for (std::size_t j = 0; j < middle.size(); ++j) {
      middle[j] += row.q[j] / static_cast<double>(evidence.rows.size());
    }
  }
  return middle;
}

}  // namespace

Pose DeviatingChain::Link::drawn_part(double reading) const {
  const bool revolute = drawn.type == JointType::kRevolute;
  const double motion = reading + deviation[6];
  const auto [sine, cosine] = sine_and_cosine(drawn.theta_rad + (revolute ? motion : 0));
  Pose part;
  part.R.col(0) = Vector3(cosine, sine, 0);
  part.R.col(1) = Vector3(-sine * R_x(1, 1), cosine * R_x(1, 1), R_x(2, 1));
  part.R.col(2) = Vector3(-sine * R_x(1, 2), cosine * R_x(1, 2), R_x(2, 2));
  part.p = {cosine * drawn.a_m, sine * drawn.a_m, drawn.d_m + (revolute ? 0 : motion)};
  return part;
}

void DeviatingChain::Link::deviate() {
  const Pose local = turned(deviation.head<3>(), deviation.segment<3>(3));
  const Pose about{.R = local.R, .p = centre_L + local.p - local.R * centre_L};
  deviating = Pose{.R = rotation_x(deviation[7]), .p = Vector3::Zero()} * about;
}

DeviatingChain::DeviatingChain(const Evidence& evidence, const ArmLimits& limits)
    : couplings_(evidence.arm.couplings),
      targets_(seen_targets(evidence)),
      two_places_(std::ranges::any_of(evidence.rows, &EvidenceRow::moved)),
      free_scale_(evidence.free_scale),
      free_gain_(evidence.free_gain) {
  add_links(evidence.arm, middle_readings(evidence));
  double lengths_m = 0;
  for (const DhJoint& joint : evidence.arm.joints) {
    lengths_m +=
        std::abs(joint.a_m) + (std::abs(joint.d_m) < kFarFrame_m ? std::abs(joint.d_m) : 0);
  }
  reach_m_ = std::max({kLeastReach_m, reach_m_, lengths_m});
  set_priors(limits);
}

// `middle`: the readings at which the axes are looked at.
void DeviatingChain::add_links(const Arm& arm, const JointVector& middle) {
  const std::size_t n = arm.joints.size();
  const auto frames = dh_frames(arm.joints, effective_readings(arm, middle));
  Vector3 at_B = Vector3::Zero();
  for (std::size_t k = 1; k <= n; ++k) {
    Link link{.drawn = arm.joints[k - 1]};
    const Vector3 before_B = at_B;
    if (k < n) {  // z of frame k is the axis of joint k + 1
      const Vector3 z_B = frames[k].R.col(2);
      if (arm.joints[k].type == JointType::kRevolute) {
        at_B = frames[k].p + z_B * z_B.dot(at_B - frames[k].p);
      } else if (frames[k].p.norm() < kFarFrame_m) {
        at_B = frames[k].p;
      }
      link.next_is_revolute = arm.joints[k].type == JointType::kRevolute;
    }
    // Along its own axis a revolute joint is where the next axes put it: a chain of common normals.
    reach_m_ += (at_B - before_B).norm();
    link.centre_L = frames[k].inverse() * at_B;
    link.R_x = rotation_x(link.drawn.alpha_rad);
    links_.push_back(link);
  }
}

void DeviatingChain::set_priors(const ArmLimits& limits) {
  const double shift_m =
      kPriorShare * std::max(limits.least_shift_m, limits.shift_share * reach_m_);
  for (Link& link : links_) {
    link.inverse_sigma.head<3>().setConstant(1 / (kPriorShare * limits.tilt_rad));
    link.inverse_sigma.segment<3>(3).setConstant(1 / shift_m);
    const bool revolute = link.drawn.type == JointType::kRevolute;
    link.inverse_sigma[6] =
        1 / (kPriorShare * (revolute ? limits.zero_rad : limits.zero_share * reach_m_));
    const bool far = link.centre_L.norm() > kFarFrame_m && std::abs(link.drawn.d_m) > kFarFrame_m;
    link.inverse_sigma[7] = 1 / (far ? kTwistSigma_rad : 1e-9);
  }
}

void DeviatingChain::place(const Pose& X_SB, const std::vector<Vector3>& p_LT) {
  X_SB_ = X_SB;
  p_LT_ = p_LT;
}

std::size_t DeviatingChain::target_of(int number) const {
  return static_cast<std::size_t>(std::ranges::find(targets_, number, &SeenTarget::number) -
                                  targets_.begin());
}

JointVector DeviatingChain::effective(const JointVector& read) const {
  if (free_gain_ == 0) return effective_readings(couplings_, read);
  JointVector turned = read;
  for (std::size_t j = 0; j < turned.size(); ++j) {
    if ((free_gain_ >> j & 1) != 0) turned[j] *= std::exp(log_turn_);
  }
  return effective_readings(couplings_, turned);
}

JointVector DeviatingChain::turned_by_factor(const JointVector& read) const {
  JointVector turned = read;
  for (std::size_t j = 0; j < turned.size(); ++j) {
    turned[j] *= (free_gain_ >> j & 1) != 0 ? std::exp(log_turn_) : 0;
  }
  return effective_readings(couplings_, turned);
}

DeviatingChain::Placed DeviatingChain::placed(const JointVector& effective,
                                              std::size_t last) const {
  Placed placed;
  placed.full[0] = placed.drawn[0] = Pose{};
  for (std::size_t k = 1; k <= last; ++k) {
    placed.drawn[k] = placed.full[k - 1] * links_[k - 1].drawn_part(effective[k - 1]);
    placed.full[k] = k < last ? placed.drawn[k] * links_[k - 1].deviating : placed.drawn[k];
  }
  return placed;
}

std::vector<Vector3> DeviatingChain::residuals(const Evidence& evidence) const {
  std::vector<Vector3> residuals;
  residuals.reserve(evidence.rows.size());
  for (const EvidenceRow& row : evidence.rows) {
    const std::size_t target = target_of(row.target);
    const std::size_t last = targets_[target].link;
    const Placed at = placed(effective(row.q), last);
    Vector3 p_S = X_SB_ * (scale() * (at.drawn[last] * p_LT_[target]));
    if (row.moved) p_S = X_SM_ * p_S;
    residuals.emplace_back(row.p_S - p_S);
  }
  return residuals;
}

void DeviatingChain::Seen::turn_and_shift(const Matrix3& R_B, const Vector3& centre_B,
                                          Eigen::Index column, Eigen::Matrix3Xd& J) const {
  for (int i = 0; i < 3; ++i) {
    J.col(column + i) = R * R_B.col(i).cross(p_B - centre_B);
    J.col(column + 3 + i) = R * R_B.col(i);
  }
}

// Columns for base, second place, factors and every link: displacements of the point by unit
// rotations about centres and unit shifts, all in the sensor frame.
void DeviatingChain::derivatives(const EvidenceRow& row, std::size_t target,
                                 Eigen::Matrix3Xd& J) const {
  J.setZero();
  const std::size_t last = targets_[target].link;
  const Placed at = placed(effective(row.q), last);
  const Seen seen = seen_of(row, target, at);
  seen.turn_and_shift(Matrix3::Identity(), Vector3::Zero(), 0, J);
  J.middleCols<3>(3) = seen.R / scale();
  J.col(kScale) = seen.R * seen.p_B;
  if (row.moved) {
    const Vector3 p_S = X_SB_ * (scale() * seen.p_B);
    for (int i = 0; i < 3; ++i) {
      J.col(kPlace + i) = Vector3::Unit(i).cross(X_SM_.R * p_S);
      J.col(kPlace + 3 + i) = Vector3::Unit(i);
    }
  }
  link_derivatives(at, last, seen, J);
  if (free_gain_ != 0) J.col(kTurn) = turn_derivative(at, last, seen, turned_by_factor(row.q));
  J.middleCols<3>(target_column(target)) = seen.R * at.drawn[last].R;
}

DeviatingChain::Seen DeviatingChain::seen_of(const EvidenceRow& row, std::size_t target,
                                             const Placed& at) const {
  const Matrix3 R_seen = row.moved ? Matrix3(X_SM_.R * X_SB_.R) : X_SB_.R;
  return {.p_B = at.drawn[targets_[target].link] * p_LT_[target], .R = scale() * R_seen};
}

Vector3 DeviatingChain::motion(const Placed& at, std::size_t joint, const Seen& seen) const {
  const Pose& X_BJ = at.full[joint];
  const Vector3 z = X_BJ.R.col(2);
  const bool revolute = links_[joint].drawn.type == JointType::kRevolute;
  return seen.R * (revolute ? Vector3(z.cross(seen.p_B - X_BJ.p)) : z);
}

Eigen::Matrix3Xd DeviatingChain::motions(const EvidenceRow& row) const {
  const std::size_t target = target_of(row.target);
  const std::size_t last = targets_[target].link;
  const Placed at = placed(effective(row.q), last);
  const Seen seen = seen_of(row, target, at);
  Eigen::Matrix3Xd motions = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(links_.size()));
  for (std::size_t j = 0; j < last; ++j) {
    motions.col(static_cast<Eigen::Index>(j)) = motion(at, j, seen);
  }
  return motions;
}

void DeviatingChain::link_derivatives(const Placed& at, std::size_t last, const Seen& seen,
                                      Eigen::Matrix3Xd& J) const {
  for (std::size_t k = 1; k < last; ++k) {
    const Link& link = links_[k - 1];
    const Eigen::Index column = link_column(k - 1);
    const Pose& before = at.drawn[k];
    seen.turn_and_shift(before.R, before * (link.centre_L + Vector3(link.deviation.segment<3>(3))),
                        column, J);
    J.col(column + 6) = motion(at, k - 1, seen);
    if (twists(k - 1)) {
      J.col(column + 7) = seen.R * before.R.col(0).cross(seen.p_B - before.p);
    }
  }
}

// By the factor of what the joints turn, of which `turned` is what it acts on.
Vector3 DeviatingChain::turn_derivative(const Placed& at, std::size_t last, const Seen& seen,
                                        const JointVector& turned) const {
  Vector3 derivative = Vector3::Zero();
  for (std::size_t j = 0; j < last; ++j) {
    if (links_[j].drawn.type != JointType::kRevolute) continue;
    derivative += turned[j] * motion(at, j, seen);
  }
  return derivative;
}

// Unknowns that a row may speak of. The last link has no deviation of its own.
std::vector<Eigen::Index> DeviatingChain::spoken_of() const {
  std::vector<Eigen::Index> spoken;
  const auto add = [&](const Columns& columns) {
    for (Eigen::Index i = 0; i < columns.count; ++i) spoken.push_back(columns.first + i);
  };
  add(of_base());
  if (two_places_) add({kPlace, kSecond});
  if (free_scale_) add(of_lengths());
  if (free_gain_ != 0) add({kTurn, 1});
  for (std::size_t j = 0; j + 1 < links_.size(); ++j) {
    add(of_link(j));
    add(of_zero(j));
    if (twists(j)) add(of_twist(j));
  }
  for (std::size_t t = 0; t < targets_.size(); ++t) add(of_target(t));
  return spoken;
}

void DeviatingChain::sum_rows(const Evidence& evidence, const std::vector<Vector3>& residuals,
                              const std::vector<double>& weights, Normal& normal) const {
  const std::vector<Eigen::Index> spoken = spoken_of();
  const auto count = static_cast<Eigen::Index>(spoken.size());
  Eigen::Matrix3Xd J(3, normal.g.size());
  Eigen::MatrixXd batch(count, 3 * kRowsABatch);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd weighted(batch.cols());
  Eigen::Index filled = 0;
  const auto add_batch = [&] {
    H.selfadjointView<Eigen::Lower>().rankUpdate(batch.leftCols(filled));
    g.noalias() += batch.leftCols(filled) * weighted.head(filled);
    filled = 0;
  };
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    if (weights[k] <= 0) continue;
    derivatives(evidence.rows[k], J);
    const double weight = std::sqrt(weights[k]);
    batch.middleCols<3>(filled) = weight * J(Eigen::all, spoken).transpose();
    weighted.segment<3>(filled) = weight * residuals[k];
    filled += 3;
    if (filled == batch.cols()) add_batch();
  }
  if (filled > 0) add_batch();
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  normal.H(spoken, spoken) = H;
  normal.g(spoken) = g;
}

DeviatingChain::Normal DeviatingChain::normal(const Evidence& evidence,
                                              const std::vector<Vector3>& residuals,
                                              const std::vector<double>& weights) const {
  const Eigen::Index size = target_column(targets_.size());
  Normal normal{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  sum_rows(evidence, residuals, weights, normal);
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const Link& link = links_[k];
    const Eigen::Index column = link_column(k);
    for (Eigen::Index i = 0; i < kOfLink; ++i) {
      const double weight = link.inverse_sigma[i] * link.inverse_sigma[i];
      normal.H(column + i, column + i) += weight;
      normal.g[column + i] -= weight * link.deviation[i];
    }
  }
  const std::array<double, kFactors> factors{log_scale_, log_turn_};
  for (Eigen::Index i = 0; i < kFactors; ++i) {
    constexpr double kWeight = 1 / (kFactorSigma * kFactorSigma);
    normal.H(kScale + i, kScale + i) += kWeight;
    normal.g[kScale + i] -= kWeight * factors[static_cast<std::size_t>(i)];
  }
  for (Eigen::Index i = 0; i < 3; ++i) {  // holds what no row speaks of
    normal.H(kPlace + i, kPlace + i) += 1 / (kSecondPlace_rad * kSecondPlace_rad);
    normal.H(kPlace + 3 + i, kPlace + 3 + i) += 1 / (kSecondPlace_m * kSecondPlace_m);
  }
  return normal;
}

double DeviatingChain::prior_squares() const {
  double squares =
      (log_scale_ * log_scale_ + log_turn_ * log_turn_) / (kFactorSigma * kFactorSigma);
  for (const Link& link : links_) {
    squares += link.deviation.cwiseProduct(link.inverse_sigma).squaredNorm();
  }
  return squares;
}

void DeviatingChain::move(const Eigen::VectorXd& x) {
  X_SB_ = X_SB_ * turned(x.head<3>(), x.segment<3>(3));
  if (two_places_) {
    const Pose step = turned(x.segment<3>(kPlace), x.segment<3>(kPlace + 3));
    X_SM_ = {step.R * X_SM_.R, step.R * X_SM_.p + step.p};
  }
  log_scale_ += x[kScale];
  log_turn_ += x[kTurn];
  for (std::size_t k = 0; k < links_.size(); ++k) {
    links_[k].deviation += x.segment<kOfLink>(link_column(k));
    links_[k].deviate();
  }
  for (std::size_t t = 0; t < targets_.size(); ++t) p_LT_[t] += x.segment<3>(target_column(t));
}

std::vector<Deviation> DeviatingChain::deviations() const {
  std::vector<Deviation> deviations;
  double carried = 0;  // a turn of the link before about this joint's axis is a zero of it
  for (const Link& link : links_) {
    Deviation deviation;
    const Vector3 w = link.deviation.head<3>();
    deviation.zero = link.deviation[6] + carried;
    deviation.tilt_rad = std::hypot(w.x(), w.y());
    deviation.shift_m = link.deviation.segment<3>(3).norm();
    carried = link.next_is_revolute ? w.z() : 0;
    deviations.push_back(deviation);
  }
  return deviations;
}

}  // namespace armsig::tool
