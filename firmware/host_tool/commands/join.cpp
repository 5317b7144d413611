// SPDX-License-Identifier: MIT
// armsig join: a controller's joint log and a tracker's points become measurements.
#include "firmware/host_tool/joining/join.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/joining/implausible_positions.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/beyond_limits.hpp"

namespace armsig::tool {
namespace {

struct JoinOptions : CommonOptions {
  std::string arm, joints, points, units, out;
  std::string joint_columns = "auto";
  std::string point_columns = "auto";
  JoinSettings settings;
  std::string by = "name";
  std::string dates;
};

JoinBy by_of(const std::string& word) {
  if (word == "order") return JoinBy::kOrder;
  if (word == "standstill") return JoinBy::kStandstill;
  return word == "time" ? JoinBy::kTime : JoinBy::kName;
}

DateOrder dates_of(const std::string& word) {
  if (word.empty()) return DateOrder::kUnknown;
  return word == "day-first" ? DateOrder::kDayFirst : DateOrder::kMonthFirst;
}

// What the files hold, and what was made of them.
struct JoinedFiles {
  Joined joined;
  std::string unused_joints, unused_points;  // columns, in words
};

// Readings that no arm has, or lengths that are not in the unit said, are not what was measured.
Read<void> check_gross(const JoinOptions& options, const Arm& arm, const JointLog& log,
                       const Joined& joined) {
  ImpossibleRows impossible;
  for (const LoggedPose& pose : log.poses) {
    auto reading = impossible_reading(arm, pose.q);
    if (!reading) continue;
    impossible.add({options.joints, static_cast<int>(pose.line), 0, std::move(reading->words), ""});
  }
  if (impossible.rows > 0) {
    return std::unexpected(impossible.problem(log.poses.size(), "the header or --units"));
  }
  if (const auto wrong = implausible_positions(arm, joined.rows)) {
    return std::unexpected(Problem{options.points, 0, 0, *wrong,
                                   "positions in the unit that the header or --units says"});
  }
  return {};
}

Read<JoinedFiles> joined_files(const JoinOptions& options, const ArmDescription& arm) {
  const NamedJoints joints(types_of(arm.arm.joints), arm.joint_names);
  ARMSIG_TRY(units, stated_units(options.units));
  ARMSIG_TRY(log, read_joint_log(options.joints, joints, units, options.joint_columns));
  ARMSIG_TRY(tracked, read_tracked_points(options.points, units, options.point_columns));
  JoinSettings settings = options.settings;
  settings.by = by_of(options.by);
  settings.dates = dates_of(options.dates);
  ARMSIG_TRY(joined, join(log, tracked, settings, joints.types));
  if (auto good = check_gross(options, arm.arm, log, joined); !good) {
    return std::unexpected(std::move(good).error());
  }
  return JoinedFiles{std::move(joined), log.unused, tracked.unused};
}

Read<void> write_rows(const JoinOptions& options, const Joined& joined, const JointTypes& types) {
  MeasurementLayout layout;
  layout.types = types;
  layout.air = std::ranges::any_of(joined.rows, [](const auto& row) { return bool(row.air_c); });
  layout.sigma =
      std::ranges::any_of(joined.rows, [](const auto& row) { return bool(row.sigma_m); });
  const std::string comment =
      fmt::format("joined by {} from {} and {}", options.by, options.joints, options.points);
  layout.comment = comment;
  ARMSIG_TRY(writer, MeasurementWriter::create(options.out, layout));
  for (const MeasurementRow& row : joined.rows) writer.write(row);
  return writer.commit();
}

// Most points without a pose are no gaps in a log: the files do not belong together as was said.
void warn(const JoinOptions& options, const Joined& joined) {
  if (!joined.clock_doubt.empty()) {
    complain("armsig: warning: {}: {}", options.points, joined.clock_doubt);
  }
  if (joined.points_left.size() <= joined.rows.size()) return;
  complain("armsig: warning: {}: {} of {} points go with no pose; {}", options.points,
           joined.points_left.size(), joined.points_left.size() + joined.rows.size(),
           options.by == "time" ? "are both times of one clock, and did the arm stand still for "
                                  "--within-s before and after?"
                                : "are the names those of the poses?");
}

void print_left(const JoinOptions& options, const JoinedFiles& files) {
  const Joined& joined = files.joined;
  if (options.by == "standstill") {
    say("{}, each the mean of its points: {} of them\n", counted(joined.rows.size(), "standstill"),
        joined.averaged);
    if (joined.moving > 0) {
      say("  {} left out, whose points moved\n", counted(joined.moving, "standstill"));
    }
    if (joined.poses_left > 0) {
      say("  {} without a point\n", counted(joined.poses_left, "standstill"));
    }
  } else {
    say("{} with {}, by {}\n", counted(joined.rows.size(), "point"),
        joined.rows.size() == 1 ? "its pose" : "their poses", options.by);
    if (!joined.points_left.empty()) {
      say("  {} without a pose, the first in line {} of {}\n",
          counted(joined.points_left.size(), "point"), joined.points_left.front(), options.points);
    }
    if (joined.poses_left > 0) say("  {} without a point\n", counted(joined.poses_left, "pose"));
  }
  if (!files.unused_joints.empty()) say("  {}: {}\n", options.joints, files.unused_joints);
  if (!files.unused_points.empty()) say("  {}: {}\n", options.points, files.unused_points);
}

void print_joined(const JoinOptions& options, const JoinedFiles& files,
                  const std::vector<std::size_t>& sweeps) {
  const Joined& joined = files.joined;
  print_left(options, files);
  std::size_t swept = 0;
  for (std::size_t j = 0; j < sweeps.size(); ++j) {
    swept += sweeps[j];
    if (sweeps[j] > 0) say("  joint {} swept: {}\n", j + 1, counted(sweeps[j], "point"));
  }
  say("  several joints moved: {}\n", counted(joined.rows.size() - swept, "point"));
  const bool all = std::ranges::all_of(sweeps, [](std::size_t count) { return count > 0; });
  say("\nWritten: {}\n", file_in_words(options.out));
  if (!is_there_to_read(options.out)) return;
  say_next(TypedCommand("identify")
               .file_option("--arm", options.arm)
               .file_option("--measurements", options.out)
               .option("--method", all ? "" : "refined")
               .option("--out", "signature.yaml"));
}

int run(const JoinOptions& options) {
  const auto apart = check_roles(
      {{"--arm", options.arm}, {"--joints", options.joints}, {"--points", options.points}},
      {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto arm = read_arm(options.arm);
  if (!arm) return fail(arm.error(), kBadInput, options);
  const JointTypes types = types_of(arm->arm.joints);
  auto files = joined_files(options, *arm);
  if (!files) return fail(files.error(), kBadInput, options);
  Joined& joined = files->joined;
  const std::vector<std::size_t> sweeps = find_sweeps(joined.rows, types);
  if (const auto written = write_rows(options, joined, types); !written) {
    return fail(written.error(), kBadInput, options);
  }
  warn(options, joined);
  if (options.json) {
    print_json(
        {{"status", 0},
         {"rows", joined.rows.size()},
         {"points_left", joined.points_left},
         {"poses_left", joined.poses_left},
         {"sweep_rows", sweeps},
         {"unused_joint_columns", files->unused_joints},
         {"unused_point_columns", files->unused_points},
         {"warnings", joined.clock_doubt.empty() ? nlohmann::ordered_json::array()
                                                 : nlohmann::ordered_json{joined.clock_doubt}},
         {"out", options.out}});
  } else {
    print_joined(options, *files, sweeps);
  }
  return kDone;
}

// How the files are to be read where they do not say it themselves.
void add_reading_options(CLI::App& command, JoinOptions& options) {
  command
      .add_option(
          "--joint-columns", options.joint_columns,
          "which column of the joint log is which: auto, or q1_deg=THEIR NAME,q2_deg=@3,... "
          "(@3: the third column)")
      ->capture_default_str();
  command
      .add_option("--point-columns", options.point_columns,
                  "the same of the points: auto, or name=@1,x_mm=@4,...")
      ->capture_default_str();
  command
      .add_option("--reflectors", options.settings.reflectors,
                  "so many are measured at each pose, always in one order; numbered from --target")
      ->check(CLI::Range(1, 32))
      ->capture_default_str();
  command
      .add_option("--dates", options.dates, "of dates such as 3/4/2026: which number is the day")
      ->transform(CLI::IsMember({"day-first", "month-first"}, CLI::ignore_case));
  command.add_option("--clock-offset-s", options.settings.clock_offset_s,
                     "seconds to add to the times of the points, where two clocks differ");
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
      ->transform(CLI::IsMember({"name", "order", "time", "standstill"}, CLI::ignore_case))
      ->capture_default_str();
  command
      ->add_option("--within-s", options->settings.within_s,
                   "by time: seconds about a point in which the arm stands still; by standstill: "
                   "left out at its begin and end")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command->add_option("--units", options->units,
                      "units of columns whose header has none: deg,mm or rad,m");
  add_reading_options(*command, *options);
  command
      ->add_option("--target", options->settings.target,
                   "number of the target, where the log has none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("-o,--out", options->out, "measurements to write (CSV)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
