// SPDX-License-Identifier: MIT
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/joint_range.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/library/joint_frames.hpp"

namespace armsig::tool {
namespace {

using Json = nlohmann::ordered_json;

// Row by row, 4 x 4.
Json pose_json(const Pose& X) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({X.R(r, 0), X.R(r, 1), X.R(r, 2), X.p(r)});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

Json couplings_json(const Arm& arm) {
  Json couplings = Json::array();
  for (const JointCoupling& coupling : arm.couplings) {
    couplings.push_back(
        {{"joint", coupling.joint + 1}, {"from", coupling.from + 1}, {"ratio", coupling.ratio}});
  }
  return couplings;
}

// The row of the drawing, with what was found of the joint's zero.
Json drawing_json(const calibration::JointModel& joint, const DhJoint& row) {
  const bool revolute = row.type == JointType::kRevolute;
  return {{"theta_rad", revolute ? joint.offset : row.theta_rad},
          {"d_m", revolute ? row.d_m : joint.offset},
          {"a_m", row.a_m},
          {"alpha_rad", row.alpha_rad}};
}

Json map_json(const calibration::JointModel& joint) {
  const double unit = calibration::map_unit(joint.type);
  Json coefficients = Json::array();
  Json sigmas = Json::array();
  for (std::size_t k = 0; k < calibration::kKnots; ++k) {
    coefficients.push_back(unit * joint.map[k]);
    sigmas.push_back(unit * std::sqrt(static_cast<double>(joint.map_variance[k])));
  }
  return {{"origin", joint.domain.origin},
          {"knots_per_unit", joint.domain.per_length},
          {"covered", {joint.covered.lower, joint.covered.upper}},
          {"coefficients", std::move(coefficients)},
          {"sigmas", std::move(sigmas)}};
}

// What the joints turn beyond their readings.
Json deflections_json(const SignatureRecord& record) {
  const calibration::ArmModel& model = *record.deflections;
  Json drawing = Json::array();
  Json maps = Json::array();
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    drawing.push_back(drawing_json(model.joints[i], record.nominal.joints[i]));
    maps.push_back(map_json(model.joints[i]));
  }
  Json gravity = Json::array();
  for (const calibration::GravityTerm& term : model.gravity) {
    gravity.push_back(
        {{"joint", term.joint + 1}, {"link", term.origin}, {"coefficient", term.coefficient}});
  }
  Json at_rest = Json::array();
  for (const double q : readings_for(record.nominal.couplings, record.signature.configuration)) {
    at_rest.push_back(q);
  }
  return {
      {"note",
       "in joint_frames, q of joint i is its effective reading + d_i(readings) - d_i(at_rest); "
       "d_i = map i at reading i + the sum of its gravity terms. Map: periodic cubic B-spline, "
       "u = (reading - origin) knots_per_unit, k = floor(u), t = u - k, the sum of coefficients "
       "k ... k + 3 modulo 120 by (1-t)^3/6, (4-6t^2+3t^3)/6, (4-6(1-t)^2+3(1-t)^3)/6, t^3/6. "
       "Gravity: coefficient z_joint . ((O_link - O_joint) x down), of a slide z_joint . down; "
       "axes and origins by `nominal` at the effective readings, down = -up in its frame 0"},
      {"nominal", std::move(drawing)},
      {"at_rest", std::move(at_rest)},
      {"up", {model.up_0.x(), model.up_0.y(), model.up_0.z()}},
      {"gravity", std::move(gravity)},
      {"maps", std::move(maps)}};
}

}  // namespace

Read<std::string> json_text(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  const JointFrames frames = joint_frames(record);
  Json joints = Json::array();
  for (const Pose& X_PJ : frames.X_PJ) joints.push_back(pose_json(X_PJ));
  Json limits = Json::array();
  for (const JointLimits& limit : record.nominal.limits) {
    limits.push_back(is_endless(limit) ? Json(nullptr) : Json{limit.lower, limit.upper});
  }
  Json json{
      {"armsig", "export/1"},
      {"name", record.arm_name},
      {"serial", record.serial},
      {"method", record.method},
      {"time", record.time},
      {"version", record.version},
      {"units", "m, rad"},
      {"signature", signature_json(signature)},
      {"limits", std::move(limits)},
      {"coupling", couplings_json(record.nominal)},
      {"standard_dh",
       {{"base_in_sensor", pose_json(signature.X_SL[0])},
        {"note", "rows are signature.joints; base, rows, then last_link at the configuration"}}},
      {"last_link_in_sensor_at_signature_configuration", pose_json(signature.X_SL.back())},
      {"joint_frames",
       {{"note",
         "pose of the last link = base * product of (joint, then Rot(z, q) or Trans(0, 0, q)) * "
         "last_link"},
        {"base", pose_json(frames.X_SB)},
        {"joints", std::move(joints)},
        {"last_link", pose_json(frames.X_KL)}}}};
  if (record.deflections) json["deflections"] = deflections_json(record);
  return json_text(json, 2) + "\n";
}

}  // namespace armsig::tool
