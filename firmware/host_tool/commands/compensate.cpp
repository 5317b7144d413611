// SPDX-License-Identifier: MIT
// armsig compensate: what a closed controller must be told so that the real arm arrives.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/frames_file.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/controller_options.hpp"
#include "firmware/host_tool/commands/seeds.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/programs/correct_poses.hpp"
#include "firmware/host_tool/programs/correct_program.hpp"
#include "firmware/host_tool/programs/left_in_words.hpp"
#include "firmware/host_tool/programs/program_picture.hpp"

namespace armsig::tool {
namespace {

struct CompensateOptions : CommonOptions {
  std::string signature, poses, into, seed, language, picture, frames_file, out;
  ControllerOptions controller;
  std::vector<std::string> tools, frames;
  double most_mm = 20;
  bool check = false;
};

struct Sizes {
  std::size_t count = 0;
  double largest = 0;
  double sum = 0;

  void add(double size) {
    ++count;
    sum += size;
    largest = std::max(largest, size);
  }
  [[nodiscard]] double mean() const { return count == 0 ? 0 : sum / static_cast<double>(count); }
};

// Those of the command line come before those of the file.
Read<GivenFrames> frames_given(std::string_view option, const std::vector<std::string>& texts,
                               const std::vector<NamedPose>& of_file) {
  GivenFrames given;
  for (const std::string& text : texts) {
    if (auto added = given.add(option, text, of_file); !added) {
      return std::unexpected(std::move(added).error());
    }
  }
  given.add_all(of_file);
  return given;
}

Read<ControllerView> view_of(const CompensateOptions& options, const Arm& nominal,
                             const Compensation& compensation) {
  ControllerView view;
  view.compensation = &compensation;
  view.nominal = &nominal;
  ARMSIG_TRY(X_0C, options.controller.base_in_frame_0());
  ARMSIG_TRY(X_nE, options.controller.flange_in_last_frame());
  view.X_0C = X_0C;
  view.X_nE = X_nE;
  FramesFile file;
  if (!options.frames_file.empty()) {
    ARMSIG_TRY(read, read_frames_file(options.frames_file));
    file = std::move(read);
  }
  ARMSIG_TRY(tools, frames_given("--tool", options.tools, file.tools));
  ARMSIG_TRY(frames, frames_given("--frame", options.frames, file.work_objects));
  view.frames = {std::move(tools), std::move(frames)};
  return view;
}

// --- What is said -----------------------------------------------------------------------------

struct Summary {
  Sizes moved_m, missed_m;
  std::size_t singular = 0;
  std::size_t words = 0;

  void add(const CorrectedTarget& target) {
    const Correction& correction = target.correction;
    if (correction.why != Uncorrected::kNone) return;
    moved_m.add(correction.moved_m);
    missed_m.add(correction.missed_m);
    if (correction.singular) ++singular;
    if (!target.words.empty()) ++words;
  }
};

std::string size_in_words(const Correction& correction) {
  return fmt::format("{:.3f} mm, {:.3f} deg", 1e3 * correction.moved_m,
                     degrees(correction.turned_rad));
}

// Near a singularity, and changes of the configuration's words: named, and corrected.
std::vector<std::string> remarks_on(const std::vector<CorrectedTarget>& targets,
                                    std::string_view place) {
  std::vector<std::string> remarks;
  for (const CorrectedTarget& target : targets) {
    if (target.correction.why != Uncorrected::kNone) continue;
    if (target.correction.singular) {
      remarks.push_back(
          fmt::format("{} {}: {} is near a singularity; correction {}, a joint moves by {:.1f} deg",
                      place, target.line, target.name, size_in_words(target.correction),
                      degrees(target.correction.joint_change_rad)));
    }
    if (!target.words.empty()) {
      remarks.push_back(fmt::format("{} {}: {} gets the configuration {}; correction {}", place,
                                    target.line, target.name, target.words,
                                    size_in_words(target.correction)));
    }
  }
  return remarks;
}

void warn_each(const std::string& file, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    complain("armsig: warning: {}: {}", file, warning);
  }
}

nlohmann::ordered_json json_of(const Sizes& sizes) {
  return {{"largest_m", sizes.largest}, {"mean_m", sizes.mean()}};
}

nlohmann::ordered_json json_of(const std::vector<CorrectedTarget>& targets,
                               std::string_view place) {
  auto list = nlohmann::ordered_json::array();
  for (const CorrectedTarget& target : targets) {
    const Correction& correction = target.correction;
    nlohmann::ordered_json one{{std::string(place), target.line},
                               {"name", target.name},
                               {"corrected", correction.why == Uncorrected::kNone}};
    one["moved_m"] = correction.moved_m;
    one["turned_rad"] = correction.turned_rad;
    one["missed_without_m"] = correction.missed_m;
    one["singular"] = correction.singular;
    one["readings"] = std::vector<double>(correction.readings.begin(), correction.readings.end());
    if (correction.why != Uncorrected::kNone) one["refused"] = describe(correction.why);
    list.push_back(std::move(one));
  }
  return list;
}

// `what`: one of those that were to be corrected.
void print_summary(const Summary& summary, std::size_t refused, std::string_view what) {
  say("{} corrected: by {:.3f} mm at the tool in the mean, {:.3f} mm at most\n",
      counted(summary.moved_m.count, what), 1e3 * summary.moved_m.mean(),
      1e3 * summary.moved_m.largest);
  say("without it the tool misses {} by {:.3f} mm in the mean, {:.3f} mm at most\n",
      summary.moved_m.count == 1 ? "it" : "them", 1e3 * summary.missed_m.mean(),
      1e3 * summary.missed_m.largest);
  if (refused > 0) say("{} of the {}s left uncorrected\n", refused, what);
}

// --- Programs ---------------------------------------------------------------------------------

struct Checked {
  Arrivals before;
  Arrivals after;  // of the corrected program; empty where none was written
};

// How far from its target of the original program the tool arrives, by line and name.
Sizes distances(const Arrivals& meant, const Arrivals& run) {
  Sizes sizes;
  for (const Arrival& arrival : run.arrivals) {
    const auto target = std::ranges::find_if(meant.arrivals, [&](const Arrival& one) {
      return one.line == arrival.line && one.name == arrival.name;
    });
    if (target != meant.arrivals.end()) sizes.add((arrival.X_CA.p - target->X_CT.p).norm());
  }
  return sizes;
}

void print_check(const Checked& checked, bool corrected) {
  Table table(corrected ? std::vector<std::string>{"Target", "line", "x, mm", "y, mm", "z, mm",
                                                   "missed, mm", "corrected, mm"}
                        : std::vector<std::string>{"Target", "line", "x, mm", "y, mm", "z, mm",
                                                   "missed, mm"});
  const auto mm = [](double length_m) { return fmt::format("{:.3f}", 1e3 * length_m); };
  const Arrivals& run = corrected ? checked.after : checked.before;
  const bool paired = checked.after.arrivals.size() == checked.before.arrivals.size();
  for (std::size_t k = 0; k < run.arrivals.size() && (!corrected || paired); ++k) {
    const Arrival& before = checked.before.arrivals[k];
    const Vector3& p = run.arrivals[k].X_CA.p;
    std::vector<std::string> row{before.name, std::to_string(before.line),
                                 mm(p.x()),   mm(p.y()),
                                 mm(p.z()),   mm((before.X_CA.p - before.X_CT.p).norm())};
    if (corrected) row.push_back(mm((p - before.X_CT.p).norm()));
    table.add_row(std::move(row));
  }
  say("Where the tool goes, in the controller's base:\n\n{}\n", table.render());
}

nlohmann::ordered_json json_of(const Checked& checked, bool corrected) {
  nlohmann::ordered_json json{{"missed", json_of(distances(checked.before, checked.before))}};
  if (corrected) json["corrected"] = json_of(distances(checked.before, checked.after));
  auto places = nlohmann::ordered_json::array();
  for (const Arrival& arrival : (corrected ? checked.after : checked.before).arrivals) {
    const Vector3& p = arrival.X_CA.p;
    places.push_back(
        {{"line", arrival.line}, {"name", arrival.name}, {"p_m", {p.x(), p.y(), p.z()}}});
  }
  json["tool"] = std::move(places);
  return json;
}

Read<const Language*> language_for(const CompensateOptions& options) {
  for (const Language& language : languages()) {
    if (options.language == language.name) return &language;
  }
  if (const Language* language = language_of(options.into)) return language;
  std::vector<std::string> known;
  for (const Language& language : languages()) {
    known.push_back(fmt::format("{} ({})", language.name, language.suffixes));
  }
  return std::unexpected(Problem{options.into, 0, 0, "its name does not say its language",
                                 "--language, or a file of " + any_of(known)});
}

Read<void> draw(const CompensateOptions& options, const Checked& checked) {
  if (options.picture.empty() || checked.before.arrivals.empty()) return {};
  const bool corrected = !checked.after.arrivals.empty();
  return write_text_file(options.picture,
                         program_picture({checked.before, corrected ? &checked.after : nullptr},
                                         "Where the tool goes: " + options.into));
}

Attempt<ExitStatus> check_alone(const CompensateOptions& options, const std::string& text,
                                const Language& language, const ControllerView& view) {
  const Checked checked{arrivals_of(text, language, view), {}};
  warn_each(options.into, left_in_runs(checked.before.left, "line"));
  if (checked.before.arrivals.empty()) {
    return no_answer(
        {options.into, 0, 0, "it has no target that both models reach", "a program with targets"});
  }
  if (auto drawn = draw(options, checked); !drawn) return std::unexpected(std::move(drawn).error());
  if (options.json) {
    nlohmann::ordered_json json{{"status", 0}, {"into", options.into}};
    json.update(json_of(checked, false));
    json["left"] = left_in_words(checked.before.left, "line");
    print_json(json);
  } else {
    print_check(checked, false);
  }
  return kDone;
}

void print_program(const CompensateOptions& options, const CorrectedProgram& program,
                   const Checked& checked, const Summary& summary) {
  const auto left = left_in_words(program.left, "line");
  auto remarks = remarks_on(program.targets, "line");
  warn_each(options.into, remarks);
  std::ranges::copy(remarks_in_words(program.left, "line"), std::back_inserter(remarks));
  warn_each(options.into, left_in_runs(program.left, "line"));
  if (options.json) {
    nlohmann::ordered_json json{{"status", 0},
                                {"into", options.into},
                                {"corrected", summary.moved_m.count},
                                {"left", left},
                                {"warnings", remarks},
                                {"correction", json_of(summary.moved_m)},
                                {"targets", json_of(program.targets, "line")},
                                {"out", options.out}};
    if (options.check) json["check"] = json_of(checked, true);
    print_json(json);
    return;
  }
  if (options.check) print_check(checked, true);
  print_summary(summary, left.size(), "target");
  say("Everything else in the program is as it was. Written: {}\n", file_in_words(options.out));
  if (!options.picture.empty()) say("Picture: {}\n", file_in_words(options.picture));
}

Problem none_corrected(const CompensateOptions& options, const CorrectedProgram& program) {
  if (count_left(program.left) == 0) {
    return {options.into, 0, 0, "no target is written in it", "a program with targets"};
  }
  return {options.into, 0, 0, "none of its targets can be corrected",
          program.tried == 0 ? "targets that are written in it, with their tool and frame"
                             : "a program with targets that both models reach"};
}

Attempt<ExitStatus> run_program(const CompensateOptions& options, const ControllerView& view) {
  ARMSIG_TRY(language, language_for(options));
  ARMSIG_TRY(text, read_text_file(options.into, kLargestProgram));
  if (options.out.empty()) return check_alone(options, text, *language, view);
  const CorrectedProgram program = corrected_program(text, *language, view);
  Summary summary;
  for (const CorrectedTarget& target : program.targets) summary.add(target);
  if (summary.moved_m.count == 0) {
    warn_each(options.into, left_in_runs(program.left, "line"));
    return no_answer(none_corrected(options, program));
  }
  Checked checked;
  if (options.check || !options.picture.empty()) {
    checked = {arrivals_of(text, *language, view), arrivals_of(program.text, *language, view)};
  }
  if (auto written = write_text_file(options.out, program.text); !written) {
    return std::unexpected(std::move(written).error());
  }
  if (auto drawn = draw(options, checked); !drawn) return std::unexpected(std::move(drawn).error());
  print_program(options, program, checked, summary);
  return kDone;
}

// --- Poses ------------------------------------------------------------------------------------

// A file of frames has many, and poses have no names.
Read<void> check_tool_of_poses(const CompensateOptions& options) {
  if (options.frames_file.empty() || !options.tools.empty()) return {};
  return std::unexpected(Problem{options.frames_file, 0, 0,
                                 "poses do not say which tool they are of", "--tool with a name"});
}

Attempt<ExitStatus> run_poses(const CompensateOptions& options, const SignatureRecord& record,
                              const ControllerView& view, const std::vector<JointVector>& seeds) {
  if (auto tool = check_tool_of_poses(options); !tool) {
    return std::unexpected(std::move(tool).error());
  }
  ARMSIG_TRY(poses, read_tool_poses(options.poses));
  if (seeds.size() > 1 && seeds.size() != poses.size()) {
    return std::unexpected(
        Problem{options.seed, 0, 0, fmt::format("{} seeds", seeds.size()),
                fmt::format("one, or one for each of the {} poses", poses.size())});
  }
  const CorrectedPoses result = corrected_poses(poses, view, seeds);
  Summary summary;
  for (const CorrectedTarget& target : result.targets) summary.add(target);
  const auto left = left_in_words(result.left, "pose");
  warn_each(options.poses, left_in_runs(result.left, "pose"));
  if (summary.moved_m.count == 0) {
    return no_answer({options.poses, 0, 0, "none of its poses can be corrected",
                      "poses in the controller's base that both models reach"});
  }
  const std::string title = fmt::format("{}: the poses to give the controller for those of {}",
                                        record.arm_name, options.poses);
  if (auto written = write_tool_poses(options.out, result.poses, title); !written) {
    return std::unexpected(std::move(written).error());
  }
  const auto remarks = remarks_on(result.targets, "row");
  warn_each(options.poses, remarks);
  if (options.json) {
    print_json({{"status", 0},
                {"poses", options.poses},
                {"corrected", summary.moved_m.count},
                {"left", left},
                {"warnings", remarks},
                {"correction", json_of(summary.moved_m)},
                {"targets", json_of(result.targets, "row")},
                {"out", options.out}});
    return kDone;
  }
  print_summary(summary, left.size(), "pose");
  say("Written: {}\n", file_in_words(options.out));
  return kDone;
}

// --- The command ------------------------------------------------------------------------------

// Programs move six revolute joints; poses of seven are reached in many ways.
Attempt<ExitStatus> check_joints(const CompensateOptions& options, const SignatureRecord& record) {
  const JointTypes& types = record.signature.types;
  const bool turn =
      std::ranges::all_of(types, [](JointType type) { return type == JointType::kRevolute; });
  const bool fits = options.into.empty() ? types.size() <= 6 : types.size() == 6 && turn;
  if (fits) return kDone;
  return no_answer({options.signature, 0, 0, fmt::format("an arm of {} joints", types.size()),
                    options.into.empty() ? "six joints or fewer: more reach a pose in many ways"
                                         : "six revolute joints, which these languages move"});
}

// With --check alone no program is written.
Read<void> check_files(const CompensateOptions& options) {
  const std::initializer_list<FileRole> read = {{"--signature", options.signature},
                                                {"--poses", options.poses},
                                                {"--into", options.into},
                                                {"--seed", options.seed},
                                                {"--frames", options.frames_file}};
  const FileRole picture{"--picture", options.picture};
  if (options.out.empty()) return check_roles(read, {picture});
  return check_roles(read, {{"--out", options.out}, picture});
}

Attempt<ExitStatus> run(const CompensateOptions& options) {
  if (auto apart = check_files(options); !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(fits, check_joints(options, record));
  (void)fits;
  ARMSIG_TRY(nominal, options.controller.nominal_model(record));
  const Compensation compensation(record, nominal, {.most_m = 1e-3 * options.most_mm});
  ARMSIG_TRY(view, view_of(options, nominal, compensation));
  ARMSIG_TRY(seeds, read_seeds(options.seed, record));
  if (!options.poses.empty()) return run_poses(options, record, view, seeds);
  if (!seeds.empty()) view.start = seeds.front();
  return run_program(options, view);
}

void add_frame_options(CLI::App& command, CompensateOptions& options) {
  command
      .add_option("--tool", options.tools,
                  "tool on the controller's flange: x,y,z in mm and rotations about z,y,x in "
                  "degrees; x,y,z and a quaternion; or p[...]. NAME=... of one of a program's")
      ->allow_extra_args(false);
  command
      .add_option("--frame", options.frames, "work object in the controller's base, written alike")
      ->allow_extra_args(false);
  command.add_option(
      "--frames", options.frames_file,
      "tools and work objects by name (YAML), as --out of `armsig frames` writes them; "
      "--tool and --frame take a name of it too");
  add_controller_options(command, options.controller);
}

// Those of programs alone.
void add_program_options(CLI::App& command, CompensateOptions& options, CLI::Option* into) {
  command.add_option("--language", options.language, "of the program (default: by its name)")
      ->transform(
          CLI::IsMember({"urscript", "rapid", "krl", "fanuc", "jbi", "gcode"}, CLI::ignore_case))
      ->needs(into);
  command
      .add_flag("--check", options.check,
                "run the program through both models: where the tool goes")
      ->needs(into);
  command
      .add_option("--picture", options.picture,
                  "picture of the program before and after, to be written (SVG)")
      ->needs(into);
}

}  // namespace

void add_compensate(CLI::App& app, int& status) {
  auto options = std::make_shared<CompensateOptions>();
  CLI::App* command = app.add_subcommand(
      "compensate", "what a closed controller must be given so that the arm arrives");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  CLI::Option* poses = command->add_option("--poses", options->poses,
                                           "tool poses to correct (CSV: x_m, ..., qw, ...)");
  CLI::Option* into =
      command
          ->add_option("--into", options->into,
                       "robot program: written to --out with its targets corrected, all else as "
                       "it is (KRL .src and .dat, RAPID .mod, URScript .script, FANUC .ls, Yaskawa "
                       ".jbi, LinuxCNC .ngc)")
          ->excludes(poses);
  add_program_options(*command, *options, into);
  add_frame_options(*command, *options);
  command->add_option("--seed", options->seed,
                      "joint readings (CSV): of a program where it begins; of poses one row, or "
                      "one a pose: the solution nearest to them is taken");
  command
      ->add_option("--most-mm", options->most_mm,
                   "a target whose correction is larger is left as it is")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  CLI::Option* out = command->add_option("-o,--out", options->out, "file to write");
  add_common(*command, *options);
  command->callback([options, poses, into, out, &status] {
    if (poses->count() + into->count() == 0) throw CLI::RequiredError("--poses or --into");
    if (out->count() == 0 && !options->check) throw CLI::RequiredError("--out");
    if (out->count() != 0 && options->out.empty()) throw CLI::RequiredError("--out");
    status = status_of(run(*options), *options);
  });
}

}  // namespace armsig::tool
