// SPDX-License-Identifier: MIT
#include "firmware/formats/poses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/check.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/csv_table.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/orientation_columns.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

Read<std::vector<JointVector>> joint_poses_from(LineReader lines, const JointTypes& types) {
  ARMSIG_TRY(table, CsvTable::open(std::move(lines), joint_quantities(types)));
  std::vector<JointVector> poses;
  for (;;) {
    ARMSIG_TRY(more, table.next());
    if (!more) break;
    JointVector q(types.size());
    for (std::size_t i = 0; i < types.size(); ++i) q[i] = table.value(i);
    poses.push_back(q);
  }
  if (poses.empty()) return table.problem("the file ends after its header", "rows of poses");
  return poses;
}

Read<std::vector<Pose>> tool_poses_from(LineReader lines) {
  std::vector<Quantity> quantities;
  for (const char* name : {"x", "y", "z"}) quantities.push_back({name, Dimension::kLength});
  const std::size_t first = quantities.size();
  for (Quantity& quantity : orientation_quantities()) quantities.push_back(std::move(quantity));
  for (const char* name : {"sigma_x", "sigma_y", "sigma_z", "sigma"}) {
    quantities.push_back({.name = name, .dimension = Dimension::kLength, .required = false});
  }
  ARMSIG_TRY(table, CsvTable::open(std::move(lines), std::move(quantities)));
  ARMSIG_TRY(orientation, OrientationColumns::of(table, first));
  std::vector<Pose> poses;
  for (;;) {
    ARMSIG_TRY(more, table.next());
    if (!more) break;
    ARMSIG_TRY(R, orientation.rotation(table));
    poses.push_back({R, Vector3(table.value(0), table.value(1), table.value(2))});
  }
  if (poses.empty()) return table.problem("the file ends after its header", "rows of poses");
  return poses;
}

// Appends `values` as a row; false if one is not finite.
bool append_row(std::string& text, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ',';
    text += number_text(values[i]);
  }
  text += '\n';
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

Read<void> write_poses(const std::string& path, const std::string& text, bool all_finite) {
  if (!all_finite) {
    return std::unexpected(
        Problem{path, 0, 0, "a pose to be written is not finite", "finite numbers"});
  }
  return write_text_file(path, text);
}

}  // namespace

Read<std::vector<JointVector>> read_joint_poses(const std::string& path, const JointTypes& types) {
  ARMSIG_TRY(lines, LineReader::open(path));
  return joint_poses_from(std::move(lines), types);
}

Read<std::vector<JointVector>> parse_joint_poses(std::string_view text, std::string_view file,
                                                 const JointTypes& types) {
  return joint_poses_from(LineReader::over(text, file), types);
}

Read<std::vector<Pose>> read_tool_poses(const std::string& path) {
  ARMSIG_TRY(lines, LineReader::open(path));
  return tool_poses_from(std::move(lines));
}

Read<std::vector<Pose>> parse_tool_poses(std::string_view text, std::string_view file) {
  return tool_poses_from(LineReader::over(text, file));
}

Read<void> write_joint_poses(const std::string& path, const JointTypes& types,
                             std::span<const JointVector> poses, std::string_view comment) {
  std::string text = comment_text(comment) + joint_header(types) + "\n";
  bool all_finite = true;
  for (const JointVector& q : poses) {
    ARMSIG_CHECK(q.size() == types.size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (i > 0) text += ',';
      text += text_in(unit_of(types[i]), q[i]);
      all_finite = all_finite && std::isfinite(q[i]);
    }
    text += '\n';
  }
  return write_poses(path, text, all_finite);
}

Read<void> write_tool_poses(const std::string& path, std::span<const Pose> poses,
                            std::string_view comment, std::span<const Vector3> sigmas_m) {
  ARMSIG_CHECK(sigmas_m.empty() || sigmas_m.size() == poses.size());
  std::string text = comment_text(comment) + "x_m,y_m,z_m,qw,qx,qy,qz";
  text += sigmas_m.empty() ? "\n" : ",sigma_x_m,sigma_y_m,sigma_z_m,sigma_m\n";
  bool all_finite = true;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose& X = poses[k];
    const Eigen::Quaterniond q(X.R);
    std::vector<double> row{X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
    if (!sigmas_m.empty()) {
      const Vector3& sigma_m = sigmas_m[k];
      row.insert(row.end(), {sigma_m.x(), sigma_m.y(), sigma_m.z(), sigma_m.norm()});
    }
    all_finite = append_row(text, row) && all_finite;
  }
  return write_poses(path, text, all_finite);
}

}  // namespace armsig::tool
