// SPDX-License-Identifier: MIT
// armsig demo: the whole story on a simulated Puma 560.
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/identify.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"
#include "firmware/host_tool/report/report.hpp"
#include "firmware/host_tool/signature/record.hpp"
#include "firmware/host_tool/simulation/demo_run.hpp"
#include "firmware/paper_arms/paper_arms.hpp"

namespace armsig::tool {
namespace {

constexpr const char* kArmFile = "puma560.yaml";
constexpr const char* kSensorFile = "sensor.yaml";
constexpr const char* kMeasurements = "measurements.csv";  // after the name of the robot
constexpr std::size_t kRobots = 7;                         // as many as the paper identified
constexpr std::array<const char*, 4> kIndexNames{
    "Maximum normal deviation from a line", "Deviation from perpendicular between lines",
    "Maximum radial deviation of a grid point", "Maximum orientational deviation"};

struct DemoOptions : CommonOptions {
  std::string out = "armsig-demo";
  std::uint64_t seed = 1;
};

// What identification found of a robot by one method, and how good that is.
struct DemoMethod {
  SignatureRecord record;
  DemoScore score;
};

struct DemoResult {
  DemoRobot robot;
  DemoMethod paper;
  DemoMethod encoder;
};

std::array<double, 4> average_improvement(const std::vector<DemoResult>& robots,
                                          DemoMethod DemoResult::* method) {
  std::array<double, 4> average{};
  for (const DemoResult& robot : robots) {
    const auto factors = improvement((robot.*method).score.grid);
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

std::string table3_text(const std::vector<DemoResult>& robots) {
  Table table({"Ideal model over arm signature", "Robot 1", "paper", "Robot 2", "paper",
               "Average of 7", "by the paper's fit"});
  const auto average = average_improvement(robots, &DemoResult::encoder);
  const auto average_paper = average_improvement(robots, &DemoResult::paper);
  const auto robot1 = improvement(robots[0].encoder.score.grid);
  const auto robot2 = improvement(robots[1].encoder.score.grid);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = [](double value) { return fmt::format("{:.1f}", value); };
    table.add_row({kIndexNames[k], number(robot1[k]), number(table3(1)[k]), number(robot2[k]),
                   number(table3(2)[k]), number(average[k]), number(average_paper[k])});
  }
  return table.render();
}

double stated_error_m(const SignatureRecord& record) {
  return record.accuracy.predicted ? record.accuracy.predicted->rms_m : 0;
}

std::string tool_error_table(const std::vector<DemoResult>& robots) {
  const auto millimetres = [](double metres) { return fmt::format("{:.3f}", 1e3 * metres); };
  Table table({"RMS tool error, sensor's frame", "Nominal mm", "Paper's fit mm",
               "Encoder-referenced mm", "stated mm", "Improvement"});
  for (const DemoResult& result : robots) {
    const double error_m = result.encoder.score.tool_error_m;
    table.add_row({result.robot.name, millimetres(result.robot.drawing_error_m),
                   millimetres(result.paper.score.tool_error_m), millimetres(error_m),
                   millimetres(stated_error_m(result.encoder.record)),
                   fmt::format("{:.0f}", result.robot.drawing_error_m / error_m)});
  }
  return table.render();
}

nlohmann::ordered_json demo_json(const std::vector<DemoResult>& robots) {
  const auto method_json = [](const DemoMethod& method) {
    return nlohmann::ordered_json{{"rms_tool_error_m", method.score.tool_error_m},
                                  {"predicted_tool_error_m", stated_error_m(method.record)},
                                  {"warnings", method.record.warnings},
                                  {"evaluation", comparison_json(method.score.grid)},
                                  {"signature", signature_json(method.record.signature)}};
  };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DemoResult& result : robots) {
    const auto& fit = result.encoder.record.fit;
    list.push_back({{"name", result.robot.name},
                    {"sweep_duration_s", result.robot.sweep_duration_s},
                    {"rejected", fit ? fit->rows_rejected : 0},
                    {"nominal_rms_tool_error_m", result.robot.drawing_error_m},
                    {"paper", method_json(result.paper)},
                    {"encoder", method_json(result.encoder)}});
  }
  return {{"status", 0}, {"robots", std::move(list)}};
}

// The files of the demonstration by their names, in its folder; those written are kept.
class DemoFolder {
 public:
  static Read<DemoFolder> create(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) return std::unexpected(Problem{path, 0, 0, error.message(), "a folder to write to"});
    return DemoFolder(path);
  }

  [[nodiscard]] std::string path(const std::string& name) const { return path_ + "/" + name; }
  std::string written(const std::string& name) {
    files_.push_back(path(name));
    return files_.back();
  }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  explicit DemoFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::vector<std::string> files_;
};

std::string name_of(std::size_t robot, const char* file) {
  return fmt::format("robot{}-{}", robot + 1, file);
}

Read<void> write_measurements(const DemoRobot& robot, const std::string& path) {
  ARMSIG_TRY(writer, MeasurementWriter::create(
                         path, {.types = types_of(puma560().joints),
                                .receivers = demo_sensor_description().receivers_S.size(),
                                .air = true,
                                .sigma = true}));
  for (const MeasurementRow& row : robot.rows) writer.write(row);
  return writer.commit();
}

RowSource rows_of(std::size_t robot, const DemoFolder& folder) {
  return {.measurements = folder.path(name_of(robot, kMeasurements)),
          .columns = {},
          .sensor = folder.path(kSensorFile)};
}

// By the command that a person would give.
Attempt<DemoMethod> identified(const DemoRobot& robot, std::size_t index, const char* method,
                               DemoFolder& folder) {
  IdentifyOptions options;
  options.arm = folder.path(kArmFile);
  options.rows = rows_of(index, folder);
  options.method = method;
  options.out = folder.written(name_of(index, method) + ".yaml");
  ARMSIG_TRY(identified, identify_file(options));
  ARMSIG_TRY(score, score_of(robot, identified.record.signature));
  return DemoMethod{.record = std::move(identified.record), .score = score};
}

Attempt<DemoResult> run_robot(std::size_t index, std::uint64_t seed, DemoFolder& folder) {
  DemoRobot robot = measured_demo_robot(index, seed);
  const ArmDescription arm{.name = "Puma 560, " + robot.name, .arm = puma560()};
  if (auto written = write_measurements(robot, folder.written(name_of(index, kMeasurements)));
      !written) {
    return std::unexpected(std::move(written).error());
  }
  if (auto written = write_signature_file(folder.written(name_of(index, "truth.yaml")),
                                          exact_record(robot.truth, arm));
      !written) {
    return std::unexpected(std::move(written).error());
  }
  ARMSIG_TRY(paper, identified(robot, index, "paper", folder));
  ARMSIG_TRY(encoder, identified(robot, index, "encoder", folder));
  return DemoResult{
      .robot = std::move(robot), .paper = std::move(paper), .encoder = std::move(encoder)};
}

// What every robot has in common.
Read<void> write_descriptions(DemoFolder& folder) {
  const ArmDescription drawing{.name = "Puma 560", .arm = puma560()};
  if (auto written = write_arm_file(folder.written(kArmFile), drawing); !written) return written;
  return write_sensor_file(folder.written(kSensorFile), demo_sensor_description());
}

// The page about robot 1; nothing where armsig was built without pages.
Read<std::optional<std::string>> write_report(const DemoFolder& folder) {
  const auto input = read_report_input({.signature = folder.path("robot1-encoder.yaml"),
                                        .rows = rows_of(0, folder),
                                        .truth = folder.path("robot1-truth.yaml")});
  if (!input) return std::unexpected(input.error());
  const auto page = report_page(report_json(*input));
  if (!page) return std::nullopt;
  std::string path = folder.path("report.html");
  if (auto written = write_text_file(path, *page); !written) {
    return std::unexpected(written.error());
  }
  return path;
}

// The tables of the paper, with what this demonstration gives for them.
void print_tables_of_the_paper(const std::vector<DemoResult>& robots) {
  say("Table 1. Ideal kinematic parameters: the nominal model\n\n{}\n", dh_table(puma560().joints));
  for (int robot : {1, 2}) {
    const Signature& signature =
        robots[static_cast<std::size_t>(robot) - 1].encoder.record.signature;
    say("Table 2. Arm signature of robot {}, as recovered and as printed in the paper\n\n{}\n",
        robot, table2(signature, table2_robot(robot)));
  }
  say("{}{}\n",
      paragraph(
          "* θ and d of links 1 and 6 depend on the choice of frames 0 and 6, which is free."),
      near_parallel_note(robots[0].encoder.record.signature));
  say("{}\n{}\n",
      paragraph("Table 3. Touching a 25 x 25 x 60 cm grid: improvement factors by circles that "
                "follow the joint reading, beside those that the paper reached by plane and centre "
                "of rotation alone",
                0),
      table3_text(robots));
}

// Robot 1 by the files that were written.
TypedCommand identify_again(const DemoFolder& folder) {
  TypedCommand identify("identify");
  identify.file_option("--arm", folder.path(kArmFile));
  add_rows(identify, rows_of(0, folder));
  return identify.option("--out", "signature.yaml");
}

void print_story(const std::vector<DemoResult>& robots, const std::optional<std::string>& report,
                 const DemoOptions& options, const DemoFolder& folder) {
  const DemoPlan plan;
  say("armsig demo: seven Puma 560, simulated as Stone, Sanderson and Neuman\n"
      "measured theirs (1986)\n\n{}\n",
      paragraph(fmt::format(
                    "Each joint is swept in turn as far as its limits allow, {} points a joint. An "
                    "ultrasonic sensor of 8 receivers, 0.2 mm (1 sigma) a range, {} pings a point, "
                    "locates a target on the moving link. On the arm this would take {}.",
                    plan.points, plan.pings, duration_in_words(robots[0].robot.sweep_duration_s)),
                0));
  print_tables_of_the_paper(robots);
  say("{}{}\n", tool_error_table(robots),
      paragraph(
          "Over the joint limits, each where the sensor sees it: the nominal model with base and "
          "tool fitted, the signatures as they are. Stated is what the signature says of "
          "itself, from the measurements alone."));
  say("Nominal model, sensor, measurements, signatures and truths are in {}/.\n"
      "Robot 1 again, by the command for your own arm:\n  {}\n",
      options.out, identify_again(folder).text());
  if (report) say("\nNext: open the report of robot 1 in a browser: {}\n", *report);
}

Attempt<ExitStatus> run(const DemoOptions& options) {
  ARMSIG_TRY(folder, DemoFolder::create(options.out));
  if (auto written = write_descriptions(folder); !written) {
    return std::unexpected(std::move(written).error());
  }
  std::vector<DemoResult> robots;
  {
    Progress progress("Identifying seven arms", kRobots);
    for (std::size_t k = 0; k < kRobots; ++k) {
      progress.update(k);
      ARMSIG_TRY(result, run_robot(k, options.seed + k, folder));
      robots.push_back(std::move(result));
    }
  }
  ARMSIG_TRY(report, write_report(folder));
  for (const DemoResult& result : robots) {
    for (const std::string& warning : result.encoder.record.warnings) {
      complain("armsig: warning: {}: {}", result.robot.name, shown(warning));
    }
  }
  if (options.json) {
    auto json = demo_json(robots);
    json["files"] = folder.files();
    json["report"] = report ? nlohmann::ordered_json(*report) : nullptr;
    print_json(json);
  } else {
    print_story(robots, report, options, folder);
  }
  return kDone;
}

}  // namespace

void add_demo(CLI::App& app, int& status) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = app.add_subcommand("demo", "the whole story on a simulated Puma 560");
  command->add_option("-o,--out", options->out, "folder for the report and the files it is made of")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "of the sensor's noise")->capture_default_str();
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
