// SPDX-License-Identifier: MIT
// All that may move a target of an arm, linearised about an estimate of it: base, targets, five
// deviations a joint, those corrections of the readings that the estimate has, gravity, and the map
// of every joint's reading as a Gaussian process at the readings that were measured (docs/model.md,
// section 7; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, section 2.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/model.hpp"
#include "core/calibration/refined.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

// Columns whose prior has one scale: N(0, (precision / scale)^-1).
struct PriorBlock {
  Eigen::Index first = 0;
  Eigen::MatrixXd precision;
  double log_determinant = 0;  // of the precision
  double zeros = 0;            // so many columns more, known to be zero, count for the scale

  [[nodiscard]] Eigen::Index size() const { return precision.rows(); }
};

class WholeModel {
 public:
  // `rows` are those whose readings the maps are told at, `tool` the target that has the tool's
  // weight. The estimate is kept as a reference.
  WholeModel(const Arm& drawing, const calibration::Refined& estimate,
             std::span<const EvidenceRow> rows, std::size_t tool);

  // What moves the target at readings `readings`.
  struct At {
    Eigen::Matrix<double, 3, Eigen::Dynamic> columns;
    Vector3 p_S = Vector3::Zero();          // where the estimate has it
    Vector3 bent = Vector3::Zero();         // what its own gravity, maps, corrections are of that
    std::array<double, kMaxJoints> open{};  // variance left in each map, of unit scale [m^2]
  };
  [[nodiscard]] At at(const JointVector& readings, std::size_t target) const;

  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  // Base, targets, deviations: the first columns.
  [[nodiscard]] Eigen::Index geometry_columns() const { return geometry_; }
  // Corrections of the readings that the estimate has (kReadings); a gear of every joint for which
  // it has none (kGears); gravity, and the tool's weight (kGravity); from kMaps on the map of every
  // joint.
  enum Block : std::uint8_t { kReadings, kGears, kGravity, kMaps };
  [[nodiscard]] const std::vector<PriorBlock>& blocks() const { return blocks_; }
  // Those before block `block`, which may be one beyond the last.
  [[nodiscard]] Eigen::Index columns_before(std::size_t block) const {
    return block < blocks_.size() ? blocks_[block].first : columns_;
  }

 private:
  // How the target moves with each joint.
  using Motions = std::array<Vector3, kMaxJoints>;
  // The readings of one joint at which its map is told, with K^-1.
  struct Knots {
    std::vector<double> phase;  // on one turn of the map
    Eigen::MatrixXd precision;
  };

  void add_block(Eigen::MatrixXd precision);
  void add_knots(std::size_t joint, std::span<const EvidenceRow> rows);
  [[nodiscard]] double phase(std::size_t joint, double reading) const;
  // Returns how the target moves with the joint.
  [[nodiscard]] Vector3 add_deviations(std::size_t joint, const Pose& X_SJ, At& at) const;
  void add_readings(const JointVector& readings, const Motions& motion, At& at) const;
  void add_gravity(const JointVector& readings, const Motions& motion, At& at) const;
  void add_weight_of_tool(const JointVector& turned, const Motions& motion, At& at) const;
  void add_map(std::size_t joint, double reading, const Vector3& motion, At& at) const;

  const calibration::Refined& estimate_;
  std::vector<calibration::Parameter> corrections_;  // of the readings: of the estimate, then gears
  calibration::ArmModel drawn_;
  std::size_t tool_;
  Vector3 down_S_ = Vector3::Zero();
  std::array<Knots, kMaxJoints> knots_;
  std::vector<PriorBlock> blocks_;
  Eigen::Index geometry_ = 0;
  Eigen::Index columns_ = 0;
};

}  // namespace armsig::tool
