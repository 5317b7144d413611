// SPDX-License-Identifier: MIT
// armsig demo: the whole story on a simulated Puma 560.
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/report/report.hpp"
#include "firmware/host_tool/signature/record.hpp"
#include "firmware/host_tool/simulation/demo_run.hpp"
#include "firmware/paper_arms/paper_arms.hpp"

namespace armsig::tool {
namespace {

constexpr const char* kArmFile = "puma560.yaml";
constexpr const char* kSensorFile = "sensor.yaml";
constexpr const char* kMeasurementsFile = "robot1-measurements.csv";
constexpr std::size_t kRobots = 7;  // as many as the paper identified
constexpr std::array<const char*, 4> kIndexNames{
    "Maximum normal deviation from a line", "Deviation from perpendicular between lines",
    "Maximum radial deviation of a grid point", "Maximum orientational deviation"};

struct DemoOptions : CommonOptions {
  std::string out = "armsig-demo";
  std::uint64_t seed = 1;
};

std::array<double, 4> average_improvement(const std::vector<DemoRobot>& robots,
                                          DemoMethod DemoRobot::* method) {
  std::array<double, 4> average{};
  for (const DemoRobot& robot : robots) {
    const auto factors = improvement((robot.*method).grid);
    for (std::size_t k = 0; k < 4; ++k)
      average[k] += factors[k] / static_cast<double>(robots.size());
  }
  return average;
}

// Recovered and printed parameters side by side.
std::string table2(const Signature& signature, const Arm& printed) {
  Table table(
      {"Link", "θ offset °", "printed", "d mm", "printed", "a mm", "printed", "α °", "printed"});
  for (std::size_t i = 0; i < printed.joints.size(); ++i) {
    const DhJoint& found = signature.pseudo_dh[i];
    const DhJoint& row = printed.joints[i];
    const bool free_frame = i == 0 || i + 1 == printed.joints.size();
    const char* mark = free_frame ? "*" : " ";
    table.add_row(
        {fmt::format("{}", i + 1), fmt::format("{:.3f}{}", degrees(found.theta_rad), mark),
         fmt::format("{:.3f}", degrees(row.theta_rad)),
         fmt::format("{:.2f}{}", 1e3 * found.d_m, mark), fmt::format("{:.2f}", 1e3 * row.d_m),
         fmt::format("{:.2f}", 1e3 * found.a_m), fmt::format("{:.2f}", 1e3 * row.a_m),
         fmt::format("{:.3f}", degrees(found.alpha_rad)),
         fmt::format("{:.3f}", degrees(row.alpha_rad))});
  }
  return table.render();
}

std::string table3_text(const std::vector<DemoRobot>& robots) {
  Table table({"Ideal model over arm signature", "Robot 1", "paper", "Robot 2", "paper",
               "Average of 7", "by the paper's fit"});
  const auto average = average_improvement(robots, &DemoRobot::encoder);
  const auto average_paper = average_improvement(robots, &DemoRobot::paper);
  const auto robot1 = improvement(robots[0].encoder.grid);
  const auto robot2 = improvement(robots[1].encoder.grid);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = [](double value) { return fmt::format("{:.1f}", value); };
    table.add_row({kIndexNames[k], number(robot1[k]), number(table3(1)[k]), number(robot2[k]),
                   number(table3(2)[k]), number(average[k]), number(average_paper[k])});
  }
  return table.render();
}

std::string tool_error_table(const std::vector<DemoRobot>& robots) {
  Table table({"RMS tool error, sensor's frame", "Drawing mm", "Paper's fit mm",
               "Encoder-referenced mm", "Improvement"});
  for (const DemoRobot& robot : robots) {
    table.add_row({robot.name, fmt::format("{:.3f}", 1e3 * robot.drawing_error_m),
                   fmt::format("{:.3f}", 1e3 * robot.paper.tool_error_m),
                   fmt::format("{:.3f}", 1e3 * robot.encoder.tool_error_m),
                   fmt::format("{:.0f}", robot.drawing_error_m / robot.encoder.tool_error_m)});
  }
  return table.render();
}

nlohmann::ordered_json demo_json(const std::vector<DemoRobot>& robots) {
  const auto method_json = [](const DemoMethod& method) {
    return nlohmann::ordered_json{{"rms_tool_error_m", method.tool_error_m},
                                  {"evaluation", comparison_json(method.grid)},
                                  {"signature", signature_json(method.signature)}};
  };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DemoRobot& robot : robots) {
    list.push_back({{"name", robot.name},
                    {"sweep_duration_s", robot.sweep_duration_s},
                    {"rejected", robot.rejected},
                    {"drawing_rms_tool_error_m", robot.drawing_error_m},
                    {"paper", method_json(robot.paper)},
                    {"encoder", method_json(robot.encoder)}});
  }
  return {{"status", 0}, {"robots", std::move(list)}};
}

// A file of the demonstration by its name, in its folder.
using Named = std::function<std::string(const std::string&)>;

// What the two methods found of a robot, and the truth.
Read<void> write_signatures(const DemoRobot& robot, const std::string& prefix, const Named& named) {
  const ArmDescription arm{.name = "Puma 560, " + robot.name, .arm = puma560()};
  const auto write = [&](const char* kind, const SignatureRecord& record) {
    return write_signature_file(named(prefix + kind + ".yaml"), record);
  };
  const auto record = [&](const Signature& signature, const char* method) {
    return record_of({.signature = signature, .counts = {}, .air_celsius = 20.0, .warnings = {}},
                     arm, method, "");
  };
  for (const auto& written : {write("paper", record(robot.paper.signature, "paper")),
                              write("encoder", record(robot.encoder.signature, "encoder")),
                              write("truth", exact_record(robot.truth, arm))}) {
    if (!written) return std::unexpected(written.error());
  }
  return {};
}

// Everything that a person needs to go on from the demonstration: drawing, sensor and measurements
// of robot 1, the signatures and truths of all.
Read<std::vector<std::string>> write_files(const std::vector<DemoRobot>& robots,
                                           const std::vector<MeasurementRow>& rows_of_robot1,
                                           const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return std::unexpected(Problem{folder, 0, 0, error.message(), "a folder to write to"});
  std::vector<std::string> files;
  const auto named = [&](const std::string& name) {
    files.push_back(folder + "/" + name);
    return files.back();
  };
  const ArmDescription drawing{.name = "Puma 560", .arm = puma560()};
  if (auto written = write_arm_file(named(kArmFile), drawing); !written) {
    return std::unexpected(written.error());
  }
  const SensorDescription sensor = demo_sensor_description();
  if (auto written = write_sensor_file(named(kSensorFile), sensor); !written) {
    return std::unexpected(written.error());
  }
  ARMSIG_TRY(writer, MeasurementWriter::create(named(kMeasurementsFile),
                                               {.types = types_of(drawing.arm.joints),
                                                .receivers = sensor.receivers_S.size(),
                                                .air = true,
                                                .sigma = true}));
  for (const MeasurementRow& row : rows_of_robot1) writer.write(row);
  if (auto written = writer.commit(); !written) return std::unexpected(written.error());

  for (std::size_t k = 0; k < robots.size(); ++k) {
    if (auto written = write_signatures(robots[k], fmt::format("robot{}-", k + 1), named);
        !written) {
      return std::unexpected(std::move(written).error());
    }
  }
  return files;
}

// The page about robot 1; nothing where armsig was built without pages.
Read<std::optional<std::string>> write_report(const std::string& folder) {
  const auto input = read_report_input({.signature = folder + "/robot1-encoder.yaml",
                                        .measurements = folder + "/" + kMeasurementsFile,
                                        .sensor = folder + "/" + kSensorFile,
                                        .truth = folder + "/robot1-truth.yaml"});
  if (!input) return std::unexpected(input.error());
  const auto page = report_page(report_json(*input));
  if (!page) return std::nullopt;
  std::string path = folder + "/report.html";
  if (auto written = write_text_file(path, *page); !written) {
    return std::unexpected(written.error());
  }
  return path;
}

// The tables of the paper, with what this demonstration gives for them.
void print_tables_of_the_paper(const std::vector<DemoRobot>& robots) {
  say("Table 1. Ideal kinematic parameters: the drawing\n\n{}\n", dh_table(puma560().joints));
  for (int robot : {1, 2}) {
    const Signature& signature = robots[static_cast<std::size_t>(robot) - 1].encoder.signature;
    say("Table 2. Arm signature of robot {}, as recovered and as printed in the paper\n\n{}\n",
        robot, table2(signature, table2_robot(robot)));
  }
  say("{}{}\n",
      paragraph(
          "* θ and d of links 1 and 6 depend on the choice of frames 0 and 6, which is free."),
      near_parallel_note(robots[0].encoder.signature));
  say("{}\n{}\n",
      paragraph("Table 3. Touching a 25 x 25 x 60 cm grid: improvement factors by circles that "
                "follow the joint reading, beside those that the paper reached by plane and centre "
                "of rotation alone",
                0),
      table3_text(robots));
}

void print_story(const std::vector<DemoRobot>& robots, const std::optional<std::string>& report,
                 const DemoOptions& options) {
  const DemoPlan plan;
  say("armsig demo: seven Puma 560, simulated as Stone, Sanderson and Neuman\n"
      "measured theirs (1986)\n\n{}\n",
      paragraph(fmt::format(
                    "Each joint is swept in turn as far as its limits allow, {} points a joint. An "
                    "ultrasonic sensor of 8 receivers, 0.2 mm (1 sigma) a range, {} pings a point, "
                    "locates a target on the moving link. On the arm this would take {}.",
                    plan.points, plan.pings, duration_in_words(robots[0].sweep_duration_s)),
                0));
  print_tables_of_the_paper(robots);
  say("{}{}\n", tool_error_table(robots),
      paragraph("Over the joint limits, each where the sensor sees it: the drawing with base and "
                "tool fitted, the signatures as they are."));
  say("Drawing, sensor, measurements, signatures and truths are in {}/.\n"
      "Robot 1 again, by the command for your own arm:\n"
      "  armsig identify --arm {}/{} --measurements {}/{} --sensor {}/{} --out signature.yaml\n",
      options.out, options.out, kArmFile, options.out, kMeasurementsFile, options.out, kSensorFile);
  if (report) say("\nNext: open the report of robot 1 in a browser: {}\n", *report);
}

int run(const DemoOptions& options) {
  std::vector<DemoRobot> robots;
  std::vector<MeasurementRow> rows_of_robot1;
  const auto keep = [&](const MeasurementRow& row) { rows_of_robot1.push_back(row); };
  Progress progress("Identifying seven arms", kRobots);
  for (std::size_t k = 0; k < kRobots; ++k) {
    progress.update(k);
    auto robot =
        k == 0 ? run_demo_robot(k, options.seed + k, keep) : run_demo_robot(k, options.seed + k);
    if (!robot) return fail(robot.error(), kNoAnswer, options);
    robots.push_back(std::move(*robot));
  }
  const auto files = write_files(robots, rows_of_robot1, options.out);
  if (!files) return fail(files.error(), kBadInput, options);
  const auto report = write_report(options.out);
  if (!report) return fail(report.error(), kBadInput, options);
  if (options.json) {
    auto json = demo_json(robots);
    json["files"] = *files;
    json["report"] = *report ? nlohmann::ordered_json(**report) : nullptr;
    print_json(json);
  } else {
    print_story(robots, *report, options);
  }
  return kDone;
}

}  // namespace

void add_demo(CLI::App& app, int& status) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = app.add_subcommand("demo", "the whole story on a simulated Puma 560");
  command->add_option("--out", options->out, "folder for the report and the files it is made of")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of the sensor's noise")->capture_default_str();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
