// SPDX-License-Identifier: MIT
// armsig predict: forward kinematics of a signature.
#include <fmt/core.h>

#include "core/kinematics/s_model_chain.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/formats/poses.hpp"
#include "firmware/host_tool/formats/signature_file.hpp"
#include "firmware/host_tool/model.hpp"

namespace armsig::tool {
namespace {

struct Options : CommonOptions {
  std::string signature, joints, out;
  std::optional<int> target;
};

// The point asked for, with the orientation of the link that it is on.
Pose predicted(const Signature& signature, const JointVector& q,
               const std::optional<Target>& target) {
  if (!target) return kinematics::link_pose(signature, q, signature.joint_count());
  return {kinematics::link_pose(signature, q, target->link).R,
          kinematics::target_position(signature, q, *target)};
}

int run(const Options& options) {
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const Signature& signature = record->signature;
  const auto target = find_target(*record, options.signature, options.target);
  if (!target) return fail(target.error(), kBadInput, options);
  const auto joints = read_joint_poses(options.joints, signature.types);
  if (!joints) return fail(joints.error(), kBadInput, options);

  std::vector<Pose> poses;
  poses.reserve(joints->size());
  for (const JointVector& q : *joints) {
    poses.push_back(predicted(signature, effective_readings(record->nominal, q), *target));
  }
  const std::string what =
      *target ? fmt::format("target {}", (*target)->number) : std::string("the last link's frame");
  const auto written =
      write_tool_poses(options.out, poses,
                       fmt::format("{}: poses of {} in the sensor frame", record->arm_name, what));
  if (!written) return fail(written.error(), kBadInput, options);
  if (options.json) {
    print_json({{"status", 0}, {"poses", poses.size()}, {"of", what}, {"out", options.out}});
  } else {
    fmt::print("{} poses of {} in {}\n", poses.size(), what, options.out);
  }
  return kDone;
}

}  // namespace

void add_predict(CLI::App& app, int& status) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("predict", "where joint readings put the arm: forward kinematics");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  command->add_option("--joints", options->joints, "joint readings (CSV: q1_deg, ...)")->required();
  command->add_option("--target", options->target,
                      "number of a target point (default: the last link's frame)");
  command->add_option("--out", options->out, "poses to write (CSV)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
