// SPDX-License-Identifier: MIT
#include "core/calibration/model.hpp"

#include <cmath>

#include "core/base/sine_cosine.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::calibration {

namespace {

// E_i.
Pose deviation_pose(const JointModel& joint) {
  Pose E;
  E.p = Vector3(joint.deviation[2], joint.deviation[3], 0);
  E.R = numerics::rotation_by({joint.deviation[0], joint.deviation[1], 0});
  return E;
}

}  // namespace

ArmModel model_of(const Arm& arm, const Pose& X_SB) {
  ArmModel model;
  model.couplings = arm.couplings;
  model.up_0 = arm.up_0;
  model.X_SB = X_SB;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    const bool revolute = row.type == JointType::kRevolute;
    JointModel joint;
    joint.type = row.type;
    joint.offset = revolute ? row.theta_rad : row.d_m;
    joint.after.R = rotation_x(row.alpha_rad);
    joint.after.p = Vector3(row.a_m, 0, revolute ? row.d_m : 0);
    if (!revolute) joint.after = Pose{rotation_z(row.theta_rad), Vector3::Zero()} * joint.after;
    joint.domain = map_domain(row.type, arm.limits.empty() ? JointLimits{} : arm.limits[i]);
    model.joints.push_back(joint);
  }
  return model;
}

double map_at(const JointModel& joint, double reading) {
  return map_unit(joint.type) * map_value(joint.map, spline_support(joint.domain, reading));
}

void ask_for(const ParameterRequest& request, ArmModel& model) {
  model.further.clear();
  const auto add = [&](ParameterKind kind, std::size_t index, std::size_t count) {
    for (std::size_t c = 0; c < count; ++c) {
      model.further.push_back(
          {kind, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(c)});
    }
  };
  for (std::size_t j = 0; j < request.readings.size(); ++j) {
    const bool revolute = model.joints[j].type == JointType::kRevolute;
    if (request.readings[j].gain) add(ParameterKind::kReadingGain, j, 1);
    if (request.readings[j].first && revolute) add(ParameterKind::kReadingFirst, j, 2);
    if (request.readings[j].second && revolute) add(ParameterKind::kReadingSecond, j, 2);
  }
  for (std::size_t r = 0; request.receiver_offsets && r < model.sensor.receivers.size(); ++r) {
    add(ParameterKind::kReceiverOffset, r, 1);
  }
  if (request.scale) add(ParameterKind::kScale, 0, 1);
}

namespace {

// Of a model that may be changed, or not.
template <typename Model>
auto& value_in(Model& model, const Parameter& parameter) {
  if (of_reading(parameter)) return model.joints[parameter.index].correction.*term_of(parameter);
  if (parameter.kind == ParameterKind::kReceiverOffset) {
    return model.sensor.offset_m[parameter.index];
  }
  ARMSIG_CHECK(parameter.kind == ParameterKind::kScale);
  return model.sensor.scale;
}

}  // namespace

double& value_of(ArmModel& model, const Parameter& parameter) { return value_in(model, parameter); }

double value_of(const ArmModel& model, const Parameter& parameter) {
  return value_in(model, parameter);
}

void deflections(const ArmModel& model, const JointVector& readings,
                 std::array<double, kMaxJoints>& by) {
  by.fill(0);
  if (!model.gravity.empty()) {
    GravityLevers levers;
    gravity_levers(model, effective_readings(model.couplings, readings), levers);
    for (std::size_t t = 0; t < model.gravity.size(); ++t) {
      by[model.gravity[t].joint] += model.gravity[t].coefficient * levers[t];
    }
  }
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    by[i] += map_at(model.joints[i], readings[i]);
  }
}

double map_variance_at(const JointModel& joint, double reading) {
  // A spline's middle is two knots beyond its first.
  const SplineSupport support = spline_support(joint.domain, reading);
  double variance = 0;
  for (std::size_t k = 0; k < kSplines; ++k) {
    variance += support.weight[k] * static_cast<double>(joint.map_variance[support.knot(k)]);
  }
  const double unit = map_unit(joint.type);
  return unit * unit * variance;
}

void look_up(const ArmModel& model, const JointVector& readings, std::size_t link,
             ChainFrames& frames) {
  frames.effective = effective_readings(model.couplings, readings);
  if (!model.gravity.empty()) gravity_levers(model, frames.effective, frames.levers);
  for (std::size_t i = 0; i < link; ++i) {
    frames.support[i] = spline_support(model.joints[i].domain, readings[i]);
  }
}

void place_links(const ArmModel& model, FixedLinks& links) {
  Pose before = model.X_SB;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    links.X_J[i] = before * deviation_pose(model.joints[i]);
    before = model.joints[i].after;
  }
}

void place_chain(const ArmModel& model, const FixedLinks& links, std::size_t link,
                 ChainFrames& frames) {
  std::array<double, kMaxJoints> sag{};
  for (std::size_t t = 0; t < model.gravity.size(); ++t) {
    sag[model.gravity[t].joint] += model.gravity[t].coefficient * frames.levers[t];
  }
  Pose X;
  for (std::size_t i = 0; i < link; ++i) {
    const JointModel& joint = model.joints[i];
    X = i == 0 ? links.X_J[0] : X * links.X_J[i];
    frames.X_SJ[i] = X;
    const double motion = corrected(joint.correction, frames.effective[i]) + joint.offset +
                          joint.deviation[4] + sag[i] +
                          map_unit(joint.type) * map_value(joint.map, frames.support[i]);
    if (joint.type == JointType::kRevolute) {
      const SineCosine turn = sine_and_cosine(motion);
      const Vector3 x = X.R.col(0);
      X.R.col(0) = turn.cosine * x + turn.sine * X.R.col(1);
      X.R.col(1) = turn.cosine * X.R.col(1) - turn.sine * x;
    } else {
      X.p += motion * X.R.col(2);
    }
  }
  frames.X_SL = link == 0 ? model.X_SB : X * model.joints[link - 1].after;
}

void evaluate_chain(const ArmModel& model, const JointVector& readings, std::size_t link,
                    ChainFrames& frames) {
  FixedLinks links;
  place_links(model, links);
  look_up(model, readings, link, frames);
  place_chain(model, links, link, frames);
}

}  // namespace armsig::calibration
