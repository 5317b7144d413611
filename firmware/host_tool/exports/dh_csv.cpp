// SPDX-License-Identifier: MIT
#include <array>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/exports/dh_rows.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

// A spreadsheet takes what follows a separator and an equals sign for a formula, in a comment too.
std::string without_formulas(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of(",;", at)) != std::string::npos; ++at) {
    const std::size_t next = text.find_first_not_of(' ', at + 1);
    if (next == std::string::npos) break;
    if (std::string_view("=+-@").find(text[next]) != std::string_view::npos)
      text.insert(next, 1, '\'');
  }
  return text;
}

std::string heading(const SignatureRecord& record, const std::string& convention, const Pose& X_S0,
                    const Pose& X_FL) {
  return comment_text(
      without_formulas(provenance(record)) + convention +
      "The reading is added to theta of a revolute joint, to d of a prismatic one.\n"
      "A joint without lower and upper turns without end.\n"
      "Pose of the last link in the sensor frame = base * product of the rows * tool.\n"
      "base: " +
      pose_words(X_S0) + "\ntool: " + pose_words(X_FL) + "\n" + coupling_lines(record.nominal));
}

std::string row_text(std::size_t joint, JointType type, const std::array<double, 4>& parameters,
                     const JointLimits& limits) {
  std::string text = fmt::format("{},{}", joint + 1, word_of(type));
  for (const double parameter : parameters) text += fmt::format(",{}", number_text(parameter));
  if (is_endless(limits)) return text + ",,\n";
  return text + fmt::format(",{},{}\n", number_text(limits.lower), number_text(limits.upper));
}

}  // namespace

Read<std::string> dh_csv_text(const SignatureRecord& record) {
  ARMSIG_TRY(standard, standard_rows("dh-csv", record));
  std::string text =
      heading(record,
              "Standard (distal) Denavit-Hartenberg: Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) "
              "Rot(x, alpha).\n",
              standard.X_S0, standard.X_FL) +
      "joint,type,theta_rad,d_m,a_m,alpha_rad,lower_rad_or_m,upper_rad_or_m\n";
  for (std::size_t i = 0; i < standard.rows.size(); ++i) {
    const DhJoint& row = standard.rows[i];
    text += row_text(i, row.type, {row.theta_rad, row.d_m, row.a_m, row.alpha_rad},
                     record.nominal.limits[i]);
  }
  return text;
}

Read<std::string> mdh_csv_text(const SignatureRecord& record) {
  ARMSIG_TRY(standard, standard_rows("mdh-csv", record));
  const ModifiedRows modified = modified_rows(standard);
  std::string text =
      heading(record,
              "Modified (Craig) Denavit-Hartenberg: Rot(x, alpha_prev) Trans(a_prev, 0, 0) "
              "Rot(z, theta) Trans(0, 0, d).\n",
              modified.X_S0, modified.X_FL) +
      "joint,type,alpha_prev_rad,a_prev_m,theta_rad,d_m,lower_rad_or_m,upper_rad_or_m\n";
  for (std::size_t i = 0; i < modified.rows.size(); ++i) {
    const ModifiedRow& row = modified.rows[i];
    text += row_text(i, row.type, {row.alpha_prev_rad, row.a_prev_m, row.theta_rad, row.d_m},
                     record.nominal.limits[i]);
  }
  return text;
}

}  // namespace armsig::tool
