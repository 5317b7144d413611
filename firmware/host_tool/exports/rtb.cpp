// SPDX-License-Identifier: MIT
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "firmware/host_tool/exports/dh_rows.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"
#include "firmware/host_tool/formats/csv_text.hpp"
#include "firmware/host_tool/formats/text.hpp"

namespace armsig::tool {
namespace {

std::string matrix(const Pose& X) {
  std::string text = "SE3(np.array([\n";
  for (int r = 0; r < 3; ++r) {
    text += fmt::format("    [{}, {}, {}, {}],\n", number_text(X.R(r, 0)), number_text(X.R(r, 1)),
                        number_text(X.R(r, 2)), number_text(X.p(r)));
  }
  return text + "    [0, 0, 0, 1],\n]), check=False)";
}

std::string link(const DhJoint& row, const JointLimits& limits) {
  const bool revolute = row.type == JointType::kRevolute;
  return fmt::format("    {}({}={}, a={}, alpha={}, offset={}, qlim=[{}, {}]),\n",
                     revolute ? "RevoluteDH" : "PrismaticDH", revolute ? "d" : "theta",
                     number_text(revolute ? row.d_m : row.theta_rad), number_text(row.a_m),
                     number_text(row.alpha_rad), number_text(revolute ? row.theta_rad : row.d_m),
                     number_text(limits.lower), number_text(limits.upper));
}

}  // namespace

Read<std::string> rtb_text(const SignatureRecord& record) {
  ARMSIG_TRY(standard, standard_rows("rtb", record));
  std::string text =
      comment_text(provenance(record) +
                   "Robotics Toolbox for Python. robot.fkine(effective(q)) is the pose of the last "
                   "link\nin the sensor frame; q in radians and metres.\n") +
      "import numpy as np\n"
      "from roboticstoolbox import DHRobot, PrismaticDH, RevoluteDH\n"
      "from spatialmath import SE3\n\n"
      "links = [\n";
  for (std::size_t i = 0; i < standard.rows.size(); ++i) {
    text += link(standard.rows[i], record.nominal.limits[i]);
  }
  // A JSON string is a Python string.
  text += fmt::format(
      "]\nbase = {}\ntool = {}\nrobot = DHRobot(links, name={}, base=base, tool=tool)\n",
      matrix(standard.X_S0), matrix(standard.X_FL),
      nlohmann::json(record.arm_name).dump(-1, ' ', true));
  text +=
      "\n\ndef effective(q):\n"
      "    \"\"\"The readings that move the joints: couplings added.\"\"\"\n"
      "    effective_q = np.array(q, dtype=float)\n";
  for (const JointCoupling& coupling : record.nominal.couplings) {
    text += fmt::format("    effective_q[..., {}] += {} * np.asarray(q)[..., {}]\n", coupling.joint,
                        number_text(coupling.ratio), coupling.from);
  }
  return text + "    return effective_q\n";
}

}  // namespace armsig::tool
