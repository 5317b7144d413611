// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/reading_maps.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/joint_range.hpp"
#include "core/calibration/chain.hpp"
#include "firmware/analysis/evaluation/geometry_alone.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

using calibration::ArmModel;

constexpr int kConfigurations = 200;
constexpr int kPoints = 240;  // of a curve
// Of the readings measured: how far a curve goes on beyond them, on either side.
constexpr double kBeside = 0.08;

// The tool, or the last link's origin.
Target tool_of(const Signature& signature) {
  if (const auto index = tool_target(signature)) return signature.targets[*index];
  Target tool;
  tool.link = signature.joint_count();
  tool.p_S = signature.X_SL.back().p;
  return tool;
}

JointLimits covered_by(const SignatureRecord& record, std::size_t joint) {
  const JointLimits& covered = record.deflections->joints[joint].covered;
  return covered.lower < covered.upper ? covered : finite_range(record.nominal.limits[joint]);
}

ReadingMapPicture curve_of(const SignatureRecord& record, std::size_t joint) {
  const calibration::JointModel& model = record.deflections->joints[joint];
  ReadingMapPicture picture;
  picture.joint = joint;
  picture.type = model.type;
  picture.covered = covered_by(record, joint);
  const JointLimits limits = finite_range(record.nominal.limits[joint]);
  const double beside = kBeside * (picture.covered.upper - picture.covered.lower);
  const double from =
      std::max(std::min(limits.lower, picture.covered.lower), picture.covered.lower - beside);
  const double to =
      std::min(std::max(limits.upper, picture.covered.upper), picture.covered.upper + beside);
  for (int k = 0; k <= kPoints; ++k) {
    ReadingMapPoint point;
    point.reading = from + (to - from) * k / kPoints;
    point.map = calibration::map_at(model, point.reading);
    point.sigma = std::sqrt(calibration::map_variance_at(model, point.reading));
    point.covered =
        point.reading >= picture.covered.lower && point.reading <= picture.covered.upper;
    if (point.covered) picture.largest = std::max(picture.largest, std::abs(point.map));
    picture.points.push_back(point);
  }
  return picture;
}

// With one part of the model alone.
ArmModel gravity_of(const ArmModel& model) {
  ArmModel part = model;
  for (calibration::JointModel& joint : part.joints) joint.map.fill(0);
  return part;
}
ArmModel maps_of(const ArmModel& model) {
  ArmModel part = model;
  part.gravity.clear();
  return part;
}

// How far a part of the model moves the tool: RMS and at most.
calibration::Leftover moved_by(const SignatureRecord& record, const ArmModel& part,
                               const std::vector<JointVector>& poses) {
  const calibration::ReadingModel bent{record.nominal.couplings, {}, &part};
  const calibration::ReadingModel rigid{record.nominal.couplings, {}, nullptr};
  Signature tool = record.signature;
  tool.targets.clear();
  tool.targets.push_back(tool_of(record.signature));
  return calibration::difference(tool, bent, tool, rigid, poses);
}

}  // namespace

std::optional<ReadingMaps> reading_maps(const SignatureRecord& record) {
  if (!record.deflections) return std::nullopt;
  ReadingMaps maps;
  std::vector<JointVector> poses;
  for (int n = 1; n <= kConfigurations; ++n) {
    poses.push_back(
        calibration::covered_configuration(*record.deflections, record.nominal.limits, n));
  }
  const Target tool = tool_of(record.signature);
  const calibration::PoeChain chain(record.signature, record.readings());
  std::array<double, kMaxJoints> levers{};
  std::array<double, kMaxJoints> moves{};
  for (const JointVector& q : poses) {
    calibration::PointJacobian jacobian;
    const calibration::JointMotion motion = chain.motion(q);
    chain.point_and_jacobian(motion, tool, jacobian);
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (motion.joints[i].moved == 0) continue;
      const double lever = jacobian.motion[i].squaredNorm() / kConfigurations;
      const double map = calibration::map_at(record.deflections->joints[i], q[i]);
      levers[i] += lever;
      moves[i] += lever * map * map;
    }
  }
  for (std::size_t i = 0; i < record.signature.joint_count(); ++i) {
    maps.joints.push_back(curve_of(record, i));
    maps.joints.back().tool_m_per_unit = std::sqrt(levers[i]);
    maps.joints.back().tool_rms_m = std::sqrt(moves[i]);
  }
  maps.gravity_terms = record.deflections->gravity.size();
  const calibration::Leftover gravity = moved_by(record, gravity_of(*record.deflections), poses);
  maps.gravity_rms_m = gravity.rms_m;
  maps.gravity_largest_m = gravity.largest_m;
  maps.maps_rms_m = moved_by(record, maps_of(*record.deflections), poses).rms_m;
  return maps;
}

}  // namespace armsig::tool
