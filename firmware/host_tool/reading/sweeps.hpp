// SPDX-License-Identifier: MIT
// From measured rows, in any order, to what the pipeline of core starts from: one feature per
// joint, the signature configuration, the target points. Memory does not grow with the number of
// rows.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/arm.hpp"
#include "core/features/sweep_estimator.hpp"
#include "core/signature.hpp"
#include "firmware/analysis/evaluation/fusion.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// One located target of one row.
struct LocatedRow {
  std::size_t line = 0;   // in the file, for messages
  std::size_t sweep = 0;  // joint number from 1; 0 for a pose in which any joint may have moved
  int target = 0;
  JointVector q;
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();  // zero when the file states no sigma
};

// What identification starts from.
struct SweptArm {
  FixedVector<features::JointFeature, kMaxJoints> features;
  JointVector configuration;
  FixedVector<Target, kMaxTargets> targets;
};

class SweepSet {
 public:
  // Features by `method`.
  SweepSet(const Arm& nominal, std::string file, features::Method method, bool start_alone = false);

  // Takes one row. A problem names the line: another joint moved, sweeps disagree about the
  // signature configuration.
  [[nodiscard]] std::optional<Problem> add(const LocatedRow& row);
  // The features, or why a sweep gives none.
  [[nodiscard]] Read<SweptArm> finish() const;
  // Targets that may not be on the link that they are taken to be on, in words.
  [[nodiscard]] std::vector<std::string> doubtful_targets() const;
  // Rows with sweep 0, which the features do not use.
  [[nodiscard]] std::size_t mixed_rows() const { return mixed_rows_; }

 private:
  struct Held {
    double reading = 0;  // of the first row
    std::size_t line = 0;
  };
  struct Sweep {
    FixedVector<Held, kMaxJoints> held;  // the swept joint's own entry is its first reading
    // The innermost joint whose reading is coupled to the swept one's, from 0.
    std::optional<std::size_t> carried;
    std::map<int, features::SweepEstimator> targets;
  };

  // By how much a joint that is held may wander.
  [[nodiscard]] double held_tolerance(JointType type) const;
  [[nodiscard]] Problem at(std::size_t line, std::string what, std::string expected) const;
  [[nodiscard]] std::string reading(std::size_t joint, double value) const;
  // Whether sweep `swept` holds every joint beyond at the reading that `configuration` has.
  [[nodiscard]] bool holds(std::size_t swept, const JointVector& configuration) const;
  [[nodiscard]] bool hangs_on(std::size_t joint, std::size_t from) const;
  // A sweep whose target is on a link beyond a joint that it carries along: no circle.
  [[nodiscard]] Read<void> check_carried() const;
  [[nodiscard]] Read<JointVector> configuration() const;
  [[nodiscard]] Read<features::JointFeature> joint_feature(std::size_t joint) const;
  [[nodiscard]] FixedVector<Target, kMaxTargets> targets(const JointVector& configuration) const;

  Arm nominal_;
  std::string file_;
  features::Method method_;
  double share_ = 1;                     // of what held joints may wander by
  std::map<std::size_t, Sweep> sweeps_;  // by joint, from 0
  std::set<int> mixed_targets_;          // seen in rows with sweep 0: on the last link
  std::size_t mixed_rows_ = 0;
};

}  // namespace armsig::tool
