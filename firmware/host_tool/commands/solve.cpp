// SPDX-License-Identifier: MIT
// armsig solve: inverse kinematics of a signature.
#include <algorithm>

#include <fmt/core.h>

#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/seeds.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/library/encoder_arm.hpp"
#include "firmware/library/signature_chain.hpp"

namespace armsig::tool {
namespace {

struct SolveOptions : CommonOptions {
  std::string signature, poses, seed, out;
  std::optional<int> target;
};

const char* verdict_word(kinematics::Verdict verdict) {
  switch (verdict) {
    case kinematics::Verdict::kConverged:
      return "solved";
    case kinematics::Verdict::kDegraded:
      return "solved, near a singularity";
    case kinematics::Verdict::kOutOfReach:
      return "out of reach";
    case kinematics::Verdict::kJointLimit:
      return "a joint limit is in the way";
    case kinematics::Verdict::kStepLimit:
    case kinematics::Verdict::kNotConverged:
      return "not converged";
  }
  return "not converged";
}

constexpr double kRotationMissed = 1e-8;  // rad; above what rounding leaves of a pose that is met

// The arm of the signature, of the point asked for in the sensor frame.
EncoderArm arm_of(const SignatureRecord& record, const std::optional<Target>& target) {
  const kinematics::Chain chain = chain_of_record(record);
  return EncoderArm({.chain = chain,
                     .readings = record.readings(),
                     .configuration = record.signature.configuration,
                     .limits = record.nominal.limits,
                     .X_B0 = record.signature.X_SL[0],
                     .X_nF = point_in_last_frame(record, chain, target)});
}

Result<FoundReadings> solved(const EncoderArm& arm, const Pose& X_SP, const JointVector* seed) {
  FoundReadings nearest;
  if (seed != nullptr) {
    ARMSIG_TRY(near, arm.inverse(X_SP, *seed));
    if (is_solved(near.verdict)) return near;
    nearest = near;
  }
  // Where no way leads from the seed, the solution nearest to it.
  ARMSIG_TRY(all, arm.solutions(X_SP, seed != nullptr ? *seed : JointVector()));
  for (const FoundReadings& found : all) {
    if (is_solved(found.verdict)) return found;
    if (nearest.readings.empty()) nearest = found;
  }
  return nearest;
}

// Poses can be those of a target that the last link carries.
Read<std::optional<Target>> target_for(const SolveOptions& options, const SignatureRecord& record) {
  ARMSIG_TRY(target, find_target(record, options.signature, options.target));
  const std::size_t joints = record.signature.joint_count();
  if (target && target->link != joints) {
    return std::unexpected(
        Problem{options.signature, 0, 0,
                fmt::format("target {} is on link {}", target->number, target->link),
                fmt::format("a target on the last link, {}", joints)});
  }
  return target;
}

// One for all of the `poses`, or one for each.
Attempt<std::vector<JointVector>> seeds_for(const SolveOptions& options,
                                            const SignatureRecord& record, std::size_t poses) {
  ARMSIG_TRY(seeds, read_seeds(options.seed, record));
  if (!options.seed.empty() && seeds.size() != 1 && seeds.size() != poses) {
    return std::unexpected(Problem{options.seed, 0, 0, fmt::format("{} seeds", seeds.size()),
                                   fmt::format("one, or one for each of the {} poses", poses)});
  }
  return seeds;
}

struct Solutions {
  std::vector<JointVector> readings;
  double rotation_error_rad = 0;  // the largest
};

Attempt<Solutions> solutions_of(const SolveOptions& options, const EncoderArm& arm,
                                const std::vector<Pose>& poses,
                                const std::vector<JointVector>& seeds) {
  Solutions found;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const JointVector* seed = seeds.empty() ? nullptr : &seeds[std::min(k, seeds.size() - 1)];
    const auto solution = solved(arm, poses[k], seed);
    if (!solution || !is_solved(solution->verdict)) {
      const std::string why(solution ? verdict_word(solution->verdict)
                                     : describe(solution.error()));
      return no_answer({options.poses, 0, 0, fmt::format("pose {}: {}", k + 1, why),
                        "poses that the arm reaches within its joint limits"});
    }
    found.readings.push_back(solution->readings);
    found.rotation_error_rad = std::max(found.rotation_error_rad, solution->rotation_error_rad);
  }
  return found;
}

void print_solutions(const SolveOptions& options, const Solutions& found) {
  if (options.json) {
    print_json({{"status", 0},
                {"poses", found.readings.size()},
                {"largest_rotation_error_rad", found.rotation_error_rad},
                {"out", options.out}});
    return;
  }
  say("{} solved; joint readings {}\n", counted(found.readings.size(), "pose"),
      place_in_words(options.out));
  if (found.rotation_error_rad > kRotationMissed) {
    say("positions are met, orientations missed by up to {:.3g}°: an arm with fewer than six "
        "joints can't choose all of an orientation\n",
        degrees(found.rotation_error_rad));
  }
  say("Next: send the arm to them\n");
}

Attempt<ExitStatus> run(const SolveOptions& options) {
  if (auto apart = check_roles({{"--signature", options.signature},
                                {"--poses", options.poses},
                                {"--seed", options.seed}},
                               {{"--out", options.out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(target, target_for(options, record));
  ARMSIG_TRY(poses, read_tool_poses(options.poses));
  ARMSIG_TRY(seeds, seeds_for(options, record, poses.size()));
  ARMSIG_TRY(found, solutions_of(options, arm_of(record, target), poses, seeds));
  const std::string title =
      fmt::format("{}: joint readings for the poses of {}", record.arm_name, options.poses);
  if (auto written = write_joint_poses(options.out, record.signature.types, found.readings, title);
      !written) {
    return std::unexpected(std::move(written).error());
  }
  print_solutions(options, found);
  return kDone;
}

}  // namespace

void add_solve(CLI::App& app, int& status) {
  auto options = std::make_shared<SolveOptions>();
  CLI::App* command =
      app.add_subcommand("solve", "which joint readings reach a pose: inverse kinematics");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  command->add_option("--poses", options->poses, "tool poses (CSV: x_m, ..., qw, ...)")->required();
  command->add_option("--seed", options->seed,
                      "joint readings to start from (CSV): one row, or one a pose; the solution "
                      "nearest to them is taken, without them that nearest to the middle of the "
                      "limits");
  command->add_option("--target", options->target,
                      "the poses are those of this target (default: the last link's frame)");
  command->add_option("-o,--out", options->out, "joint readings to write (CSV)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
