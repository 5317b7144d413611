// SPDX-License-Identifier: MIT
// armsig predict: forward kinematics of a signature.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/kinematics/s_model_chain.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/beyond_limits.hpp"
#include "firmware/library/estimate.hpp"
#include "firmware/library/signature_chain.hpp"

namespace armsig::tool {
namespace {

struct PredictOptions : CommonOptions {
  std::string signature, joints, out;
  std::optional<int> target;
  bool sigma = false;
};

// The point asked for, with the orientation of the link that it is on.
Pose predicted(const Signature& signature, const JointVector& q,
               const std::optional<Target>& target) {
  if (!target) return kinematics::link_pose(signature, q, signature.joint_count());
  return {kinematics::link_pose(signature, q, target->link).R,
          kinematics::target_position(signature, q, *target)};
}

// 1 sigma along x, y, z of a target's position at each of the readings.
Read<std::vector<Vector3>> sigmas_of(const SignatureRecord& record, const std::string& file,
                                     const Target& target, const std::vector<JointVector>& joints) {
  const auto estimate = estimate_of(record, file);
  if (!estimate) return std::unexpected(estimate.error());
  std::size_t index = 0;
  while (record.signature.targets[index].number != target.number) ++index;
  std::vector<Vector3> sigmas_m;
  sigmas_m.reserve(joints.size());
  for (const JointVector& q : joints) {
    const Matrix3 covariance = uncertainty::tool_covariance(**estimate, q, index);
    sigmas_m.emplace_back(covariance.diagonal().cwiseSqrt());
  }
  return sigmas_m;
}

// Uncertain is a measured point: a sigma without --target is that of the only one on the last link.
Read<std::optional<Target>> target_for(const PredictOptions& options,
                                       const SignatureRecord& record) {
  if (options.target || !options.sigma) {
    return find_target(record, options.signature, options.target);
  }
  const Target* tool = nullptr;
  int tools = 0;
  std::vector<std::string> numbers;
  for (const Target& target : record.signature.targets) {
    numbers.push_back(std::to_string(target.number));
    if (target.link != record.signature.joint_count()) continue;
    tool = &target;
    ++tools;
  }
  if (tools == 1) return *tool;
  return std::unexpected(
      Problem{options.signature, 0, 0, "--sigma does not say of which target",
              numbers.empty() ? "a signature with targets" : "--target with " + any_of(numbers)});
}

std::string in_words(const BeyondLimits& beyond, std::size_t rows) {
  return fmt::format("{} of {} rows {} beyond the joint limits, farthest row {}: {}", beyond.rows,
                     rows, beyond.rows == 1 ? "is" : "are", beyond.worst + 1, beyond.words);
}

struct Prediction {
  std::string of;  // what the poses are of
  std::vector<Pose> poses;
  std::vector<Vector3> sigmas_m;  // with --sigma
};

Read<Prediction> prediction(const PredictOptions& options, const SignatureRecord& record,
                            const std::optional<Target>& target,
                            const std::vector<JointVector>& joints) {
  Prediction found;
  found.of = target ? fmt::format("target {}", target->number) : "the last link's frame";
  const Signature& signature = record.signature;
  const calibration::ReadingModel readings = record.readings();
  for (const JointVector& q : joints) {
    found.poses.push_back(predicted(
        signature, calibration::true_readings(readings, signature.configuration, q), target));
  }
  if (options.sigma) {
    ARMSIG_TRY(sigmas_m, sigmas_of(record, options.signature, *target, joints));
    found.sigmas_m = std::move(sigmas_m);
  }
  return found;
}

nlohmann::ordered_json json_of(const PredictOptions& options, const Prediction& found,
                               const std::vector<std::string>& warnings) {
  nlohmann::ordered_json json{{"status", 0},
                              {"poses", found.poses.size()},
                              {"of", found.of},
                              {"warnings", warnings},
                              {"out", options.out}};
  if (options.sigma) json["rms_sigma_m"] = rms_length(found.sigmas_m);
  return json;
}

void print_prediction(const PredictOptions& options, const Prediction& found,
                      const std::optional<Target>& target) {
  say("{} of {} {}\n", counted(found.poses.size(), "pose"), found.of, place_in_words(options.out));
  if (options.sigma) {
    say("predicted error, 1 sigma: {:.3f} mm RMS\n", 1e3 * rms_length(found.sigmas_m));
  }
  if (!is_there_to_read(options.out)) return;
  say_next(TypedCommand("solve")
               .file_option("--signature", options.signature)
               .file_option("--poses", options.out)
               .option("--target", target ? std::to_string(target->number) : "")
               .option("--out", "readings.csv"));
}

Attempt<ExitStatus> run(const PredictOptions& options) {
  if (auto apart = check_roles({{"--signature", options.signature}, {"--joints", options.joints}},
                               {{"--out", options.out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(target, target_for(options, record));
  ARMSIG_TRY(joints, read_joint_poses(options.joints, record.signature.types));
  const auto beyond = beyond_limits(record.nominal, joints);
  if (beyond && beyond->out_of_question) {
    return no_answer(
        {options.joints, 0, 0, in_words(*beyond, joints.size()),
         "readings in the unit that the column's name says; whole turns taken off a joint "
         "that turns without an end"});
  }
  ARMSIG_TRY(found, prediction(options, record, target, joints));
  const std::string title =
      fmt::format("{}: poses of {} in the sensor frame", record.arm_name, found.of);
  if (auto written = write_tool_poses(options.out, found.poses, title, found.sigmas_m); !written) {
    return std::unexpected(std::move(written).error());
  }
  std::vector<std::string> warnings;
  if (beyond) {
    warnings.push_back(in_words(*beyond, joints.size()) + "; nothing was measured there");
    complain("armsig: warning: {}: {}", options.joints, warnings.back());
  }
  if (options.json) {
    print_json(json_of(options, found, warnings));
  } else {
    print_prediction(options, found, target);
  }
  return kDone;
}

}  // namespace

void add_predict(CLI::App& app, int& status) {
  auto options = std::make_shared<PredictOptions>();
  CLI::App* command =
      app.add_subcommand("predict", "where joint readings put the arm: forward kinematics");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  command->add_option("--joints", options->joints, "joint readings (CSV: q1_deg, ...)")->required();
  command->add_option("--target", options->target,
                      "number of a target point (default: the last link's frame)");
  command->add_flag("--sigma", options->sigma,
                    "add the predicted error of each position, 1 sigma: sigma_x_m, sigma_y_m, "
                    "sigma_z_m, and sigma_m of all three (of the only target on the last link, "
                    "where --target names none)");
  command->add_option("-o,--out", options->out, "poses to write (CSV)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
