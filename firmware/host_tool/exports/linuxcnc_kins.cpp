// SPDX-License-Identifier: MIT
#include <array>
#include <span>

#include <fmt/core.h>

#include "core/base/crc32.hpp"
#include "core/base/joint_range.hpp"
#include "core/calibration/packed_deflections.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/exports/dh_rows.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"
#include "firmware/linuxcnc/kins_file.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kKinsFormat = "linuxcnc-kins";

std::string kins_numbers(std::span<const double> numbers) {
  std::string text;
  for (const double number : numbers) text += ' ' + number_text(number);
  return text;
}

std::string kins_row(const DhJoint& row) {
  return kins_numbers(std::array{row.theta_rad, row.d_m, row.a_m, row.alpha_rad});
}

// LinuxCNC stands in the arm's base frame; its INI file has the limits in its own units.
std::string kins_heading(const SignatureRecord& record, const StandardRows& standard) {
  std::string text = provenance(record) +
                     "For armsigkins, the kinematics module of LinuxCNC. The INI file must say:\n" +
                     fmt::format(
                         "  [KINS] KINEMATICS = armsigkins signature=(this file), JOINTS = "
                         "{}\n"
                         "  [TRAJ] COORDINATES = XYZABC, LINEAR_UNITS = mm, ANGULAR_UNITS "
                         "= degree\n",
                         record.signature.joint_count());
  for (std::size_t i = 0; i < record.nominal.limits.size(); ++i) {
    const auto [lower, upper] = record.nominal.limits[i];
    const bool turns = record.signature.types[i] == JointType::kRevolute;
    if (is_endless(record.nominal.limits[i])) {
      text += fmt::format("  [JOINT_{}] TYPE = ANGULAR, no MIN_LIMIT and no MAX_LIMIT\n", i);
      continue;
    }
    const double unit = turns ? degrees(1.0) : 1e3;
    text += fmt::format("  [JOINT_{}] TYPE = {}, MIN_LIMIT = {:.4f}, MAX_LIMIT = {:.4f}\n", i,
                        turns ? "ANGULAR" : "LINEAR", unit * lower, unit * upper);
  }
  return comment_text(text + "World coordinates are in the arm's base, in the sensor frame:\n" +
                      pose_words(standard.X_S0) + "\n");
}

std::string kins_maps(const SignatureRecord& record) {
  const auto packed = calibration::packed(*record.deflections);
  std::string text;
  for (std::size_t i = 0; i < record.nominal.joints.size(); ++i) {
    DhJoint row = record.nominal.joints[i];
    (row.type == JointType::kRevolute ? row.theta_rad : row.d_m) = packed.drawn_zero[i];
    text += "drawn" + kins_row(row) + "\n";
  }
  text += "configuration" + kins_numbers(record.signature.configuration) + "\n";
  for (std::size_t i = 0; i < packed.maps.size(); ++i) {
    const calibration::PackedMap& map = packed.maps[i];
    text += fmt::format("map {}", i + 1) +
            kins_numbers(std::array{map.domain.origin, map.domain.per_length, map.step});
    for (const std::int16_t step : map.steps) text += fmt::format(" {}", step);
    text += "\n";
  }
  text += "up" + kins_numbers(std::array{packed.up_0.x(), packed.up_0.y(), packed.up_0.z()}) + "\n";
  for (const calibration::GravityTerm& term : packed.gravity) {
    text += fmt::format("gravity {} {} {}\n", term.joint + 1, term.origin,
                        number_text(term.coefficient));
  }
  return text;
}

}  // namespace

Read<std::string> linuxcnc_kins_text(const SignatureRecord& record) {
  ARMSIG_TRY(standard, standard_rows(kKinsFormat, record));
  std::string text =
      fmt::format("armsig {}\n", linuxcnc::kKinsTag) + kins_heading(record, standard);
  for (std::size_t i = 0; i < standard.rows.size(); ++i) {
    const JointLimits& limits = record.nominal.limits[i];
    text += fmt::format("joint {}", word_of(standard.rows[i].type)) + kins_row(standard.rows[i]) +
            (is_endless(limits) ? " none" : kins_numbers(std::array{limits.lower, limits.upper})) +
            "\n";
  }
  for (const JointCoupling& coupling : record.nominal.couplings) {
    text += fmt::format("coupling {} {} {}\n", coupling.joint + 1, coupling.from + 1,
                        number_text(coupling.ratio));
  }
  const Eigen::Quaterniond q(standard.X_FL.R);
  const Vector3& p = standard.X_FL.p;
  text += "tip" + kins_numbers(std::array{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}) + "\n";
  const Pose X_nS = standard.X_FL * record.signature.X_SL.back().inverse();
  for (const Target& target : record.signature.targets) {
    if (target.link != record.signature.joint_count()) continue;
    const Vector3 p_nT = X_nS * target.p_S;
    text += fmt::format("tool {}", target.number) + kins_numbers(std::span(p_nT.data(), 3)) + "\n";
  }
  if (record.deflections) text += kins_maps(record);
  return text + fmt::format("crc32 0x{:08X}\n", crc32(std::as_bytes(std::span(text))));
}

}  // namespace armsig::tool
