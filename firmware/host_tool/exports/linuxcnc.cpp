// SPDX-License-Identifier: MIT
#include <cmath>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/exports/dh_rows.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kLinuxCncFormat = "linuxcnc";

// genserkins takes `unrotate` times the angle of the joint before from a joint's own.
Read<std::string> unrotate_lines(const Arm& arm) {
  std::string text;
  FixedVector<bool, kMaxJoints> coupled;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) coupled.push_back(false);
  for (const JointCoupling& coupling : arm.couplings) coupled[coupling.joint] = true;
  for (const JointCoupling& coupling : arm.couplings) {
    const bool whole =
        coupling.ratio == std::round(coupling.ratio) && std::abs(coupling.ratio) < 100;
    if (!whole || coupling.from + 1 != coupling.joint || coupled[coupling.from]) {
      return cannot_hold(
          kLinuxCncFormat,
          fmt::format("joint {} is coupled to joint {} by {}", coupling.joint + 1,
                      coupling.from + 1, coupling.ratio),
          "a coupling by a whole number to the joint before, which is not coupled itself; urdf "
          "holds any");
    }
    text += fmt::format("setp genserkins.unrotate-{} {}\n", coupling.joint,
                        -static_cast<int>(coupling.ratio));
  }
  return text;
}

// Angle of each joint of genserkins at reading zero. `unrotate` acts on the angles of genserkins,
// so that the offset of the joint before comes along and is taken off again here.
JointVector offsets_rad(const Arm& arm, const ModifiedRows& modified) {
  JointVector offsets;
  for (const ModifiedRow& row : modified.rows) offsets.push_back(row.theta_rad);
  for (const JointCoupling& coupling : arm.couplings) {
    offsets[coupling.joint] -= coupling.ratio * modified.rows[coupling.from].theta_rad;
  }
  return offsets;
}

}  // namespace

Read<std::string> linuxcnc_text(const SignatureRecord& record) {
  if (auto six = need_six_revolute(kLinuxCncFormat, record.signature); !six) {
    return std::unexpected(std::move(six).error());
  }
  ARMSIG_TRY(unrotate, unrotate_lines(record.nominal));
  ARMSIG_TRY(standard, standard_rows(kLinuxCncFormat, record));
  const ModifiedRows modified = modified_rows(standard);
  const JointVector offsets = offsets_rad(record.nominal, modified);
  std::string text = comment_text(
      provenance(record) +
      "HAL settings for genserkins of LinuxCNC: modified (Craig) Denavit-Hartenberg rows, A and D "
      "in\n"
      "millimetres, ALPHA in radians, joints counted from 0:\n"
      "Rot(x, ALPHA) Trans(A, 0, 0) Rot(z, joint) Trans(0, 0, D).\n"
      "genserkins has no joint offset. The offsets, in degrees, are in components called offset:\n"
      "joint of genserkins = reading + theta offset. Connect each joint through its component:\n"
      "  net j0-cmd joint.0.motor-pos-cmd => joint-offset.0.in\n"
      "  net j0-out joint-offset.0.out    => (the drive's position command)\n"
      "  net j0-fb  (the drive's reading) => joint-offset.0.fb-in\n"
      "  net j0-kin joint-offset.0.fb-out => joint.0.motor-pos-fb\n"
      "What genserkins leaves out stands before and after its product:\n"
      "base: " +
      pose_words(modified.X_S0) + "\ntool: " + pose_words(modified.X_FL) + "\n");
  text += "loadrt offset names=";
  for (std::size_t i = 0; i < 6; ++i)
    text += fmt::format("{}joint-offset.{}", i == 0 ? "" : ",", i);
  text += "\n";
  for (std::size_t i = 0; i < 6; ++i) {
    const ModifiedRow& row = modified.rows[i];
    text += fmt::format(
        "setp genserkins.A-{0} {1}\nsetp genserkins.ALPHA-{0} {2}\nsetp genserkins.D-{0} {3}\n"
        "setp joint-offset.{0}.offset {4}\n",
        i, number_text(1e3 * row.a_prev_m), number_text(row.alpha_prev_rad),
        number_text(1e3 * row.d_m), number_text(-degrees(offsets[i])));
  }
  return text + unrotate;
}

}  // namespace armsig::tool
