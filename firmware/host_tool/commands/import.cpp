// SPDX-License-Identifier: MIT
// armsig import: an arm description out of the file of other software.
#include "firmware/host_tool/imports/import.hpp"

#include <string>
#include <vector>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"

namespace armsig::tool {
namespace {

struct ImportOptions : CommonOptions {
  std::string urdf, base, tip, dh, name, out;
};

int run(const ImportOptions& options) {
  const auto apart =
      check_roles({{"--urdf", options.urdf}, {"--dh", options.dh}}, {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto name = check_option_text("--name", options.name);
  if (!name) return fail(name.error(), kBadInput, options);
  auto imported = options.urdf.empty() ? import_dh(options.dh)
                                       : import_urdf(options.urdf, options.base, options.tip);
  if (!imported) return fail(imported.error(), kBadInput, options);
  if (!options.name.empty()) imported->description.name = options.name;
  const auto written = write_arm_file(options.out, imported->description);
  if (!written) return fail(written.error(), kBadInput, options);
  if (options.json) {
    print_json({{"status", 0},
                {"arm", imported->description.name},
                {"joints", imported->description.arm.joints.size()},
                {"joint_names", imported->description.joint_names},
                {"notes", imported->notes},
                {"out", options.out}});
    return kDone;
  }
  say("{}\n\n{}", imported->description.name, dh_table(imported->description.arm.joints));
  std::vector<std::string> joints;
  for (const std::string& joint : imported->description.joint_names) {
    joints.push_back(fmt::format("{} is {}", joints.size() + 1, joint));
  }
  say("\n{}", paragraph(all_of(joints)));
  for (const std::string& note : imported->notes) say("{}", paragraph("Note: " + note + "."));
  say("\nWritten: {}\nNext: armsig plan --arm {} --out sweeps-to-measure.csv\n",
      file_in_words(options.out), file_or(options.out, "arm.yaml"));
  return kDone;
}

}  // namespace

void add_import(CLI::App& app, int& status) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      app.add_subcommand("import", "make an arm description from URDF or Denavit-Hartenberg rows");
  CLI::Option* urdf = command->add_option("--urdf", options->urdf, "robot description (URDF)");
  CLI::Option* base = command->add_option("--base", options->base, "link that joint 1 stands on");
  CLI::Option* tip = command->add_option("--tip", options->tip, "last link");
  CLI::Option* dh = command->add_option("--dh", options->dh,
                                        "standard or modified Denavit-Hartenberg rows (CSV)");
  urdf->needs(base)->needs(tip)->excludes(dh);
  base->needs(urdf);
  tip->needs(urdf);
  command->add_option("--name", options->name, "name of the arm, instead of the file's");
  command->add_option("--out", options->out, "arm description to write (YAML)")->required();
  add_common(*command, *options);
  command->callback([options, urdf, dh, &status] {
    if (urdf->count() + dh->count() == 0) throw CLI::RequiredError("--urdf or --dh");
    status = run(*options);
  });
}

}  // namespace armsig::tool
