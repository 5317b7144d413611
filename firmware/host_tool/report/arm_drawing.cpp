// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/arm_drawing.hpp"

#include <cmath>

#include "core/base/low_discrepancy.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/analysis/evaluation/tool_error.hpp"
#include "firmware/library/estimate.hpp"
#include "firmware/library/joint_frames.hpp"

namespace armsig::tool {
namespace {

constexpr double kAxisStub_m = 0.1;
constexpr int kStations = 6;        // configurations that the path leads through
constexpr int kFramesBetween = 12;  // from one to the next
// Share of the way from the signature configuration to an evenly spread one: wild poses tell less.
constexpr double kReach = 0.7;

// Points fixed to their links, as they are at the signature configuration.
std::vector<Target> skeleton(const SignatureRecord& record, const Pose& X_SB,
                             const FixedVector<Pose, kMaxJoints>& X_SK,
                             const std::optional<std::size_t>& tool) {
  std::vector<Target> points{{.number = 0, .link = 0, .p_S = X_SB.p}};
  for (std::size_t i = 0; i < X_SK.size(); ++i) {
    const Vector3 along_x(record.nominal.joints[i].a_m, 0, 0);
    for (const Vector3& p_K : {Vector3(0, 0, 0), Vector3(0, 0, kAxisStub_m), along_x}) {
      points.push_back({.number = 0, .link = i + 1, .p_S = X_SK[i] * p_K});
    }
  }
  if (tool) points.push_back(record.signature.targets[*tool]);
  return points;
}

BentLine line_at(const Signature& signature, const JointVector& q,
                 const std::vector<Target>& points) {
  BentLine line;
  for (const Target& point : points) {
    line.push_back(kinematics::target_position(signature, q, point));
  }
  return line;
}

// From station to station and back to the signature configuration, slow at each.
std::vector<JointVector> path(const SignatureRecord& record) {
  const JointVector& start = record.signature.configuration;
  std::vector<JointVector> stations{start};
  for (int n = 1; n < kStations; ++n) {
    JointVector station =
        evenly_spread_configuration(record.signature.types, record.nominal.limits, n);
    for (std::size_t i = 0; i < station.size(); ++i) {
      station[i] = start[i] + kReach * (station[i] - start[i]);
    }
    stations.push_back(station);
  }
  stations.push_back(start);
  std::vector<JointVector> poses;
  for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
    for (int step = 0; step < kFramesBetween; ++step) {
      const double share = 0.5 - 0.5 * std::cos(kPi * step / kFramesBetween);
      JointVector q = stations[k];
      for (std::size_t i = 0; i < q.size(); ++i) q[i] += share * (stations[k + 1][i] - q[i]);
      poses.push_back(q);
    }
  }
  return poses;
}

}  // namespace

ArmDrawing arm_drawing(const SignatureRecord& record) {
  const JointFrames frames = joint_frames(record);
  const Signature drawn = evaluation::drawing_as_model(record.nominal, record.signature);
  const auto tool = tool_target(record.signature);
  const auto actual = skeleton(record, frames.X_SB, frames.X_SK, tool);
  const auto nominal = skeleton(record, frames.X_SB, frames.X_SN, tool);
  ArmDrawing drawing{.has_tool = tool.has_value(), .poses = path(record), .frames = {}};
  for (const JointVector& q : drawing.poses) {
    drawing.frames.push_back({line_at(drawn, q, nominal), line_at(record.signature, q, actual)});
  }
  return drawing;
}

}  // namespace armsig::tool
