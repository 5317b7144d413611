// SPDX-License-Identifier: MIT
// armsig simulate: measurements of an arm that does not exist, and the truth about it.
#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/commands/simulate_options.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"
#include "firmware/host_tool/refinement/tolerances_option.hpp"
#include "firmware/host_tool/signature/record.hpp"
#include "firmware/host_tool/simulation/simulation.hpp"
#include "hal/simulated/demo_sensor.hpp"

namespace armsig::tool {
namespace {

constexpr std::uint64_t kArmStream = 0;
constexpr std::uint64_t kBendStream = 3;

// The arm that --truth describes, and where its base is.
Read<void> build_truth(const std::string& path, simulated::SimulatedArm& built) {
  ARMSIG_TRY(tag, read_tag(path));
  if (tag == kSignatureTag) {
    ARMSIG_TRY(record, read_signature_file(path));
    built.arm.joints = record.signature.pseudo_dh;
    built.X_S0 = record.signature.X_SL[0];
  } else {
    ARMSIG_TRY(truth, read_arm_file(path));
    built.arm.joints = truth.arm.joints;
  }
  return {};
}

// The arm as built, and where its base is.
Read<simulated::SimulatedArm> build(const SimulateOptions& options, const Arm& drawing) {
  simulated::SimulatedArm built;
  built.X_S0 = simulated::demo_base_pose();
  built.arm = drawing;
  if (!options.truth.empty()) {
    if (auto read = build_truth(options.truth, built); !read) {
      return std::unexpected(std::move(read).error());
    }
    if (built.arm.joints.size() != drawing.joints.size()) {
      return std::unexpected(Problem{options.truth, 0, 0,
                                     fmt::format("{} joints", built.arm.joints.size()),
                                     fmt::format("{}, as the arm has", drawing.joints.size())});
    }
  } else if (!options.tolerances.empty()) {
    ARMSIG_TRY(tolerances, parse_tolerances(options.tolerances));
    simulated::Random random(options.seed, kArmStream);
    built.arm = simulated::drawn_arm(drawing, tolerances, random);
  }
  return built;
}

Read<SimulatedSensor> sensor_of(const SimulateOptions& options) {
  if (options.sensor.empty()) {
    return simulated::CartesianConfig{.sigma_m = 1e-3 * options.sigma_mm,
                                      .dropout_probability = options.dropouts,
                                      .outlier_probability = options.outliers};
  }
  const auto sensor = read_checked_sensor(options.sensor);
  if (!sensor) return std::unexpected(sensor.error());
  simulated::UltrasonicConfig config;
  config.range_sigma_m = 1e-3 * options.sigma_mm;
  config.air_celsius = options.air_c;
  config.thermometer_error_kelvin = options.thermometer_error_c;
  config.dropout_probability = options.dropouts;
  config.multipath_probability = options.outliers;
  for (const Vector3& p_S : sensor->receivers_S) {
    config.receivers_S.push_back(p_S);
    config.bias_m.push_back(1e-3 * options.bias_mm);
  }
  return config;
}

MeasurementLayout layout_of(const Simulation& simulation, std::string_view comment) {
  MeasurementLayout layout{.types = types_of(simulation.arm.arm.joints), .comment = comment};
  if (const auto* cartesian = std::get_if<simulated::CartesianConfig>(&simulation.sensor)) {
    layout.sigma = cartesian->sigma_m > 0;
  } else {
    const auto& field = std::get<simulated::UltrasonicConfig>(simulation.sensor);
    layout.receivers = field.receivers_S.size();
    layout.air = true;
    layout.sigma = field.range_sigma_m > 0;
  }
  return layout;
}

Read<JointVector> configuration_of(const SimulateOptions& options, const Arm& arm) {
  if (options.configuration.empty()) return middle_of_limits(arm);
  if (options.configuration.size() != arm.joints.size()) {
    return std::unexpected(
        Problem{"--configuration", 0, 0, fmt::format("{} readings", options.configuration.size()),
                fmt::format("one for each of the {} joints", arm.joints.size())});
  }
  JointVector configuration;
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const double value = options.configuration[j];
    configuration.push_back(arm.joints[j].type == JointType::kRevolute ? radians(value)
                                                                       : 1e-3 * value);
  }
  return configuration;
}

void mount_targets(const SimulateOptions& options, const JointVector& configuration,
                   simulated::SimulatedArm& built) {
  if (options.hand_target_mm.empty()) {
    mount_link_targets(built, configuration, 1e-3 * options.target_radius_mm);
  } else {
    const std::vector<double>& p_mm = options.hand_target_mm;
    mount_hand_target(built, 1e-3 * Vector3(p_mm[0], p_mm[1], p_mm[2]));
  }
}

// As --maps-deg, --deflection-mm and --backlash-deg have them.
Read<std::shared_ptr<const calibration::ArmModel>> bends_of(const SimulateOptions& options,
                                                            const Arm& drawing) {
  simulated::Random random(options.seed, kBendStream);
  return bounded_bends(drawing,
                       {.map_rad = radians(options.maps_deg),
                        .sag_m = 1e-3 * options.sag_mm,
                        .play_rad = radians(options.play_deg)},
                       random);
}

// Measures, and writes the rows; how many there are.
Read<std::size_t> write_rows(const SimulateOptions& options, const Simulation& simulation,
                             const std::string& arm) {
  const std::string comment = fmt::format("Simulated: {}, seed {}", arm, options.seed);
  ARMSIG_TRY(writer, MeasurementWriter::create(options.out, layout_of(simulation, comment)));
  const std::size_t total = row_count(simulation);
  Progress progress("Simulating", total);
  simulate(simulation, [&](const MeasurementRow& row) {
    writer.write(row);
    progress.update(row.line);
  });
  if (auto done = writer.commit(); !done) return std::unexpected(std::move(done).error());
  return total;
}

void print_simulated(const SimulateOptions& options, const std::string& arm, std::size_t rows,
                     double duration_s) {
  if (options.json) {
    print_json({{"status", 0},
                {"arm", arm},
                {"rows", rows},
                {"duration_s", duration_s},
                {"out", options.out},
                {"truth_out", options.truth_out}});
    return;
  }
  say("{}: {} {}; the sweeps would take {} on the arm\n", arm, counted(rows, "row"),
      place_in_words(options.out), duration_in_words(duration_s));
  if (!options.truth_out.empty()) say("The truth is in {}\n", options.truth_out);
  if (!is_there_to_read(options.out)) return;
  TypedCommand identify("identify");
  identify.file_option("--arm", options.arm);
  add_rows(identify, {.measurements = options.out, .columns = {}, .sensor = options.sensor});
  say_next(identify.option("--out", "signature.yaml"));
}

Attempt<ExitStatus> run(const SimulateOptions& options) {
  if (auto apart = check_roles(
          {{"--arm", options.arm}, {"--truth", options.truth}, {"--sensor", options.sensor}},
          {{"--out", options.out}, {"--truth-out", options.truth_out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(arm, read_arm(options.arm));
  ARMSIG_TRY(built, build(options, arm.arm));
  ARMSIG_TRY(sensor, sensor_of(options));
  ARMSIG_TRY(configuration, configuration_of(options, arm.arm));
  mount_targets(options, configuration, built);
  ARMSIG_TRY(bent, bends_of(options, arm.arm));
  const BentJoints joints(bent, radians(options.play_deg));
  const Simulation simulation{
      .arm = built,
      .plan = plan_sweeps(arm.arm, configuration, radians(options.arc_deg), options.points),
      .sensor = sensor,
      .pings = options.pings,
      .mixed_poses = options.mixed_poses,
      .seed = options.seed,
      .joints = joints};
  ARMSIG_TRY(rows, write_rows(options, simulation, arm.name));
  if (!options.truth_out.empty()) {
    SignatureRecord truth = exact_record(truth_of(built, configuration, joints), arm);
    truth.deflections = bent;
    if (auto written = write_signature_file(options.truth_out, truth); !written) {
      return std::unexpected(std::move(written).error());
    }
  }
  print_simulated(options, arm.name, rows,
                  duration_s(arm.arm, simulation.plan, {.pings = options.pings}));
  return kDone;
}

}  // namespace

void add_simulate(CLI::App& app, int& status) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand("simulate", "measurements of a simulated arm");
  add_simulate_options(*command, *options);
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
