// SPDX-License-Identifier: MIT
#include "firmware/host_tool/sweeps_alone/whole_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/frames/alignment.hpp"
#include "core/kinematics/s_model_chain.hpp"

namespace armsig::tool {
namespace {

using calibration::kDeviations;
using calibration::kKnots;

// Standard deviations of the priors: of the deviations those of the estimator (docs/refinement.md),
// of base and targets so wide that they say nothing about an estimate.
constexpr double kBaseTurn = 0.1;
constexpr double kPlace_m = 0.1;
constexpr std::array<double, kDeviations> kDeviationSigma{2e-3, 2e-3, 1e-3, 1e-3, 1e-2};
constexpr double kCorrectionSigma = 1e-3;  // of a reading, or per radian of a gear
constexpr double kExactGears = 2;          // gears are exact as a rule
constexpr Eigen::Index kBaseColumns = 6;

// Readings this near to each other, in knots of the engine's maps, are one.
constexpr double kSameReading = 0.5;
// Of a point's variance: so that a matrix of neighbours can be inverted.
constexpr double kNugget = 1e-6;

constexpr double kTurnOfKnots = 2 * kPi / static_cast<double>(kKnots);

// Matern 3/2, of length 15 degrees on one turn of the knots.
double correlation(double a, double b) {
  constexpr double kLength = radians(15);
  const double apart = std::abs(std::remainder(a - b, 2 * kPi)) * std::numbers::sqrt3 / kLength;
  return (1 + apart) * std::exp(-apart);
}

}  // namespace

WholeModel::WholeModel(const Arm& drawing, const calibration::Refined& estimate,
                       std::span<const EvidenceRow> rows, std::size_t tool)
    : estimate_(estimate), drawn_(calibration::model_of(drawing, {})), tool_(tool) {
  const Signature& signature = estimate.signature;
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    drawn_.joints[i].domain = calibration::map_domain(drawing.joints[i].type, drawing.limits[i]);
  }
  drawn_.couplings = drawing.couplings;
  calibration::choose_gravity_terms(drawing, drawn_);
  const Pose X_SB = frames::align(frames::axis_lines(signature),
                                  frames::axis_lines(drawing, signature.configuration))
                        .X_AB;
  down_S_ = -(X_SB.R * drawing.up_0);
  geometry_ = kBaseColumns + 3 * static_cast<Eigen::Index>(signature.targets.size()) +
              static_cast<Eigen::Index>(kDeviations * signature.joint_count());
  columns_ = geometry_;
  for (const calibration::Parameter& parameter : estimate.layout.parameters) {
    if (calibration::of_reading(parameter)) corrections_.push_back(parameter);
  }
  const std::size_t corrected = corrections_.size();
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const calibration::Parameter gear{.kind = calibration::ParameterKind::kReadingGain,
                                      .index = static_cast<std::uint8_t>(i)};
    if (estimate.layout.gain[i] == calibration::kNoColumn) corrections_.push_back(gear);
  }
  for (const std::size_t size : {corrected, corrections_.size() - corrected}) {
    const auto columns = static_cast<Eigen::Index>(size);
    add_block(Eigen::MatrixXd::Identity(columns, columns));
  }
  blocks_[kGears].zeros = kExactGears;
  const auto terms = static_cast<Eigen::Index>(drawn_.gravity.size());
  const auto of_tool = static_cast<Eigen::Index>(signature.joint_count());
  add_block(Eigen::MatrixXd::Identity(terms + of_tool, terms + of_tool));
  for (std::size_t i = 0; i < signature.joint_count(); ++i) add_knots(i, rows);
}

void WholeModel::add_block(Eigen::MatrixXd precision) {
  PriorBlock block{.first = columns_, .precision = std::move(precision)};
  columns_ += block.size();
  const Eigen::LLT<Eigen::MatrixXd> factor(block.precision);
  for (Eigen::Index k = 0; k < block.size(); ++k) {
    block.log_determinant += 2 * std::log(factor.matrixLLT()(k, k));
  }
  blocks_.push_back(std::move(block));
}

double WholeModel::phase(std::size_t joint, double reading) const {
  const calibration::MapDomain& domain = drawn_.joints[joint].domain;
  return (reading - domain.origin) * domain.per_length * kTurnOfKnots;
}

void WholeModel::add_knots(std::size_t joint, std::span<const EvidenceRow> rows) {
  std::vector<double> all;
  for (const EvidenceRow& row : rows) all.push_back(phase(joint, row.q[joint]));
  std::ranges::sort(all);
  Knots& knots = knots_[joint];
  for (const double value : all) {
    if (knots.phase.empty() || value - knots.phase.back() > kSameReading * kTurnOfKnots) {
      knots.phase.push_back(value);
    }
  }
  const auto size = static_cast<Eigen::Index>(knots.phase.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(size, size) * (1 + kNugget);
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      covariance(a, b) = covariance(b, a) = correlation(knots.phase[static_cast<std::size_t>(a)],
                                                        knots.phase[static_cast<std::size_t>(b)]);
    }
  }
  knots.precision = covariance.llt().solve(Eigen::MatrixXd::Identity(size, size));
  add_block(knots.precision);
}

WholeModel::At WholeModel::at(const JointVector& readings, std::size_t target) const {
  const Signature& signature = estimate_.signature;
  const JointVector turned =
      calibration::true_readings(estimate_.readings, signature.configuration, readings);
  At at{.columns = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, columns_)};
  at.p_S = kinematics::target_position(signature, turned, signature.targets[target]);
  const std::size_t link = signature.targets[target].link;
  for (int c = 0; c < 3; ++c) {
    const Vector3 unit = Vector3::Unit(c);
    at.columns.col(c) = kBaseTurn * unit.cross(at.p_S - signature.X_SL[0].p);
    at.columns.col(3 + c) = kPlace_m * unit;
  }
  at.columns.middleCols<3>(kBaseColumns + 3 * static_cast<Eigen::Index>(target)) =
      kPlace_m * kinematics::link_pose(signature, turned, link).R;
  Motions motion;
  motion.fill(Vector3::Zero());
  for (std::size_t i = 0; i < link; ++i) {
    motion[i] = add_deviations(i, kinematics::link_pose(signature, turned, i), at);
  }
  const calibration::Deflections now = calibration::deflections_at(estimate_.readings, readings);
  for (std::size_t i = 0; i < link; ++i) at.bent += now[i] * motion[i];
  add_readings(readings, motion, at);
  add_gravity(readings, motion, at);
  add_weight_of_tool(turned, motion, at);
  for (std::size_t i = 0; i < link; ++i) add_map(i, readings[i], motion[i], at);
  return at;
}

Vector3 WholeModel::add_deviations(std::size_t joint, const Pose& X_SJ, At& at) const {
  const bool revolute = estimate_.signature.types[joint] == JointType::kRevolute;
  const Vector3 arm = at.p_S - X_SJ.p;
  const Vector3 z = X_SJ.R.col(2);
  const Vector3 motion = revolute ? Vector3(z.cross(arm)) : z;
  const std::size_t after = estimate_.signature.joint_count() - joint;
  const auto own = geometry_ - static_cast<Eigen::Index>(kDeviations * after);
  for (int c = 0; c < 2; ++c) {
    const Vector3 axis = X_SJ.R.col(c);
    at.columns.col(own + c) = kDeviationSigma[0] * axis.cross(arm);
    at.columns.col(own + 2 + c) = kDeviationSigma[2] * axis;
  }
  at.columns.col(own + 4) = kDeviationSigma[4] * motion;
  return motion;
}

// Of the corrections, the axes hold what they are at the signature configuration.
void WholeModel::add_readings(const JointVector& readings, const Motions& motion, At& at) const {
  const Signature& signature = estimate_.signature;
  const JointVector effective = effective_readings(estimate_.readings.couplings, readings);
  Eigen::Index column = blocks_[kReadings].first;
  for (const calibration::Parameter& parameter : corrections_) {
    at.columns.col(column++) = kCorrectionSigma *
                               calibration::turn_by(parameter, effective[parameter.index]) *
                               motion[parameter.index];
  }
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const auto added = [&](double reading) {
      return calibration::corrected_reading(estimate_.readings, i, reading) - reading;
    };
    at.bent += (added(effective[i]) - added(signature.configuration[i])) * motion[i];
  }
}

void WholeModel::add_gravity(const JointVector& readings, const Motions& motion, At& at) const {
  calibration::GravityLevers levers;
  calibration::gravity_levers(drawn_, effective_readings(drawn_.couplings, readings), levers);
  for (std::size_t t = 0; t < drawn_.gravity.size(); ++t) {
    const std::size_t joint = drawn_.gravity[t].joint;
    at.columns.col(blocks_[kGravity].first + static_cast<Eigen::Index>(t)) =
        calibration::map_unit(estimate_.signature.types[joint]) * levers[t] * motion[joint];
  }
}

// The lever of a weight about an axis is how fast the joint lowers it.
void WholeModel::add_weight_of_tool(const JointVector& turned, const Motions& motion,
                                    At& at) const {
  const Signature& signature = estimate_.signature;
  const Vector3 tool_S = kinematics::target_position(signature, turned, signature.targets[tool_]);
  const auto first = blocks_[kGravity].first + static_cast<Eigen::Index>(drawn_.gravity.size());
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const Pose X_SJ = kinematics::link_pose(signature, turned, i);
    const Vector3 z = X_SJ.R.col(2);
    const bool revolute = signature.types[i] == JointType::kRevolute;
    const Vector3 moves = revolute ? Vector3(z.cross(tool_S - X_SJ.p)) : z;
    at.columns.col(first + static_cast<Eigen::Index>(i)) =
        calibration::map_unit(signature.types[i]) * down_S_.dot(moves) * motion[i];
  }
}

void WholeModel::add_map(std::size_t joint, double reading, const Vector3& motion, At& at) const {
  const Knots& knots = knots_[joint];
  const double here = phase(joint, reading);
  Eigen::VectorXd like(static_cast<Eigen::Index>(knots.phase.size()));
  for (Eigen::Index k = 0; k < like.size(); ++k) {
    like[k] = correlation(here, knots.phase[static_cast<std::size_t>(k)]);
  }
  const Eigen::VectorXd weight = knots.precision * like;
  const Vector3 moved = calibration::map_unit(estimate_.signature.types[joint]) * motion;
  at.columns.middleCols(blocks_[kMaps + joint].first, like.size()) = moved * weight.transpose();
  at.open[joint] = std::max(0.0, 1 - like.dot(weight)) * moved.squaredNorm();
}

}  // namespace armsig::tool
