// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "core/base/joint_range.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"
#include "firmware/host_tool/exports/urdf_places.hpp"
#include "firmware/library/joint_frames.hpp"

namespace armsig::tool {
namespace {

std::string origin(const Pose& X) { return "    " + origin_element(X) + "\n"; }

std::string link(const std::string& name) { return fmt::format("  <link name=\"{}\"/>\n", name); }

std::string fixed(const std::string& name, const std::string& parent, const std::string& child,
                  const Pose& X_PC) {
  return fmt::format(
             "  <joint name=\"{}\" type=\"fixed\">\n"
             "    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n",
             name, parent, child) +
         origin(X_PC) + "  </joint>\n" + link(child);
}

struct MovingJoint {
  std::string name, parent, child;
  JointType type = JointType::kRevolute;
  Pose X_PJ;
  JointLimits limits;
  std::string mimic;  // an element, or nothing
};

std::string limit_element(const JointLimits& limits) {
  if (is_endless(limits)) return "    <limit effort=\"0\" velocity=\"0\"/>\n";
  return fmt::format("    <limit lower=\"{}\" upper=\"{}\" effort=\"0\" velocity=\"0\"/>\n",
                     number_text(limits.lower), number_text(limits.upper));
}

std::string moving(const MovingJoint& joint) {
  return fmt::format(
             "  <joint name=\"{}\" type=\"{}\">\n"
             "    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n",
             joint.name, is_endless(joint.limits) ? "continuous" : word_of(joint.type),
             joint.parent, joint.child) +
         origin(joint.X_PJ) + "    <axis xyz=\"0 0 1\"/>\n" + limit_element(joint.limits) +
         joint.mimic + "  </joint>\n" + link(joint.child);
}

// What the joints are called: as in the file that the arm was imported from, unless a name there is
// one that this file needs for itself.
std::vector<std::string> joint_names(const SignatureRecord& record) {
  const auto is_ours = [](const std::string& name) {
    return name == "sensor_to_base" || name.starts_with("to_last_link") ||
           name.starts_with("to_target_") || name.contains("_from_");
  };
  if (!record.joint_names.empty() && std::ranges::none_of(record.joint_names, is_ours)) {
    return record.joint_names;
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < record.signature.joint_count(); ++i) {
    names.push_back(fmt::format("joint_{}", i + 1));
  }
  return names;
}

// A coupled joint's share of what the joint that it follows turns: a joint of its own before it.
MovingJoint coupled_share(const SignatureRecord& record, const JointCoupling& coupling,
                          const std::string& followed) {
  const JointLimits& from = record.nominal.limits[coupling.from];
  const auto [lower, upper] =
      std::minmax({coupling.ratio * from.lower, coupling.ratio * from.upper});
  const std::string suffix = fmt::format("{}_from_{}", coupling.joint + 1, coupling.from + 1);
  return {.name = "joint_" + suffix,
          .parent = "",
          .child = "link_" + suffix,
          .type = record.signature.types[coupling.joint],
          .X_PJ = Pose{},
          .limits = {lower, upper},
          .mimic = fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"0\"/>\n",
                               markup_text(followed), number_text(coupling.ratio))};
}

// From base_link to the link of the last joint.
std::string joints_text(const SignatureRecord& record, const JointFrames& frames) {
  std::string text;
  const std::vector<std::string> names = joint_names(record);
  std::string parent = "base_link";
  for (std::size_t i = 0; i < record.signature.joint_count(); ++i) {
    Pose X_PJ = frames.X_PJ[i];
    for (const JointCoupling& coupling : record.nominal.couplings) {
      if (coupling.joint != i) continue;
      MovingJoint share = coupled_share(record, coupling, names[coupling.from]);
      share.parent = std::exchange(parent, share.child);
      share.X_PJ = std::exchange(X_PJ, Pose{});
      text += moving(share);
    }
    const std::string child = fmt::format("link_{}", i + 1);
    text += moving({markup_text(names[i]), parent, child, record.signature.types[i], X_PJ,
                    record.nominal.limits[i], ""});
    parent = child;
  }
  return text;
}

}  // namespace

Read<std::string> urdf_text(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  const JointFrames frames = joint_frames(record);
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
      xml_comment(provenance(record) +
                  "last_link is the frame that `armsig predict` answers for, sensor its "
                  "frame of reference.\n"
                  "The signature knows no efforts and speeds: effort and velocity are 0 "
                  "until you set them.\n") +
      "\n" + fmt::format("<robot name=\"{}\">\n", markup_text(record.arm_name)) + link("sensor") +
      fixed("sensor_to_base", "sensor", "base_link", frames.X_SB);
  text += joints_text(record, frames);
  const std::string last = fmt::format("link_{}", signature.joint_count());
  text += fixed("to_last_link", last, "last_link", frames.X_KL);
  for (const Target& target : signature.targets) {
    const Pose X_KS = frames.X_SK[target.link - 1].inverse();
    text +=
        fixed(fmt::format("to_target_{}", target.number), fmt::format("link_{}", target.link),
              fmt::format("target_{}", target.number), {Matrix3::Identity(), X_KS * target.p_S});
  }
  return text + "</robot>\n";
}

}  // namespace armsig::tool
