// SPDX-License-Identifier: MIT
#include <cmath>

#include <fmt/core.h>

#include "core/base/check.hpp"
#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
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

// What the INI file says of the same arm: units, and the limits as joints of genserkins.
std::string ini_lines(const SignatureRecord& record, const JointVector& offsets) {
  std::string text =
      "The INI file must say:\n"
      "  [KINS] KINEMATICS = genserkins, JOINTS = 6\n"
      "  [TRAJ] COORDINATES = XYZABC, LINEAR_UNITS = mm, ANGULAR_UNITS = degree\n";
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const JointLimits& limits = record.nominal.limits[i];
    if (is_endless(limits)) {
      text += fmt::format("  [JOINT_{}] TYPE = ANGULAR, no MIN_LIMIT and no MAX_LIMIT\n", i);
      continue;
    }
    text += fmt::format("  [JOINT_{}] TYPE = ANGULAR, MIN_LIMIT = {:.4f}, MAX_LIMIT = {:.4f}\n", i,
                        degrees(limits.lower + offsets[i]), degrees(limits.upper + offsets[i]));
  }
  return text;
}

// The functions of the offsets, without which they pass nothing on, and their ends at the joints.
std::string thread_lines() {
  std::string text;
  for (int i = 0; i < 6; ++i) {
    text += fmt::format(
        "addf joint-offset.{0}.update-feedback servo-thread\n"
        "addf joint-offset.{0}.update-output servo-thread\n"
        "net joint-{0}-cmd joint.{0}.motor-pos-cmd => joint-offset.{0}.in\n"
        "net joint-{0}-fb joint-offset.{0}.fb-out => joint.{0}.motor-pos-fb\n",
        i);
  }
  return text;
}

// What a compensation table may hold at most, in LinuxCNC.
constexpr int kMostTriplets = 256;

std::string table_name(std::size_t joint) { return fmt::format(".joint-{}.comp", joint); }

// Where the tables are, for the settings of the joints.
std::string table_lines(const SignatureRecord& record) {
  if (!record.deflections) return "";
  std::string text =
      "The joint error maps are in compensation tables beside this file. For each joint, in "
      "the "
      "INI file:\n";
  for (std::size_t i = 0; i < record.signature.joint_count(); ++i) {
    text += fmt::format("  [JOINT_{}] COMP_FILE_TYPE = 0, COMP_FILE = (this file's name){}\n", i,
                        table_name(i));
  }
  return text + "LinuxCNC ignores BACKLASH where a joint has a table.\n";
}

// What a person has to know who loads the file.
std::string head_lines(const SignatureRecord& record, const ModifiedRows& modified,
                       const JointVector& offsets) {
  return comment_text(
      provenance(record) +
      "HAL settings for genserkins of LinuxCNC: modified (Craig) Denavit-Hartenberg rows, A and D "
      "in\n"
      "millimetres, ALPHA in radians, joints counted from 0:\n"
      "Rot(x, ALPHA) Trans(A, 0, 0) Rot(z, joint) Trans(0, 0, D).\n" +
      ini_lines(record, offsets) +
      "HALFILE: this file after the one that loads genserkins and motion and adds their functions "
      "and the\n"
      "drives' reads to servo-thread, and before the one that adds the drives' writes.\n"
      "genserkins has no joint offset: a component called offset for each joint carries it, in "
      "degrees,\n"
      "joint of genserkins = reading + theta offset. What is left to connect, in degrees, is the "
      "drive:\n"
      "  net j0-out joint-offset.0.out    => (the drive's position command)\n"
      "  net j0-fb  (the drive's reading) => joint-offset.0.fb-in\n"
      "Connect joint.N.motor-pos-cmd and joint.N.motor-pos-fb to nothing else.\n"
      "What genserkins leaves out stands before and after its product:\n"
      "base: " +
      pose_words(modified.X_S0) + "\ntool: " + pose_words(modified.X_FL) + "\n" +
      table_lines(record));
}

// The rows for genserkins, and a component for each joint's offset.
std::string joint_lines(const ModifiedRows& modified, const JointVector& offsets) {
  std::string text = "loadrt offset names=";
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
  return text;
}

// LinuxCNC sends nominal + (nominal - forward) to the drive where it wants nominal: with the map m
// at reading r, nominal = offset + r + m(r) and forward = nominal + m(r) make that offset + r.
std::string table_text(const calibration::JointModel& joint, const JointLimits& limits,
                       double offset_rad, double at_rest_rad) {
  std::string text;
  for (int k = 0; k < kMostTriplets; ++k) {
    const double part = static_cast<double>(k) / (kMostTriplets - 1);
    const double reading = limits.lower + part * (limits.upper - limits.lower);
    const double map_rad = calibration::map_at(joint, reading) - at_rest_rad;
    const double nominal_deg = degrees(offset_rad + reading + map_rad);
    const double actual_deg = nominal_deg + degrees(map_rad);
    text += fmt::format("{:.9f} {:.9f} {:.9f}\n", nominal_deg, actual_deg, actual_deg);
  }
  return text;
}

}  // namespace

std::vector<Companion> linuxcnc_tables(const SignatureRecord& record) {
  if (!record.deflections) return {};
  const auto standard = standard_rows(kLinuxCncFormat, record);
  ARMSIG_CHECK(standard);
  const JointVector offsets = offsets_rad(record.nominal, modified_rows(*standard));
  const JointVector at_rest =
      readings_for(record.nominal.couplings, record.signature.configuration);
  std::vector<Companion> tables;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const calibration::JointModel& joint = record.deflections->joints[i];
    tables.push_back({table_name(i), table_text(joint, record.nominal.limits[i], offsets[i],
                                                calibration::map_at(joint, at_rest[i]))});
  }
  return tables;
}

Read<std::string> linuxcnc_text(const SignatureRecord& record) {
  if (auto six = need_six_revolute(kLinuxCncFormat, record.signature); !six) {
    return std::unexpected(std::move(six).error());
  }
  // LinuxCNC holds the last entry beyond a table; a map goes on turn after turn.
  if (record.deflections) {
    for (std::size_t i = 0; i < record.nominal.limits.size(); ++i) {
      if (!is_endless(record.nominal.limits[i])) continue;
      return cannot_hold(
          kLinuxCncFormat,
          fmt::format("joint {} turns without end, and its map is a table with ends", i + 1),
          "linuxcnc-kins, which holds any");
    }
  }
  ARMSIG_TRY(unrotate, unrotate_lines(record.nominal));
  ARMSIG_TRY(standard, standard_rows(kLinuxCncFormat, record));
  const ModifiedRows modified = modified_rows(standard);
  const JointVector offsets = offsets_rad(record.nominal, modified);
  return head_lines(record, modified, offsets) + joint_lines(modified, offsets) + unrotate +
         thread_lines();
}

}  // namespace armsig::tool
