// SPDX-License-Identifier: MIT
// armsig join: a controller's joint log and a tracker's points become measurements.
#include "firmware/host_tool/joining/join.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"

namespace armsig::tool {
namespace {

struct JoinOptions : CommonOptions {
  std::string arm, joints, points, units, out;
  std::string by = "name";
  double within_s = 0.5;
  int target = 1;
};

JoinBy by_of(const std::string& word) {
  if (word == "order") return JoinBy::kOrder;
  return word == "time" ? JoinBy::kTime : JoinBy::kName;
}

Read<Joined> joined_files(const JoinOptions& options, const JointTypes& types) {
  ARMSIG_TRY(units, stated_units(options.units));
  ARMSIG_TRY(poses, read_joint_log(options.joints, types, units));
  ARMSIG_TRY(points, read_tracked_points(options.points, types, units));
  return join(poses, points, by_of(options.by), options.within_s, options.target,
              {options.joints, options.points}, types);
}

Read<void> write_rows(const JoinOptions& options, const Joined& joined, const JointTypes& types) {
  MeasurementLayout layout;
  layout.types = types;
  const std::string comment =
      fmt::format("joined by {} from {} and {}", options.by, options.joints, options.points);
  layout.comment = comment;
  ARMSIG_TRY(writer, MeasurementWriter::create(options.out, layout));
  for (const MeasurementRow& row : joined.rows) writer.write(row);
  return writer.commit();
}

std::string counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// Most points without a pose are no gaps in a log: the files do not belong together as was said.
void warn_of_most_left(const JoinOptions& options, const Joined& joined) {
  if (joined.points_left.size() <= joined.rows.size()) return;
  complain("armsig: warning: {}: {} of {} points go with no pose; {}", options.points,
           joined.points_left.size(), joined.points_left.size() + joined.rows.size(),
           options.by == "time" ? "are both times of one clock, and did the arm stand still for "
                                  "--within-s before and after?"
                                : "are the names those of the poses?");
}

void print_joined(const JoinOptions& options, const Joined& joined,
                  const std::vector<std::size_t>& sweeps) {
  say("{} with {}, by {}\n", counted(joined.rows.size(), "point"),
      joined.rows.size() == 1 ? "its pose" : "their poses", options.by);
  if (!joined.points_left.empty()) {
    say("  {} without a pose, the first in line {} of {}\n",
        counted(joined.points_left.size(), "point"), joined.points_left.front(), options.points);
  }
  if (joined.poses_left > 0) say("  {} without a point\n", counted(joined.poses_left, "pose"));
  std::size_t swept = 0;
  for (std::size_t j = 0; j < sweeps.size(); ++j) {
    swept += sweeps[j];
    if (sweeps[j] > 0) say("  joint {} swept: {} points\n", j + 1, sweeps[j]);
  }
  say("  several joints moved: {} points\n", joined.rows.size() - swept);
  const bool all = std::ranges::all_of(sweeps, [](std::size_t count) { return count > 0; });
  say("\nWritten: {}\nNext: armsig identify --arm {} --measurements {}{} --out signature.yaml\n",
      file_in_words(options.out), options.arm, file_or(options.out, "measurements.csv"),
      all ? "" : " --method refined");
}

int run(const JoinOptions& options) {
  const auto apart = check_roles(
      {{"--arm", options.arm}, {"--joints", options.joints}, {"--points", options.points}},
      {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto arm = read_arm(options.arm);
  if (!arm) return fail(arm.error(), kBadInput, options);
  const JointTypes types = types_of(arm->arm.joints);
  auto joined = joined_files(options, types);
  if (!joined) return fail(joined.error(), kBadInput, options);
  const std::vector<std::size_t> sweeps = find_sweeps(joined->rows, types);
  if (const auto written = write_rows(options, *joined, types); !written) {
    return fail(written.error(), kBadInput, options);
  }
  warn_of_most_left(options, *joined);
  if (options.json) {
    print_json({{"status", 0},
                {"rows", joined->rows.size()},
                {"points_left", joined->points_left},
                {"poses_left", joined->poses_left},
                {"sweep_rows", sweeps},
                {"out", options.out}});
  } else {
    print_joined(options, *joined, sweeps);
  }
  return kDone;
}

}  // namespace

void add_join(CLI::App& app, int& status) {
  auto options = std::make_shared<JoinOptions>();
  CLI::App* command = app.add_subcommand(
      "join", "a controller's joint log and a tracker's points, to measurements");
  command
      ->add_option("--arm", options->arm,
                   "arm description (YAML), or a name that `armsig arms` lists")
      ->required();
  command
      ->add_option("--joints", options->joints,
                   "joint log: a header such as Name;Time;A1 [deg];A2 [deg];...")
      ->required();
  command
      ->add_option(
          "--points", options->points,
          "tracker's points: a header such as Name;X [mm];Y [mm];Z [mm], or SpatialAnalyzer "
          "text (Collection Group Target x y z)")
      ->required();
  command->add_option("--by", options->by, "what a point and its pose have in common")
      ->check(CLI::IsMember({"name", "order", "time"}))
      ->capture_default_str();
  command
      ->add_option("--within-s", options->within_s,
                   "by time: seconds about a point in which the arm stands still")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command->add_option("--units", options->units,
                      "units of columns whose header has none: deg,mm or rad,m");
  command->add_option("--target", options->target, "number of the target, where the log has none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--out", options->out, "measurements to write (CSV)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
