// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/controller_options.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/programs/program.hpp"

namespace armsig::tool {

Read<Arm> ControllerOptions::nominal_model(const SignatureRecord& record) const {
  if (model.empty()) return record.nominal;
  ARMSIG_TRY(read, read_arm(model));
  if (!std::ranges::equal(types_of(read.arm.joints), record.signature.types)) {
    return std::unexpected(Problem{model, 0, 0,
                                   "its joints are not of the types of the signature's",
                                   "the nominal model of the same arm"});
  }
  return read.arm;
}

Read<Pose> ControllerOptions::base_in_frame_0() const {
  return base.empty() ? Read<Pose>() : parse_frame("--base", base);
}

Read<Pose> ControllerOptions::flange_in_last_frame() const {
  return flange.empty() ? Read<Pose>() : parse_frame("--flange", flange);
}

void add_controller_options(CLI::App& command, ControllerOptions& options) {
  command.add_option("--controller-model", options.model,
                     "nominal model that the controller computes with: a file, or a known arm "
                     "(default: that of the signature)");
  command.add_option("--base", options.base,
                     "the controller's base in frame 0 of its nominal model, written as --tool "
                     "(default: they are one)");
  command.add_option("--flange", options.flange,
                     "the controller's flange in the last frame of its nominal model (default: "
                     "they are one)");
}

}  // namespace armsig::tool
