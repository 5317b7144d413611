// SPDX-License-Identifier: MIT
// armsig export: a signature for other software.
#include "firmware/host_tool/exports/export.hpp"

#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/signature/model.hpp"

namespace armsig::tool {
namespace {

struct ExportOptions : CommonOptions {
  std::string signature, format, out;
};

int run(const ExportOptions& options) {
  const auto apart = check_roles({{"--signature", options.signature}}, {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const auto text = in_file(options.signature, export_text(options.format, *record));
  if (!text) return fail(text.error(), kNoAnswer, options);
  const auto written = write_text_file(options.out, *text);
  if (!written) return fail(written.error(), kBadInput, options);
  const double lost_m = deflection_rms_m(*record);
  if (lost_m > 0) {
    say(stderr,
        "armsig: warning: gravity and the maps of the readings cannot be said in {}: {:.3f} "
        "mm RMS at the tool are lost\n",
        options.format, 1e3 * lost_m);
  }
  if (options.json) {
    print_json({{"status", 0},
                {"format", options.format},
                {"joints", record->signature.joint_count()},
                {"out", options.out}});
  } else {
    say("{}: {} joints as {}\nWritten: {}\n", record->arm_name, record->signature.joint_count(),
        options.format, options.out);
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
