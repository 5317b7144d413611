// SPDX-License-Identifier: MIT
// armsig simulate: measurements of an arm that does not exist, and the truth about it.
#include <fmt/core.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/refinement/tolerances_option.hpp"
#include "firmware/host_tool/signature/record.hpp"
#include "firmware/host_tool/simulation/simulation.hpp"
#include "hal/simulated/demo_sensor.hpp"

namespace armsig::tool {
namespace {

struct SimulateOptions : CommonOptions {
  std::string arm, truth, tolerances, sensor, out, truth_out;
  double arc_deg = 180;
  std::size_t points = 36;
  double sigma_mm = 0.2;
  std::size_t mixed_poses = 0;
  std::size_t pings = 1;
  double target_radius_mm = 300;
  double outliers = 0;
  double dropouts = 0;
  double air_c = 20;
  double thermometer_error_c = 0;
  double bias_mm = 0;
  double maps_deg = 0;
  double sag_mm = 0;
  double play_deg = 0;
  std::uint64_t seed = 1;
  std::vector<double> hand_target_mm;
  std::vector<double> configuration;  // degrees and millimetres, by joint type
};

constexpr std::uint64_t kArmStream = 0;
constexpr std::uint64_t kBendStream = 3;

// The arm as built, and where its base is.
Read<simulated::SimulatedArm> build(const SimulateOptions& options, const Arm& drawing) {
  simulated::SimulatedArm built;
  built.X_S0 = simulated::demo_base_pose();
  built.arm = drawing;
  if (!options.truth.empty()) {
    const auto tag = read_tag(options.truth);
    if (!tag) return std::unexpected(tag.error());
    if (*tag == kSignatureTag) {
      const auto record = read_signature_file(options.truth);
      if (!record) return std::unexpected(record.error());
      built.arm.joints = record->signature.pseudo_dh;
      built.X_S0 = record->signature.X_SL[0];
    } else {
      const auto truth = read_arm_file(options.truth);
      if (!truth) return std::unexpected(truth.error());
      built.arm.joints = truth->arm.joints;
    }
    if (built.arm.joints.size() != drawing.joints.size()) {
      return std::unexpected(Problem{options.truth, 0, 0,
                                     fmt::format("{} joints", built.arm.joints.size()),
                                     fmt::format("{}, as the arm has", drawing.joints.size())});
    }
  } else if (!options.tolerances.empty()) {
    const auto tolerances = parse_tolerances(options.tolerances);
    if (!tolerances) return std::unexpected(tolerances.error());
    simulated::Random random(options.seed, kArmStream);
    built.arm = simulated::drawn_arm(drawing, *tolerances, random);
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

int run(const SimulateOptions& options) {
  const auto apart = check_roles(
      {{"--arm", options.arm}, {"--truth", options.truth}, {"--sensor", options.sensor}},
      {{"--out", options.out}, {"--truth-out", options.truth_out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto arm = read_arm(options.arm);
  if (!arm) return fail(arm.error(), kBadInput, options);
  auto built = build(options, arm->arm);
  if (!built) return fail(built.error(), kBadInput, options);
  const auto sensor = sensor_of(options);
  if (!sensor) return fail(sensor.error(), kBadInput, options);
  const auto configuration = configuration_of(options, arm->arm);
  if (!configuration) return fail(configuration.error(), kBadInput, options);

  if (options.hand_target_mm.empty()) {
    mount_link_targets(*built, *configuration, 1e-3 * options.target_radius_mm);
  } else {
    const std::vector<double>& p_mm = options.hand_target_mm;
    mount_hand_target(*built, 1e-3 * Vector3(p_mm[0], p_mm[1], p_mm[2]));
  }
  const cabinet::Bends bends{.map_rad = radians(options.maps_deg),
                             .sag_m = 1e-3 * options.sag_mm,
                             .play_rad = radians(options.play_deg)};
  simulated::Random bend_random(options.seed, kBendStream);
  const auto bent = bounded_bends(arm->arm, bends, bend_random);
  if (!bent) return fail(bent.error(), kBadInput, options);
  const BentJoints joints(*bent, bends.play_rad);
  const Simulation simulation{
      .arm = *built,
      .plan = plan_sweeps(arm->arm, *configuration, radians(options.arc_deg), options.points),
      .sensor = *sensor,
      .pings = options.pings,
      .mixed_poses = options.mixed_poses,
      .seed = options.seed,
      .joints = joints};

  const std::string comment = fmt::format("Simulated: {}, seed {}", arm->name, options.seed);
  auto writer = MeasurementWriter::create(options.out, layout_of(simulation, comment));
  if (!writer) return fail(writer.error(), kBadInput, options);
  const std::size_t total = row_count(simulation);
  Progress progress("Simulating", total);
  simulate(simulation, [&](const MeasurementRow& row) {
    writer->write(row);
    progress.update(row.line);
  });
  if (const auto done = writer->commit(); !done) return fail(done.error(), kBadInput, options);
  if (!options.truth_out.empty()) {
    SignatureRecord truth = exact_record(truth_of(*built, *configuration, joints), *arm);
    truth.deflections = *bent;
    const auto written = write_signature_file(options.truth_out, truth);
    if (!written) return fail(written.error(), kBadInput, options);
  }

  const double seconds = duration_s(arm->arm, simulation.plan, {.pings = options.pings});
  if (options.json) {
    print_json({{"status", 0},
                {"arm", arm->name},
                {"rows", total},
                {"duration_s", seconds},
                {"out", options.out},
                {"truth_out", options.truth_out}});
    return kDone;
  }
  say("{}: {} rows {}; the sweeps would take {} on the arm\n", arm->name, total,
      place_in_words(options.out), duration_in_words(seconds));
  if (!options.truth_out.empty()) say("The truth is in {}\n", options.truth_out);
  say("Next: armsig identify --arm {} --measurements {} --out signature.yaml\n", options.arm,
      file_or(options.out, "measurements.csv"));
  return kDone;
}

}  // namespace

void add_simulate(CLI::App& app, int& status) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand("simulate", "measurements of a simulated arm");
  command
      ->add_option("--arm", options->arm,
                   "arm description (YAML), or a name that `armsig arms` lists: the drawing")
      ->required();
  auto* truth = command->add_option("--truth", options->truth,
                                    "the arm as it was built: an arm description or a signature");
  command
      ->add_option("--tolerances", options->tolerances,
                   "draw the arm about the drawing, 1 sigma: a factor of the usual tolerances "
                   "(1 is alpha 0.1°, theta 0.2°, a and d 0.5 mm), or a list such as "
                   "alpha_deg=0.1,theta_deg=0.2,a_mm=0.5,d_mm=0.5")
      ->excludes(truth);
  command->add_option("--arc", options->arc_deg, "degrees that each revolute joint is swept")
      ->check(CLI::Range(0.1, 360.0))
      ->capture_default_str();
  command->add_option("--points", options->points, "points a sweep")
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}))
      ->capture_default_str();
  command
      ->add_option("--sigma-mm", options->sigma_mm,
                   "noise, 1 sigma: per axis of a position, or per range with --sensor")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--configuration", options->configuration,
                   "signature configuration, degrees or mm a joint, separated by commas "
                   "(default: the middle of the limits)")
      ->delimiter(',');
  auto* radius = command->add_option("--target-radius-mm", options->target_radius_mm,
                                     "a target on each link, this far from the axis of its joint");
  radius->check(CLI::PositiveNumber)->capture_default_str();
  command
      ->add_option("--hand-target-mm", options->hand_target_mm,
                   "one target for all sweeps instead: x,y,z in the frame of the last link")
      ->delimiter(',')
      ->expected(3)
      ->excludes(radius);
  command
      ->add_option("--mixed-poses", options->mixed_poses,
                   "further rows (sweep 0) with all joints anywhere within their limits")
      ->check(CLI::Range(std::size_t{0}, std::size_t{100'000'000}))
      ->capture_default_str();
  command->add_option("--sensor", options->sensor,
                      "sensor description (YAML): write ranges to its receivers, not positions");
  command->add_option("--pings", options->pings, "pings a point; the median counts")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  command
      ->add_option("--outliers", options->outliers,
                   "share of positions, or of single ranges, that are wrong by 20 to 300 mm")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--dropouts", options->dropouts, "share of positions or ranges not heard")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--air-c", options->air_c, "air temperature")->capture_default_str();
  command
      ->add_option("--thermometer-error-c", options->thermometer_error_c,
                   "what the sensor's thermometer reads too much")
      ->capture_default_str();
  command->add_option("--bias-mm", options->bias_mm, "constant error of every range")
      ->capture_default_str();
  command
      ->add_option("--maps-deg", options->maps_deg,
                   "largest error of each joint's reading, by waves of 1 to 17 a turn")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      ->add_option("--sag-mm", options->sag_mm,
                   "what gravity bends the arm by, stretched out level, its base upright")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  command
      ->add_option("--play-deg", options->play_deg,
                   "play of each joint, which stays on the side that it came from")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "the same seed gives the same file")
      ->capture_default_str();
  command->add_option("--out", options->out, "measurements to write (CSV)")->required();
  command->add_option("--truth-out", options->truth_out, "signature file to write: the exact arm");
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
