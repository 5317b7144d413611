// SPDX-License-Identifier: MIT
// armsig frames: tools and work objects as they were taught, by the found model.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/frames_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/controller_options.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/programs/program.hpp"
#include "firmware/host_tool/reading/beyond_limits.hpp"
#include "firmware/host_tool/report/uncertain_signature.hpp"
#include "firmware/host_tool/taught_frames/frames_report.hpp"
#include "firmware/host_tool/taught_frames/taught_frames.hpp"
#include "firmware/library/compensation.hpp"
#include "firmware/library/signature_chain.hpp"

namespace armsig::tool {
namespace {

struct FramesOptions : CommonOptions {
  std::string signature, points, columns, tool, out;
  std::string language = "krl";
  ControllerOptions controller;
  std::optional<int> target;
  double teach_sigma_mm = 0;
};

// The tip of the work objects, and the target of the signature where it is one.
struct ChosenTip {
  TouchingTip tip;
  std::optional<std::size_t> target;
};

Read<ChosenTip> tip_of_target(const FramesOptions& options, const SignatureRecord& record,
                              const ControllerFrames& controller) {
  ARMSIG_TRY(target, find_target(record, options.signature, options.target));
  const std::size_t joints = record.signature.joint_count();
  if (target->link != joints) {
    return std::unexpected(
        Problem{options.signature, 0, 0,
                fmt::format("target {} is on link {}", target->number, target->link),
                fmt::format("a target on the last link, {}", joints)});
  }
  ChosenTip chosen;
  chosen.tip.t_E = FoundFlange(record.signature, record.readings(), controller).target_E(*target);
  chosen.tip.words = fmt::format("target {}", target->number);
  const auto& targets = record.signature.targets;
  chosen.target = static_cast<std::size_t>(
      std::ranges::find(targets, target->number, &Target::number) - targets.begin());
  return chosen;
}

Read<ChosenTip> tip_by_name(const FramesOptions& options, const TaughtTask& task) {
  ChosenTip chosen;
  if (const auto frame = task.tool_called(options.tool)) {
    chosen.tip = {.frame = frame, .t_E = {}, .words = "tool " + options.tool};
    return chosen;
  }
  ARMSIG_TRY(X_ET, parse_frame("--tool", options.tool));
  chosen.tip = {.frame = {}, .t_E = X_ET.p, .words = "the tool of --tool"};
  return chosen;
}

// Which tool touched the points of the work objects: nothing is guessed.
Read<ChosenTip> chosen_tip(const FramesOptions& options, const TaughtTask& task,
                           const SignatureRecord& record, const ControllerFrames& controller) {
  const bool given = options.target || !options.tool.empty();
  if (!task.has(TaughtFrameKind::kWorkObject)) {
    if (!given) return ChosenTip{};
    return std::unexpected(Problem{options.points, 0, 0, "no work object is taught in it",
                                   "--tool and --target with points of one"});
  }
  if (options.target) return tip_of_target(options, record, controller);
  const std::vector<std::string> tools = task.tool_names();
  if (!options.tool.empty()) {
    auto chosen = tip_by_name(options, task);
    if (!chosen && !tools.empty()) {
      chosen.error().expected = any_of(tools) + ", or " + chosen.error().expected;
    }
    return chosen;
  }
  if (tools.size() == 1) {
    return ChosenTip{{.frame = task.tool_called(tools[0]), .t_E = {}, .words = "tool " + tools[0]},
                     {}};
  }
  return std::unexpected(
      Problem{options.points, 0, 0, "it does not say which tool touched the work objects",
              tools.empty() ? "--tool with the tool, --target with a target of the signature, or a "
                              "tool taught in the same file"
                            : "--tool with " + any_of(tools)});
}

struct TaughtInput {
  TaughtTask task;
  std::vector<JointVector> rows;
  std::vector<std::string> warnings;
};

Attempt<TaughtInput> read_input(const FramesOptions& options, const SignatureRecord& record) {
  ARMSIG_TRY(table, read_taught_points(options.points, options.columns,
                                       NamedJoints(record.signature.types, record.joint_names)));
  if (!table.mapped.empty()) say(stderr, "{}", table.mapped);
  TaughtInput input;
  for (const TaughtRow& row : table.rows) input.rows.push_back(row.q);
  if (const auto beyond = beyond_limits(record.nominal, input.rows)) {
    const auto line = static_cast<int>(table.rows[beyond->worst].line);
    if (beyond->out_of_question) {
      return no_answer({options.points, line, 0, beyond->words,
                        "readings in the unit that the column's name says; whole turns taken off "
                        "a joint that turns without an end"});
    }
    input.warnings.push_back(fmt::format("{} beyond the joint limits, farthest line {}: {}",
                                         counted(beyond->rows, "row"), line, beyond->words));
  }
  ARMSIG_TRY(task, taught_task(std::move(table.rows), options.points));
  input.task = std::move(task);
  return input;
}

Attempt<TaughtPoses> poses_by_models(const FramesOptions& options, const SignatureRecord& record,
                                     const ControllerFrames& controller,
                                     const std::vector<JointVector>& rows) {
  const Compensation models(record, controller.nominal);
  const FoundFlange found(record.signature, record.readings(), controller);
  TaughtPoses poses;
  for (const JointVector& q : rows) {
    const auto X_0n = models.nominal().forward(q);
    if (!X_0n) return no_answer({options.points, 0, 0, std::string(describe(X_0n.error())), ""});
    poses.found_X_CE.push_back(found.pose(q));
    poses.nominal_X_CE.push_back(controller.X_0C.inverse() * *X_0n * controller.X_nE);
  }
  return poses;
}

const Language& language_called(const std::string& name) {
  return *std::ranges::find(languages(), name, &Language::name);
}

Read<ControllerFrames> controller_of(const FramesOptions& options, const SignatureRecord& record) {
  ARMSIG_TRY(nominal, options.controller.nominal_model(record));
  ARMSIG_TRY(X_0C, options.controller.base_in_frame_0());
  ARMSIG_TRY(X_nE, options.controller.flange_in_last_frame());
  return ControllerFrames{.nominal = nominal, .X_0C = X_0C, .X_nE = X_nE};
}

// What the person is told, and a file where one is asked for.
Attempt<ExitStatus> tell(const FramesOptions& options, const TaughtTask& task,
                         const TaughtFrames& result) {
  for (const std::string& warning : result.warnings) {
    complain("armsig: warning: {}: {}", options.points, warning);
  }
  if (!options.out.empty()) {
    if (auto written = write_frames_file(options.out, file_of(task, result)); !written) {
      return std::unexpected(std::move(written).error());
    }
  }
  const Language& language = language_called(options.language);
  if (options.json) {
    auto json = json_of(task, result, language);
    if (!options.out.empty()) json["out"] = options.out;
    print_json(json);
    return kDone;
  }
  print_taught_frames(task, result, language);
  if (!options.out.empty()) say("Written: {}\n", file_in_words(options.out));
  return kDone;
}

// Without --out nothing is written.
Read<void> check_files(const FramesOptions& options) {
  if (options.out.empty()) return {};
  return check_roles({{"--signature", options.signature}, {"--points", options.points}},
                     {{"--out", options.out}});
}

Attempt<ExitStatus> run(const FramesOptions& options) {
  if (auto apart = check_files(options); !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(controller, controller_of(options, record));
  ARMSIG_TRY(input, read_input(options, record));
  ARMSIG_TRY(chosen, chosen_tip(options, input.task, record, controller));
  input.task.tip = chosen.tip;
  ARMSIG_TRY(poses, poses_by_models(options, record, controller, input.rows));
  const auto estimate = estimate_behind(record);
  std::optional<PoseDerivatives> derivatives;
  if (estimate != nullptr) {
    derivatives = pose_derivatives(*estimate, controller, input.rows, chosen.target);
  }
  auto result = taught_frames(input.task, poses, derivatives ? &*derivatives : nullptr,
                              1e-3 * options.teach_sigma_mm);
  if (!result) return no_answer(std::move(result).error());
  result->warnings.insert(result->warnings.begin(), input.warnings.begin(), input.warnings.end());
  return tell(options, input.task, *result);
}

void add_tip_options(CLI::App& command, FramesOptions& options) {
  CLI::Option* tool = command.add_option(
      "--tool", options.tool,
      "what touched the work objects: the name of a tool taught in the same file, or x,y,z in mm "
      "and rotations about z,y,x in degrees; x,y,z and a quaternion; or p[...] (default: the only "
      "tool of the file)");
  command.add_option("--target", options.target, "it was this target of the signature")
      ->excludes(tool);
}

void add_result_options(CLI::App& command, FramesOptions& options) {
  command
      .add_option("--teach-sigma-mm", options.teach_sigma_mm,
                  "how well a point was taught, 1 sigma of a coordinate (default: what the points "
                  "beyond the minimum miss by, else 0.1)")
      ->check(CLI::Range(1e-4, 100.0));
  command
      .add_option("--language", options.language,
                  "of the controller: orientations are written as its programs have them")
      ->transform(
          CLI::IsMember({"urscript", "rapid", "krl", "fanuc", "jbi", "gcode"}, CLI::ignore_case))
      ->capture_default_str();
}

}  // namespace

void add_frames(CLI::App& app, int& status) {
  auto options = std::make_shared<FramesOptions>();
  CLI::App* command = app.add_subcommand(
      "frames", "tools and work objects that were taught by touching points, by the found model");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  CLI::Option* points = command
                            ->add_option("--points", options->points,
                                         "taught joint readings (CSV: frame, point, q1_deg, ...)")
                            ->required();
  command
      ->add_option("--columns", options->columns,
                   "taught points of other software: auto, or frame=THEIR NAME,q1_deg=@3,...")
      ->needs(points);
  add_tip_options(*command, *options);
  add_result_options(*command, *options);
  add_controller_options(*command, options->controller);
  CLI::Option* out =
      command->add_option("-o,--out", options->out,
                          "file to write: the frames of the found model by their names (YAML), for "
                          "--frames of `armsig compensate`");
  add_common(*command, *options);
  command->callback([options, out, &status] {
    if (out->count() != 0 && options->out.empty()) throw CLI::RequiredError("--out");
    status = status_of(run(*options), *options);
  });
}

}  // namespace armsig::tool
