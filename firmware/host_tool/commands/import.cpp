// SPDX-License-Identifier: MIT
// armsig import: an arm description out of the file of other software.
#include "firmware/host_tool/imports/import.hpp"

#include <array>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"

namespace armsig::tool {
namespace {

struct ImportOptions : CommonOptions {
  std::string urdf, base, tip, dh, ur_yaml, opw, name, out;

  // The one that is given.
  [[nodiscard]] const std::string& source() const {
    for (const std::string* file : {&urdf, &dh, &ur_yaml}) {
      if (!file->empty()) return *file;
    }
    return opw;
  }
};

Read<ImportedArm> import_from(const ImportOptions& options) {
  if (!options.urdf.empty()) return import_urdf(options.urdf, options.base, options.tip);
  if (!options.dh.empty()) return import_dh(options.dh);
  if (!options.ur_yaml.empty()) return import_ur_yaml(options.ur_yaml);
  return import_opw(options.opw);
}

// A problem with a line of the description is one of what it was made from: no file has that line.
Problem of_source(Problem problem, const ImportOptions& options) {
  if (problem.line == 0) return problem;
  problem.file = options.source();
  problem.line = problem.column = 0;
  return problem;
}

int run(const ImportOptions& options) {
  const auto apart = check_roles({{"--urdf", options.urdf},
                                  {"--dh", options.dh},
                                  {"--ur-yaml", options.ur_yaml},
                                  {"--opw", options.opw}},
                                 {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto name = check_option_text("--name", options.name);
  if (!name) return fail(name.error(), kBadInput, options);
  auto imported = import_from(options);
  if (!imported) return fail(imported.error(), kBadInput, options);
  if (!options.name.empty()) imported->description.name = options.name;
  const auto written = write_arm_file(options.out, imported->description);
  if (!written) return fail(of_source(written.error(), options), kBadInput, options);
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
  say("\nWritten: {}\n", file_in_words(options.out));
  if (!is_there_to_read(options.out)) return kDone;
  say_next(TypedCommand("plan")
               .file_option("--arm", options.out)
               .option("--out", "sweeps-to-measure.csv"));
  return kDone;
}

}  // namespace

void add_import(CLI::App& app, int& status) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      app.add_subcommand("import",
                         "make an arm description from URDF, Denavit-Hartenberg rows, or "
                         "the kinematics of Universal Robots or of opw_kinematics");
  CLI::Option* urdf = command->add_option("--urdf", options->urdf, "robot description (URDF)");
  CLI::Option* base = command->add_option("--base", options->base, "link that joint 1 stands on");
  CLI::Option* tip = command->add_option("--tip", options->tip, "last link");
  CLI::Option* dh = command->add_option("--dh", options->dh,
                                        "standard or modified Denavit-Hartenberg rows (CSV)");
  CLI::Option* ur_yaml = command->add_option(
      "--ur-yaml", options->ur_yaml,
      "kinematics of the drivers of Universal Robots (YAML), calibrated ones too");
  CLI::Option* opw =
      command->add_option("--opw", options->opw, "parameters of opw_kinematics (YAML)");
  urdf->needs(base)->needs(tip);
  const std::array sources{urdf, dh, ur_yaml, opw};
  for (std::size_t i = 0; i < sources.size(); ++i) {
    for (std::size_t k = i + 1; k < sources.size(); ++k) sources.at(i)->excludes(sources.at(k));
  }
  base->needs(urdf);
  tip->needs(urdf);
  command->add_option("--name", options->name, "name of the arm, instead of the file's");
  command->add_option("-o,--out", options->out, "arm description to write (YAML)")->required();
  add_common(*command, *options);
  command->callback([options, &status] {
    if (options->source().empty()) {
      throw CLI::RequiredError("--urdf, --dh, --ur-yaml or --opw");
    }
    status = run(*options);
  });
}

}  // namespace armsig::tool
