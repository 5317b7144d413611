// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string_view>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/exports/dh_rows.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

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
  const std::string qlim = is_endless(limits) ? "None"
                                              : fmt::format("[{}, {}]", number_text(limits.lower),
                                                            number_text(limits.upper));
  return fmt::format("    {}({}={}, a={}, alpha={}, offset={}, qlim={}),\n",
                     revolute ? "RevoluteDH" : "PrismaticDH", revolute ? "d" : "theta",
                     number_text(revolute ? row.d_m : row.theta_rad), number_text(row.a_m),
                     number_text(row.alpha_rad), number_text(revolute ? row.theta_rad : row.d_m),
                     qlim);
}

// A string of Python in ASCII. JSON writes what is above U+FFFF as two halves, which Python keeps.
std::string python_quoted(std::string_view text) {
  std::string quoted = "\"";
  while (!text.empty()) {
    const Character character = first_character(text);
    if (character.length == 0) {
      quoted += "\\ufffd";
    } else if (character.code == '"' || character.code == '\\') {
      quoted += {'\\', text[0]};
    } else if (character.code >= 0x20 && character.code < 0x7F) {
      quoted += text[0];
    } else {
      quoted += fmt::format("\\U{:08x}", character.code);
    }
    text.remove_prefix(std::max<std::size_t>(character.length, 1));
  }
  return quoted + "\"";
}

}  // namespace

Read<std::string> rtb_text(const SignatureRecord& record) {
  ARMSIG_TRY(standard, standard_rows("rtb", record));
  // A name in the first two lines could state another encoding of the source; the first one counts.
  std::string text =
      "# -*- coding: utf-8 -*-\n" +
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
  text += fmt::format(
      "]\nbase = {}\ntool = {}\nrobot = DHRobot(links, name={}, base=base, tool=tool)\n",
      matrix(standard.X_S0), matrix(standard.X_FL), python_quoted(record.arm_name));
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
