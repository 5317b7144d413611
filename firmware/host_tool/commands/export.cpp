// SPDX-License-Identifier: MIT
// armsig export: a signature for other software, or into the robot's own model.
#include "firmware/host_tool/exports/export.hpp"

#include <vector>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/standard_output.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/exports/urdf_correction.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

Problem several_files() {
  return {"--out", 0, 0, "several files can't go to standard output", "the name of a file"};
}

struct ExportOptions : CommonOptions {
  std::string signature, format, into, base, tip, out;
};

void tell_loss(std::string_view format, bool tables, double rms_m, double largest_m) {
  complain(
      "armsig: warning: {} cannot say {}; its geometry is the best without: {:.3f} mm RMS at the "
      "tool are lost, {:.3f} at most, over the readings measured",
      format, tables ? "gravity" : "gravity and the joint error maps", 1e3 * rms_m,
      1e3 * largest_m);
}

void say_what_reads(const std::string& urdf) {
  if (is_there_to_read(urdf)) say_next(TypedCommand::of_program("check_urdf").file(urdf));
}

void say_what_is_next(const ExportOptions& options) {
  if (options.format == "urdf") {
    say_what_reads(options.out);
  } else if (options.format == "json") {
    say("Next: read it by any program; docs/formats.md names its keys\n");
  } else {
    say("Next: read its first lines: they say what loads it, and how\n");
  }
}

int run_format(const ExportOptions& options, const SignatureRecord& record) {
  const auto exported = in_file(options.signature, export_text(options.format, record));
  if (!exported) return fail(exported.error(), kNoAnswer, options);
  if (options.out == kStandardOutput && !exported->companions.empty()) {
    return fail(several_files(), kBadInput, options);
  }
  std::vector<std::string> files{options.out};
  std::vector<const std::string*> texts{&exported->text};
  for (const Companion& companion : exported->companions) {
    files.push_back(options.out + companion.suffix);
    texts.push_back(&companion.text);
  }
  for (std::size_t k = 0; k < files.size(); ++k) {
    const auto written = write_text_file(files[k], *texts[k]);
    if (!written) return fail(written.error(), kBadInput, options);
  }
  if (exported->lost_rms_m > 0) {
    tell_loss(options.format, !exported->companions.empty(), exported->lost_rms_m,
              exported->lost_largest_m);
  }
  if (options.json) {
    print_json({{"status", 0},
                {"format", options.format},
                {"joints", record.signature.joint_count()},
                {"out", options.out},
                {"files", files},
                {"lost_rms_m", exported->lost_rms_m},
                {"lost_largest_m", exported->lost_largest_m}});
  } else {
    say("{}: {} as {}\n", record.arm_name, counted(record.signature.joint_count(), "joint"),
        options.format);
    for (const std::string& file : files) say("Written: {}\n", file_in_words(file));
    say_what_is_next(options);
  }
  return kDone;
}

// --- Into the robot's own model -------------------------------------------------------------

// The origins as a person pastes them into the xacro that the file was made from.
std::string lines_to_paste(const CorrectedUrdf& corrected) {
  std::string text = fmt::format("Origins of the joints, to paste into {}:\n",
                                 shown(corrected.made_by_xacro_from));
  for (const CorrectedJoint& joint : corrected.joints) {
    text += fmt::format("\n{}\n  {}\n", shown(joint.name), joint.origin);
  }
  return text;
}

void print_corrected(const ExportOptions& options, const SignatureRecord& record,
                     const CorrectedUrdf& corrected, const std::vector<std::string>& files) {
  Table table({"Joint", "Origin moved, mm", "turned, deg"});
  for (const CorrectedJoint& joint : corrected.joints) {
    table.add_row({joint.name, fmt::format("{:.3f}", 1e3 * joint.moved_m),
                   fmt::format("{:.3f}", degrees(joint.turned_rad))});
  }
  say("{}: {} corrected from {} to {}\n\n{}\nEverything else in the file is as it was.\n",
      record.arm_name, options.into, corrected.base, corrected.tip, table.render());
  for (const std::string& file : files) say("Written: {}\n", file_in_words(file));
  if (files.size() > 1) {
    say("Next: paste the origins of {} into {}\n", files.back(), corrected.made_by_xacro_from);
  } else {
    say_what_reads(options.out);
  }
}

void print_corrected_json(const ExportOptions& options, const CorrectedUrdf& corrected,
                          const std::vector<std::string>& files, const Carried& carried) {
  auto joints = nlohmann::ordered_json::array();
  for (const CorrectedJoint& joint : corrected.joints) {
    joints.push_back({{"name", joint.name},
                      {"moved_m", joint.moved_m},
                      {"turned_rad", joint.turned_rad},
                      {"origin", joint.origin}});
  }
  print_json({{"status", 0},
              {"into", options.into},
              {"base", corrected.base},
              {"tip", corrected.tip},
              {"joints", joints},
              {"out", options.out},
              {"files", files},
              {"lost_rms_m", carried.lost_rms_m},
              {"lost_largest_m", carried.lost_largest_m}});
}

int run_into(const ExportOptions& options, const SignatureRecord& record) {
  const auto text = read_text_file(options.into, kLargestUrdf);
  if (!text) return fail(text.error(), kBadInput, options);
  const auto carried = in_file(options.signature, exportable("urdf", Carries::kGeometry, record));
  if (!carried) return fail(carried.error(), kNoAnswer, options);
  const auto corrected =
      in_file(options.into, corrected_urdf(*text, {options.base, options.tip}, carried->record));
  if (!corrected) return fail(corrected.error(), kBadInput, options);
  if (options.out == kStandardOutput && !corrected->made_by_xacro_from.empty()) {
    return fail(several_files(), kBadInput, options);
  }
  std::vector<std::string> files{options.out};
  auto written = write_text_file(options.out, corrected->text);
  if (written && !corrected->made_by_xacro_from.empty()) {
    files.push_back(options.out + ".origins.txt");
    written = write_text_file(files.back(), lines_to_paste(*corrected));
  }
  if (!written) return fail(written.error(), kBadInput, options);
  if (carried->lost_rms_m > 0) {
    tell_loss("urdf", false, carried->lost_rms_m, carried->lost_largest_m);
  }
  if (options.json) {
    print_corrected_json(options, *corrected, files, *carried);
  } else {
    print_corrected(options, record, *corrected, files);
  }
  return kDone;
}

int run(const ExportOptions& options) {
  const auto apart = check_roles({{"--signature", options.signature}, {"--into", options.into}},
                                 {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  return options.into.empty() ? run_format(options, *record) : run_into(options, *record);
}

}  // namespace

void add_export(CLI::App& app, int& status) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      app.add_subcommand("export", "write a signature for other software, or into your URDF");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  CLI::Option* format = command->add_option("--format", options->format, "what to write")
                            ->transform(CLI::IsMember(export_formats(), CLI::ignore_case));
  CLI::Option* into =
      command
          ->add_option("--into", options->into,
                       "your robot's URDF: written to --out with the origins of its joints "
                       "corrected, all else as it is")
          ->excludes(format);
  CLI::Option* base = command->add_option("--base", options->base,
                                          "link of that file that joint 1 stands on (default: as "
                                          "the joints are called)");
  CLI::Option* tip = command->add_option("--tip", options->tip, "its last link");
  base->needs(into)->needs(tip);
  tip->needs(into)->needs(base);
  command->add_option("-o,--out", options->out, "file to write")->required();
  add_common(*command, *options);
  command->callback([options, format, into, &status] {
    if (format->count() + into->count() == 0) throw CLI::RequiredError("--format or --into");
    status = run(*options);
  });
}

}  // namespace armsig::tool
