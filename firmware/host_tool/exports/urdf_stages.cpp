// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/urdf_stages.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

// Takes the joints of a path one by one.
class Stager {
 public:
  explicit Stager(const SignatureRecord& record)
      : record_(record),
        encoders_(readings_for(record.nominal.couplings, record.signature.configuration)) {}

  Read<void> add(const UrdfJoint& joint) {
    if (joint.motion == UrdfMotion::kFixed) {
      Pose& X = open_ ? open_->X_JK : X_before_;
      X = X * joint.X_PJ;
      return {};
    }
    if (!open_) {
      open_.emplace();
      open_->corrected = &joint;
      open_->X_PF = X_before_;
      X_before_ = Pose{};
    } else {
      open_->X_JK = open_->X_JK * joint.X_PJ;
    }
    ARMSIG_TRY(reading, joint.mimic != nullptr ? followed(joint) : read_off(joint));
    open_->X_JK = open_->X_JK * moved_by(joint, reading);
    if (joint.mimic == nullptr) {
      open_->moving = &joint;
      chain_.stages.push_back(*open_);
      names_.push_back(joint.name);
      open_.reset();
      follows_ = false;
    }
    return {};
  }

  Read<StagedChain> done(const XMLElement& robot) {
    if (open_ || chain_.stages.size() != record_.signature.joint_count()) {
      return problem_at(robot,
                        fmt::format("{} joints move, the signature has {}", chain_.stages.size(),
                                    record_.signature.joint_count()),
                        "--base and --tip of the arm that was identified");
    }
    chain_.X_KT = X_before_;
    return chain_;
  }

 private:
  // Of a mimic joint, from the encoder of the joint that it follows.
  Read<double> followed(const UrdfJoint& joint) {
    const auto of = std::ranges::find(names_, attribute(*joint.mimic, "joint"));
    if (of == names_.end()) {
      return problem_at(*joint.mimic,
                        fmt::format("joint {} follows no joint before it", in_quotes(joint.name)),
                        "a mimic of an earlier joint");
    }
    ARMSIG_TRY(ratio, number_attribute(*joint.mimic, "multiplier", 1));
    ARMSIG_TRY(offset, number_attribute(*joint.mimic, "offset", 0));
    follows_ = true;
    return ratio * encoders_[static_cast<std::size_t>(of - names_.begin())] + offset;
  }

  [[nodiscard]] Read<double> read_off(const UrdfJoint& joint) const {
    const std::size_t i = chain_.stages.size();
    if (i == record_.signature.joint_count() || type_of(joint) != record_.signature.types[i]) {
      return problem_at(
          *joint.element,
          i == record_.signature.joint_count()
              ? fmt::format("joint {} is one more than the signature has", in_quotes(joint.name))
              : fmt::format("joint {} is {}, joint {} of the signature {}", in_quotes(joint.name),
                            word_of(type_of(joint)), i + 1, word_of(record_.signature.types[i])),
          "--base and --tip of the arm that was identified");
    }
    return follows_ ? encoders_[i] : record_.signature.configuration[i];
  }

  const SignatureRecord& record_;
  JointVector encoders_;
  StagedChain chain_;
  std::vector<std::string> names_;
  std::optional<Stage> open_;
  Pose X_before_;  // from the link beyond the last stage to where the next joint's origin stands
  bool follows_ = false;
};

}  // namespace

JointType type_of(const UrdfJoint& joint) {
  return joint.motion == UrdfMotion::kSlides ? JointType::kPrismatic : JointType::kRevolute;
}

Read<StagedChain> staged_chain(const std::vector<UrdfJoint>& path, const XMLElement& robot,
                               const SignatureRecord& record) {
  Stager stager(record);
  for (const UrdfJoint& joint : path) {
    if (auto added = stager.add(joint); !added) return std::unexpected(std::move(added).error());
  }
  return stager.done(robot);
}

}  // namespace armsig::tool
