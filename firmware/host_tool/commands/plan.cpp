// SPDX-License-Identifier: MIT
// armsig plan: where to send the arm for its sweeps, or what to touch, before there is a signature.
#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/commands/plan_places.hpp"
#include "firmware/host_tool/commands/pose_options.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/simulation/clear_sweeps.hpp"
#include "firmware/host_tool/simulation/configuration_search.hpp"

namespace armsig::tool {
namespace {

struct PlanOptions : PoseOptions {
  std::string arm;
  std::vector<double> configuration, target_mm{0, 0, 0};
  std::vector<double> arcs_deg{180};  // one for all joints, or one each
  std::size_t points = 24;
  PlacePlanOptions places;  // with an instrument: touches instead of sweeps
};

// As asked for, else as the arm description says, else the one that is found best.
Read<JointVector> configuration_of(const PlanOptions& options, const ArmDescription& described,
                                   const clearance::Surroundings& around) {
  const Arm& arm = described.arm;
  if (options.configuration.empty()) {
    if (!described.sweep_at.empty()) return described.sweep_at;
    JointVector chosen = chosen_configuration(arm, around);
    if (!chosen.empty()) return chosen;
    return std::unexpected(Problem{options.arm, 0, 0,
                                   "no configuration was found in which the arm is clear",
                                   "--configuration, a larger box, or, in the arm description, "
                                   "where its floor is and how thick its links are"});
  }
  if (options.configuration.size() != arm.joints.size()) {
    return std::unexpected(Problem{"--configuration", 0, 0,
                                   fmt::format("{} readings", options.configuration.size()),
                                   fmt::format("{}, one a joint", arm.joints.size())});
  }
  JointVector configuration;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const double value = options.configuration[j];
    const double reading =
        arm.joints[j].type == JointType::kRevolute ? radians(value) : 1e-3 * value;
    if (!(reading >= arm.limits[j].lower && reading <= arm.limits[j].upper)) {
      return std::unexpected(Problem{
          "--configuration", 0, 0,
          fmt::format("joint {} at {}", j + 1, reading_in_words(arm.joints[j].type, reading)),
          fmt::format("{} to {}, its limits less the margin",
                      reading_in_words(arm.joints[j].type, arm.limits[j].lower),
                      reading_in_words(arm.joints[j].type, arm.limits[j].upper))});
    }
    configuration.push_back(reading);
  }
  return configuration;
}

Read<JointVector> arcs_of(const PlanOptions& options, const Arm& arm) {
  const std::size_t told = options.arcs_deg.size();
  if (told != 1 && told != arm.joints.size()) {
    return std::unexpected(Problem{"--arc", 0, 0, fmt::format("{} arcs", told),
                                   fmt::format("one, or {}, one a joint", arm.joints.size())});
  }
  JointVector arcs_rad;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    arcs_rad.push_back(radians(options.arcs_deg[told == 1 ? 0 : j]));
  }
  return arcs_rad;
}

// The poses in the order in which the arm goes through them, each sweep from the configuration.
std::vector<JointVector> poses_of(const SweepPlan& plan) {
  std::vector<JointVector> poses;
  for (std::size_t j = 0; j < plan.sweeps.size(); ++j) {
    for (std::size_t k = 0; k < plan.sweeps[j].points; ++k) {
      JointVector q = plan.configuration;
      q[j] = plan.sweeps[j].reading(k);
      poses.push_back(q);
    }
  }
  return poses;
}

nlohmann::ordered_json json_of(const SweepPlan& plan) {
  auto sweeps = nlohmann::ordered_json::array();
  for (const SweepOfJoint& sweep : plan.sweeps) {
    sweeps.push_back({{"first", sweep.first}, {"last", sweep.last()}, {"points", sweep.points}});
  }
  return sweeps;
}

// The arm as drawn, its limits less the margin.
Read<ArmDescription> arm_with_margin(const PlanOptions& options) {
  ARMSIG_TRY(read, read_arm(options.arm));
  ARMSIG_TRY(limits,
             limits_with_margin(read.arm.limits, types_of(read.arm.joints), options.margin()));
  read.arm.limits = limits;
  return read;
}

void print_plan(const PlanOptions& options, const ArmDescription& arm, const SweepPlan& plan,
                const clearance::Surroundings& around, std::size_t poses) {
  const JointTypes types = types_of(arm.arm.joints);
  Table table({"Joint", "held at", "swept from", "to", "Points"});
  for (std::size_t j = 0; j < types.size(); ++j) {
    const SweepOfJoint& sweep = plan.sweeps[j];
    table.add_row({fmt::format("{}", j + 1), reading_in_words(types[j], plan.configuration[j]),
                   reading_in_words(types[j], sweep.first),
                   reading_in_words(types[j], sweep.last()), fmt::format("{}", sweep.points)});
  }
  say("{}: sweeps to measure\n\n{}\n{}\n", arm.name, table.render(),
      paragraph(fmt::format("{} poses; the arm needs about {} and the sensor its own time.", poses,
                            duration_in_words(duration_s(arm.arm, plan, {})))));
  say("{}\n", paragraph(fmt::format("Every pose and the way to it keep the joint limits, and: {}. "
                                    "Look where they go first: nothing else is known of what "
                                    "stands around.",
                                    surroundings_in_words(around))));
  say("Written: {}\n\n{}", file_in_words(options.out),
      paragraph(
          "Measure at each, and write what you measure to measurements.csv; of a joint log and "
          "a tracker's points armsig join makes it.",
          0));
  say_next(TypedCommand("identify")
               .file_option("--arm", options.arm)
               .option("--measurements", "measurements.csv")
               .option("--out", "signature.yaml"));
}

Attempt<ExitStatus> plan_of_sweeps(const PlanOptions& options, const ArmDescription& arm) {
  if (auto apart = check_roles({{"--arm", options.arm}}, {{"--out", options.out}}); !apart) {
    return std::unexpected(std::move(apart).error());
  }
  const clearance::Surroundings around = options.around(
      arm.arm, arm.mounting,
      1e-3 * Vector3(options.target_mm[0], options.target_mm[1], options.target_mm[2]).norm());
  ARMSIG_TRY(arcs_rad, arcs_of(options, arm.arm));
  ARMSIG_TRY(configuration, configuration_of(options, arm, around));
  const auto plan = clear_sweeps(arm.arm, around, configuration, arcs_rad, options.points);
  if (!plan) return no_answer(plan.error());
  const std::vector<JointVector> poses = poses_of(*plan);
  const std::vector<Stop> route = route_by_home(arm.arm, around, configuration, poses);
  const std::string title = fmt::format("{}: sweeps to measure, a joint after the other", arm.name);
  if (auto written =
          write_route(options.out, options.program(title, around), types_of(arm.arm.joints), route);
      !written) {
    return std::unexpected(std::move(written).error());
  }
  if (options.json) {
    print_json({{"status", 0},
                {"arm", arm.name},
                {"poses", poses.size()},
                {"configuration", std::vector<double>(configuration.begin(), configuration.end())},
                {"sweeps", json_of(*plan)},
                {"out", options.out}});
  } else {
    print_plan(options, arm, *plan, around, poses.size());
  }
  return kDone;
}

Attempt<ExitStatus> run(const PlanOptions& options) {
  ARMSIG_TRY(arm, arm_with_margin(options));
  if (options.places.instrument.empty()) return plan_of_sweeps(options, arm);
  return plan_places(options, options.places, options.arm, arm);
}

// `of_sweeps`: the options that an instrument rules out.
void add_place_options(CLI::App& command, PlacePlanOptions& places,
                       std::initializer_list<CLI::Option*> of_sweeps) {
  CLI::Option* instrument =
      command.add_option("--instrument", places.instrument,
                         "instrument description (YAML): where its bars, sockets, planes and wires "
                         "are to stand, and which touches of them to make, instead of sweeps");
  for (CLI::Option* option : of_sweeps) instrument->excludes(option);
  const std::string with = " (with --instrument)";
  command
      .add_option("--accuracy-mm", places.accuracy_mm, "tool error to reach, 1 sigma, RMS" + with)
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->needs(instrument);
  command.add_option("--sigma-mm", places.sigma_mm, "of one number of a touch, 1 sigma" + with)
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->needs(instrument);
  command.add_option("--touches", places.most, "at most" + with)
      ->check(CLI::Range(10, 2000))
      ->capture_default_str()
      ->needs(instrument);
  command
      .add_option("--drawing", places.drawing,
                  "where everything is to stand, as a picture (SVG) to print" + with)
      ->needs(instrument);
}

}  // namespace

void add_plan(CLI::App& app, int& status) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command =
      app.add_subcommand("plan", "poses for the sweeps, or touches, before there is a signature");
  command
      ->add_option("--arm", options->arm,
                   "arm description (YAML), or a name that `armsig arms` lists")
      ->required();
  CLI::Option* configuration =
      command
          ->add_option(
              "--configuration", options->configuration,
              "where the other joints are held, degrees or mm a joint, separated by commas "
              "(default: sweep_at of the arm description, else the best found)")
          ->delimiter(',');
  CLI::Option* arc =
      command
          ->add_option(
              "--arc", options->arcs_deg,
              "of revolute joints at most, degrees: one, or one a joint, separated by commas")
          ->delimiter(',')
          ->check(CLI::Range(30.0, 360.0))
          ->capture_default_str();
  CLI::Option* points = command->add_option("--points", options->points, "a sweep")
                            ->check(CLI::Range(6, 1000))
                            ->capture_default_str();
  CLI::Option* target = command
                            ->add_option("--target-mm", options->target_mm,
                                         "the target in the last frame of the nominal model: x,y,z")
                            ->delimiter(',')
                            ->expected(3);
  add_place_options(*command, options->places, {configuration, arc, points, target});
  add_pose_options(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
