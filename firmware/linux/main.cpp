// SPDX-License-Identifier: MIT
// armsigd: the controller on embedded Linux.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "firmware/command_line/help_form.hpp"
#include "firmware/command_line/option_problem.hpp"
#include "firmware/controller/sweep.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/linux/daemon.hpp"
#include "firmware/linux/drive_look.hpp"
#include "firmware/linux/signals.hpp"
#include "firmware/linux/virtual_run.hpp"

namespace armsig::daemon {
namespace {

constexpr int kWrongUsage = 2;

struct Options {
  std::string configuration;
  bool check = false;
  bool drives = false;
  bool json = false;
  bool is_virtual = false;
  std::string truth;
  std::string console;
  std::string store;
  double maps_deg = 0;
  double sag_mm = 0;
  double play_deg = 0;
  VirtualOptions emulated;
};

// What goes with --virtual only.
void add_virtual_options(CLI::App& app, CLI::Option* is_virtual, Options& options) {
  app.add_option("--truth", options.truth,
                 "--virtual: the arm as it was built (arm description); otherwise it is drawn "
                 "from the usual tolerances")
      ->needs(is_virtual);
  app.add_option("--seed", options.emulated.seed, "--virtual: of those tolerances and the noise")
      ->needs(is_virtual)
      ->capture_default_str();
  CLI::Option* speed = app.add_option("--speed", options.emulated.speed,
                                      "--virtual: times real time; 0: as fast as it goes")
                           ->needs(is_virtual)
                           ->check(CLI::NonNegativeNumber)
                           ->capture_default_str();
  const auto add_bend = [&](const char* name, double& value, const char* help) {
    app.add_option_function<double>(
           name, [&value](double told) { value = told; }, help)
        ->needs(is_virtual)
        ->check(CLI::NonNegativeNumber);
  };
  add_bend("--maps-deg", options.maps_deg,
           "--virtual: largest joint error map, periodic with the turn");
  add_bend("--deflection-mm", options.sag_mm,
           "--virtual: how far gravity deflects the arm, stretched out level");
  add_bend("--backlash-deg", options.play_deg,
           "--virtual: between each motor and its joint, beside what the drives have");
  add_bend("--warm-kelvin", options.emulated.warm_kelvin,
           "--virtual: by which the arm warms up after power-up and grows, as steel does");
  app.add_flag(
         "--ideal", options.emulated.ideal,
         "--virtual: exact drives, without gravity, coasting, slow brakes, backlash and delays")
      ->needs(is_virtual);
  app.add_flag(
         "--real-time", options.emulated.real_time,
         "--virtual: by the threads and priorities of a real controller, to see this computer's "
         "lateness")
      ->needs(is_virtual)
      ->excludes(speed);
}

void add_options(CLI::App& app, Options& options) {
  app.formatter(std::make_shared<tool::HelpForm>());
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("-V,--version", "armsigd " ARMSIG_VERSION, "print the version");
  app.add_option("configuration", options.configuration, "the YAML file of the controller")
      ->required();
  CLI::Option* check =
      app.add_flag("--check", options.check, "only check the configuration; open and send nothing");
  CLI::Option* is_virtual = app.add_flag("--virtual", options.is_virtual,
                                         "run about an emulated arm instead of a real one");
  CLI::Option* drives =
      app.add_flag("--drives", options.drives,
                   "only look at the drives on the bus: what each has, and what would be written; "
                   "write nothing");
  drives->excludes(check)->excludes(is_virtual);
  app.add_flag("--json", options.json, "--drives: as JSON")->needs(drives);
  check->excludes(is_virtual);
  app.add_option("--console", options.console, "Unix socket, instead of the configured one");
  app.add_option("--store", options.store,
                 "file of signatures, instead of the configured one; the black box is beside it");
  add_virtual_options(app, is_virtual, options);
}

// What the arm stays clear of, and what that and the limits leave of each sweep.
void tell_surroundings(const DaemonConfiguration& c) {
  const controller::Configuration& whole = c.controller;
  fmt::print("in force: {}\n", tool::surroundings_in_words(whole.around, c.lengths));
  for (std::size_t joint = 0; joint < whole.drawing.joints.size(); ++joint) {
    const bool turns = whole.drawing.joints[joint].type == JointType::kRevolute;
    const auto [lower, upper] = controller::planned_arc(whole, joint);
    const auto& limits = whole.drawing.limits[joint];
    const double unit = turns ? degrees(1) : 1e3;
    const double asked = std::min(turns ? controller::arc_of(whole.sweeps, joint) : 1e9,
                                  limits.upper - limits.lower);
    fmt::print("joint {} sweeps {:.1f} of {:.1f} {}, from {:.1f} to {:.1f}\n", joint + 1,
               unit * (upper - lower), unit * asked, turns ? "degrees" : "mm", unit * lower,
               unit * upper);
  }
}

std::string instrument_in_words(const DaemonConfiguration& c) {
  const std::size_t anchors = c.length_offsets_m.size();
  const std::string what =
      anchors > 0 ? fmt::format("lengths from {} anchors", anchors) : std::string("points");
  if (const auto* told = std::get_if<linux_hal::LineServerConfiguration>(&c.sensor)) {
    return fmt::format("{} at {} port {}", what, told->address, told->port);
  }
  if (const auto* asked = std::get_if<linux_hal::RegisterClientConfiguration>(&c.sensor)) {
    return fmt::format("{} of the Modbus server {} port {}", what, asked->address, asked->port);
  }
  if (std::holds_alternative<std::monostate>(c.sensor)) return "no sensor";
  return fmt::format(
      "sensor on {} with {} receivers",
      std::holds_alternative<canopen::RangeNodeConfiguration>(c.sensor) ? "CAN" : "Modbus",
      c.controller.sensor.receivers.p_S.size());
}

std::string loads_in_words(const DaemonConfiguration& c) {
  std::string words = fmt::format("{:.1f} %", 100 * c.bus_loads[0]);
  if (c.bus_loads.size() > 1) words += fmt::format(" and {:.1f} %", 100 * c.bus_loads[1]);
  return words;
}

void tell(const DaemonConfiguration& c) {
  const auto& grid = c.controller.grid;
  fmt::print("{}: {} joints at {:g} Hz on {}, bus load at most {}, {}", c.name,
             c.drives.axes.size(), 1 / hal::seconds(c.controller.period), interfaces_in_words(c),
             loads_in_words(c), instrument_in_words(c));
  if (!grid.taught[0].empty()) {
    fmt::print(", grid of {} vertices over {:g} x {:g} x {:g} mm", grid.grid.vertex_count(),
               1e3 * grid.grid.size_m[0], 1e3 * grid.grid.size_m[1], 1e3 * grid.grid.size_m[2]);
  }
  fmt::print("\n");
  tell_surroundings(c);
}

int refuse(const tool::Problem& problem) {
  fmt::print(stderr, "{}", tool::for_standard_error("armsigd: " + tool::render(problem)));
  return kWrongUsage;
}

int run(Options& options, const volatile std::sig_atomic_t& stop) {
  auto configuration = read_configuration(options.configuration);
  if (!configuration) return refuse(configuration.error());
  if (!options.console.empty()) configuration->console = options.console;
  if (!options.store.empty()) {
    configuration->store = options.store;
    configuration->black_box.clear();  // beside it
  }
  if (options.check) {
    tell(*configuration);
    return 0;
  }
  if (options.drives) return look_at_drives(*configuration, options.json, stop);
  if (!options.is_virtual) return run_cabinet(*configuration, stop);
  if (!options.truth.empty()) {
    const auto truth = tool::read_arm_file(options.truth);
    if (!truth) return refuse(truth.error());
    if (truth->arm.joints.size() != configuration->drives.axes.size()) {
      return refuse(
          {.file = options.truth,
           .what = fmt::format("an arm of {} joints", truth->arm.joints.size()),
           .expected = fmt::format("{}, as configured", configuration->drives.axes.size())});
    }
    options.emulated.truth = truth->arm;
  }
  options.emulated.bends = {.map_rad = radians(options.maps_deg),
                            .sag_m = 1e-3 * options.sag_mm,
                            .play_rad = radians(options.play_deg)};
  return run_virtual(*configuration, options.emulated, stop);
}

int parse_and_run(int argc, char** argv, const volatile std::sig_atomic_t& stop) {
  CLI::App app{"The controller of one robot arm: servo, identification, signature store.",
               "armsigd"};
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    const std::vector<std::string> words(argv + 1, argv + argc);
    return refuse(tool::option_problem(app, "armsigd", error, words));
  }
  return run(options, stop);
}

}  // namespace
}  // namespace armsig::daemon

int main(int argc, char** argv) {
  try {
    return armsig::daemon::parse_and_run(argc, argv, armsig::daemon::catch_signals());
  } catch (const std::bad_alloc&) {
    std::fputs("armsigd: out of memory\n", stderr);
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "armsigd: %s\n", error.what());
    return 1;
  }
}
