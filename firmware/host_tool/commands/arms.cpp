// SPDX-License-Identifier: MIT
// armsig arms: the arms whose drawing comes with the command.
#include <fmt/core.h>

#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

struct ArmsOptions : CommonOptions {
  std::string show;
};

int show(const ArmsOptions& options) {
  if (const KnownArm* arm = find_known_arm(options.show)) {
    say("{}", arm->text);
    return kDone;
  }
  return fail({options.show, 0, 0, "no known arm",
               known_arm_like(options.show, "a name that `armsig arms` lists")},
              kBadInput, options);
}

int list(const ArmsOptions& options) {
  auto listed = nlohmann::ordered_json::array();
  if (!options.json) say("  {:<12} {}\n", "--arm", "Arm");
  for (const KnownArm& arm : known_arms()) {
    const auto description = parse_arm(arm.text, arm.name);
    if (!description) return fail(description.error(), kBadInput, options);
    if (options.json) {
      listed.push_back({{"name", arm.name},
                        {"arm", description->name},
                        {"joints", description->arm.joints.size()},
                        {"source", source_of(arm)}});
    } else {
      say("  {:<12} {}, {}\n", arm.name, description->name,
          counted(description->arm.joints.size(), "joint"));
    }
  }
  if (options.json) {
    print_json({{"status", 0}, {"arms", listed}});
  } else {
    say("\nNominal models: check lengths, zeros and senses against the papers of your arm.\n");
    say("--show prints one with its source, to copy and change.\n");
    say_next(TypedCommand("arms").option("--show", known_arms().front().name));
  }
  return kDone;
}

}  // namespace

void add_arms(CLI::App& app, int& status) {
  auto options = std::make_shared<ArmsOptions>();
  CLI::App* command =
      app.add_subcommand("arms", "arms whose nominal model is known, for --arm NAME");
  command->add_option("--show", options->show,
                      "print the arm description of that name, and its source");
  add_common(*command, *options);
  command->callback(
      [options, &status] { status = options->show.empty() ? list(*options) : show(*options); });
}

}  // namespace armsig::tool
