// SPDX-License-Identifier: MIT
// armsig evaluate: the grid-touching task of the paper, Table 3.
#include <algorithm>

#include <fmt/core.h>

#include "core/identification.hpp"
#include "firmware/analysis/evaluation/comparison.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/diagnosis/another_arm.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"

namespace armsig::tool {
namespace {

struct EvaluateOptions : CommonOptions {
  std::string arm, signature, truth;
};

bool same_types(const JointTypes& types, const Arm& arm) {
  if (types.size() != arm.joints.size()) return false;
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (types[i] != arm.joints[i].type) return false;
  }
  return true;
}

// The truth is an arm description (exact parameters, which reads as it turns) or a signature.
Read<SignatureRecord> read_truth(const std::string& path, const Signature& signature) {
  ARMSIG_TRY(tag, read_tag(path));
  if (tag == kSignatureTag) return read_signature_file(path);
  ARMSIG_TRY(arm, read_arm_file(path));
  if (!same_types(signature.types, arm.arm)) {
    return std::unexpected(Problem{path, 0, 0, "its joints are not those of the signature",
                                   "an arm with the same joint types"});
  }
  SignatureRecord truth;
  truth.nominal = arm.arm;
  truth.signature = signature_of(arm.arm, signature.configuration, Pose{}, {});
  return truth;
}

bool is_drawing_of(const SignatureRecord& record, const Arm& arm) {
  return std::ranges::equal(record.nominal.joints, arm.joints, [](const auto& a, const auto& b) {
    return a.theta_rad == b.theta_rad && a.d_m == b.d_m && a.a_m == b.a_m &&
           a.alpha_rad == b.alpha_rad;
  });
}

// Signature and truth have to be of an arm built to the drawing. What `identify` has accepted as
// far from its own drawing is taken, and a truth that is as far.
Read<void> check_one_arm(const EvaluateOptions& options, const ArmDescription& arm,
                         const SignatureRecord& record, const SignatureRecord& truth) {
  const auto refuse = [&](const std::string& file, const std::string& words, const char* which) {
    return std::unexpected(Problem{
        file, 0, 0,
        fmt::format("it is not of the arm of {} ({}): {}", options.arm, arm.name, words), which});
  };
  const Farness found = farness_of(record, arm.arm, arm.limits);
  if (found.times_allowed > 1 && !is_drawing_of(record, arm.arm)) {
    return refuse(options.signature, found.words, "--arm with the nominal model of the signature");
  }
  const Farness real = farness_of(truth, arm.arm, arm.limits);
  if (is_of_another_arm(real, found)) {
    return refuse(options.truth, real.words, "--truth of the arm that the signature is of");
  }
  return {};
}

Attempt<evaluation::Comparison> compared(const EvaluateOptions& options, const ArmDescription& arm,
                                         const SignatureRecord& record,
                                         const SignatureRecord& truth) {
  if (auto one_arm = check_one_arm(options, arm, record, truth); !one_arm) {
    return no_answer(std::move(one_arm).error());
  }
  if (!is_drawing_of(record, arm.arm)) {
    complain("armsig: warning: {}: found with another nominal model than that of {}",
             options.signature, options.arm);
  }
  const calibration::ReadingModel readings = record.readings();
  const calibration::ReadingModel true_readings = truth.readings();
  const auto comparison = evaluation::compare(arm.arm, record.signature, truth.signature, {},
                                              {&readings, record.signature.configuration},
                                              {&true_readings, truth.signature.configuration});
  if (comparison) return *comparison;
  return no_answer({options.signature, 0, 0,
                    fmt::format("the grid can't be touched: {}", describe(comparison.error())),
                    "an arm that reaches a grid of a tenth of 25 x 25 x 60 cm at least"});
}

Attempt<ExitStatus> run(const EvaluateOptions& options) {
  ARMSIG_TRY(arm, read_arm(options.arm));
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(truth, read_truth(options.truth, record.signature));
  if (!same_types(record.signature.types, arm.arm) || !same_types(truth.signature.types, arm.arm)) {
    return std::unexpected(Problem{options.signature, 0, 0,
                                   "the joints of signature, truth and arm differ",
                                   "three models of one arm"});
  }
  ARMSIG_TRY(comparison, compared(options, arm, record, truth));
  if (options.json) {
    print_json({{"status", 0}, {"arm", arm.name}, {"evaluation", comparison_json(comparison)}});
    return kDone;
  }
  const auto& size_m = comparison.grid.size_m;
  say("{}: touching a grid of {:.0f} x {:.0f} x {:.0f} cm, {} vertices\n\n{}", arm.name,
      100 * size_m[0], 100 * size_m[1], 100 * size_m[2], comparison.grid.vertex_count(),
      comparison_table(comparison));
  say("\n");
  say_next(TypedCommand("report")
               .file_option("--signature", options.signature)
               .option("--out", "report.html"));
  return kDone;
}

}  // namespace

void add_evaluate(CLI::App& app, int& status) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command =
      app.add_subcommand("evaluate", "the grid-touching task with and without the signature");
  command->add_option("--arm", options->arm, "arm description (YAML): the nominal model")
      ->required();
  command->add_option("--signature", options->signature, "signature under test (YAML)")->required();
  command
      ->add_option("--truth", options->truth,
                   "the real arm: an arm description or a signature (YAML)")
      ->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
