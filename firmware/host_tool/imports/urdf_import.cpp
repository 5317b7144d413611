// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/imports/import.hpp"
#include "firmware/host_tool/imports/urdf_limits.hpp"
#include "firmware/host_tool/imports/urdf_tree.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

constexpr double kSameAxis = 1e-9;  // metres and radians
constexpr std::string_view kExpandFirst = "xacro FILE -o arm.urdf first";

std::string called(const UrdfJoint& joint) { return "joint " + in_quotes(joint.name); }

// A joint that follows another by mimic, waiting for the joint about the same axis.
struct Follower {
  UrdfJoint joint;
  ChainAxis axis;
  std::string of;
  double ratio = 0;
};

class ChainReader {
 public:
  ChainReader(const XMLElement& robot, std::string base, std::string tip)
      : robot_(robot), base_(std::move(base)), tip_(std::move(tip)) {}

  Read<ImportedArm> read() {
    if (auto named = check_urdf_name(robot_, "the robot"); !named) {
      return std::unexpected(std::move(named).error());
    }
    ARMSIG_TRY(path, urdf_path(robot_, base_, tip_));
    for (const UrdfJoint& joint : path) {
      if (auto added = add(joint); !added) return std::unexpected(std::move(added).error());
    }
    if (!followers_.empty()) {
      return problem_at(
          *followers_[0].joint.element,
          called(followers_[0].joint) + " mimics another joint by itself",
          "a mimic joint only where the next joint turns about the same axis: a coupling");
    }
    if (chain_.axes.empty()) {
      return problem_at(
          robot_,
          fmt::format("no joint moves between {} and {}", in_quotes(base_), in_quotes(tip_)),
          "links with moving joints between them");
    }
    chain_.X_BT = X_BK_;
    // The base link has its z axis up (REP 103).
    const std::string name = attribute(robot_, "name");
    ImportedArm imported =
        described(chain_, name.empty() ? "imported arm" : name, std::move(names_));
    if (!without_limits_.empty()) {
      imported.notes.push_back("the limits of " + all_of(without_limits_) +
                               " are so far away that they mean none: limits: none");
    }
    return imported;
  }

 private:
  Read<void> add(const UrdfJoint& joint) {
    X_BK_ = X_BK_ * joint.X_PJ;
    if (joint.motion == UrdfMotion::kFixed) return {};
    ChainAxis axis;
    axis.type = joint.motion == UrdfMotion::kSlides ? JointType::kPrismatic : JointType::kRevolute;
    axis.direction_B = X_BK_.R * joint.axis_J;
    axis.point_B = X_BK_.p;
    if (joint.mimic != nullptr) return add_follower(joint, axis);
    ARMSIG_TRY(limits, urdf_limits(joint));
    axis.limits = limits.limits;
    if (limits.beyond_counting) without_limits_.push_back(in_quotes(joint.name));
    if (chain_.axes.size() == kMaxJoints) {
      return problem_at(*joint.element, fmt::format("more than {} moving joints", kMaxJoints),
                        fmt::format("at most {} between base and tip", kMaxJoints));
    }
    if (joint.name.empty()) return problem_at(*joint.element, "a joint without a name", "a name");
    if (std::ranges::find(names_, joint.name) != names_.end()) {
      return problem_at(*joint.element, "two joints are called " + in_quotes(joint.name),
                        "a name of its own for each");
    }
    chain_.axes.push_back(axis);
    names_.push_back(joint.name);
    return couple(axis);
  }

  Read<void> add_follower(const UrdfJoint& joint, const ChainAxis& axis) {
    ARMSIG_TRY(ratio, number_attribute(*joint.mimic, "multiplier", 1));
    ARMSIG_TRY(offset, number_attribute(*joint.mimic, "offset", 0));
    // What a follower is beside its share stays where it is, as a fixed joint would.
    X_BK_ = X_BK_ * moved_by(joint, offset);
    if (ratio == 0) return {};
    followers_.push_back({joint, axis, attribute(*joint.mimic, "joint"), ratio});
    return {};
  }

  // Joint `axis` has just been added: the followers before it must turn about its axis.
  Read<void> couple(const ChainAxis& axis) {
    for (const Follower& follower : followers_) {
      const double turned = follower.axis.direction_B.cross(axis.direction_B).norm();
      const double apart = axis.direction_B.cross(follower.axis.point_B - axis.point_B).norm();
      const auto from = std::ranges::find(names_, follower.of);
      if (turned > kSameAxis || apart > kSameAxis || from == names_.end() ||
          from + 1 == names_.end()) {
        return problem_at(
            *follower.joint.element,
            called(follower.joint) + " mimics a joint and is no coupling of the next one",
            "a mimic of an earlier joint about the axis of the joint after it");
      }
      if (auto one = check_follower(follower, axis.type, from - names_.begin()); !one) return one;
      const double sense = follower.axis.direction_B.dot(axis.direction_B) > 0 ? 1 : -1;
      chain_.couplings.push_back({chain_.axes.size() - 1,
                                  static_cast<std::size_t>(from - names_.begin()),
                                  sense * follower.ratio});
    }
    followers_.clear();
    return {};
  }

  // That the joints turn, or slide, both, and that no other follows the same one here.
  [[nodiscard]] Read<void> check_follower(const Follower& follower, JointType type,
                                          std::ptrdiff_t from) const {
    const auto of = static_cast<std::size_t>(from);
    if (follower.axis.type != type || chain_.axes[of].type != type) {
      return problem_at(*follower.joint.element,
                        called(follower.joint) +
                            " is revolute and the joint that it follows is prismatic, or the "
                            "other way",
                        "a mimic joint of the type of both joints that it is between");
    }
    for (const JointCoupling& coupling : chain_.couplings) {
      if (coupling.joint + 1 != chain_.axes.size() || coupling.from != of) continue;
      return problem_at(*follower.joint.element,
                        called(follower.joint) + " mimics what the joint before it does",
                        "one mimic joint with the sum of both multipliers");
    }
    return {};
  }

  const XMLElement& robot_;
  std::string base_, tip_;
  Pose X_BK_;  // the link reached, at readings zero
  AxisChain chain_;
  std::vector<std::string> names_;
  std::vector<std::string> without_limits_;
  std::vector<Follower> followers_;
};

}  // namespace

Read<ImportedArm> import_urdf(const std::string& path, const std::string& base,
                              const std::string& tip) {
  ARMSIG_TRY(text, read_text_file(path, kLargestUrdf));
  const auto parse = [&]() -> Read<ImportedArm> {
    tinyxml2::XMLDocument document;
    ARMSIG_TRY(robot, parse_urdf(text, document));
    if (auto expanded = refuse_xacro(*robot, std::string(kExpandFirst)); !expanded) {
      return std::unexpected(std::move(expanded).error());
    }
    return ChainReader(*robot, base, tip).read();
  };
  return in_file(path, parse());
}

}  // namespace armsig::tool
