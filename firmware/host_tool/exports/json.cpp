// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/joint_frames.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"

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

}  // namespace

Read<std::string> json_text(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  const JointFrames frames = joint_frames(record);
  Json joints = Json::array();
  for (const Pose& X_PJ : frames.X_PJ) joints.push_back(pose_json(X_PJ));
  Json limits = Json::array();
  for (const JointLimits& limit : record.nominal.limits)
    limits.push_back({limit.lower, limit.upper});
  const Json json{
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
  return json_text(json, 2) + "\n";
}

}  // namespace armsig::tool
