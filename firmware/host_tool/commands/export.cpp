// SPDX-License-Identifier: MIT
// armsig export: a signature for other software.
#include "firmware/host_tool/exports/export.hpp"

#include <vector>

#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

struct ExportOptions : CommonOptions {
  std::string signature, format, out;
};

void tell_loss(const ExportOptions& options, const Exported& exported) {
  say(stderr,
      "armsig: warning: {} cannot say {}; its geometry is the best without: {:.3f} mm RMS at the "
      "tool are lost, {:.3f} at most, over the readings measured\n",
      options.format,
      exported.companions.empty() ? "gravity and the maps of the readings" : "gravity",
      1e3 * exported.lost_rms_m, 1e3 * exported.lost_largest_m);
}

int run(const ExportOptions& options) {
  const auto apart = check_roles({{"--signature", options.signature}}, {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const auto exported = in_file(options.signature, export_text(options.format, *record));
  if (!exported) return fail(exported.error(), kNoAnswer, options);
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
  if (exported->lost_rms_m > 0) tell_loss(options, *exported);
  if (options.json) {
    print_json({{"status", 0},
                {"format", options.format},
                {"joints", record->signature.joint_count()},
                {"out", options.out},
                {"files", files},
                {"lost_rms_m", exported->lost_rms_m},
                {"lost_largest_m", exported->lost_largest_m}});
  } else {
    say("{}: {} joints as {}\n", record->arm_name, record->signature.joint_count(), options.format);
    for (const std::string& file : files) say("Written: {}\n", file);
  }
  return kDone;
}

}  // namespace

void add_export(CLI::App& app, int& status) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "write a signature for other software");
  command->add_option("--signature", options->signature, "signature (YAML)")->required();
  command->add_option("--format", options->format, "what to write")
      ->required()
      ->check(CLI::IsMember(export_formats()));
  command->add_option("--out", options->out, "file to write")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
