// SPDX-License-Identifier: MIT
// armsig suggest: the next poses worth measuring.
#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/uncertainty/suggestion.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/pose_options.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/signature/estimate.hpp"

namespace armsig::tool {
namespace {

struct SuggestOptions : PoseOptions {
  std::string signature;
  std::size_t count = 30;
  std::optional<double> sigma_mm;
};

// A further pose that lowers the predicted error by less than this share is not worth the robot's
// time.
constexpr double kWorthwhile = 0.05;

// What is asked for, of the arm and by the options.
Attempt<uncertainty::SuggestionConfig> search_for(const SuggestOptions& options,
                                                  const SignatureRecord& record,
                                                  const refinement::Refined& estimate) {
  const auto target = tool_target(record.signature);
  if (!target) {
    return no_answer({options.signature, 0, 0, "no target on the last link",
                      "a signature with a target on the last link"});
  }
  ARMSIG_TRY(limits,
             limits_with_margin(record.nominal.limits, record.signature.types, options.margin()));
  uncertainty::SuggestionConfig config;
  config.limits = limits;
  config.target = *target;
  config.sigma_m = options.sigma_mm ? 1e-3 * *options.sigma_mm : 0;
  if (!(config.sigma_m > 0) && !(estimate.quality.sigma_m > 0)) {
    return std::unexpected(Problem{options.signature, 0, 0,
                                   "the signature does not say how noisy the sensor is",
                                   "--sigma-mm"});
  }
  if (const auto box = options.box()) {
    config.box.lower_S = box->lower;
    config.box.upper_S = box->upper;
  }
  return config;
}

struct Suggested {
  std::vector<uncertainty::Suggestion> poses;
  double before_m = 0;  // the predicted error without any of them

  [[nodiscard]] bool worthwhile() const {
    return poses.back().predicted_rms_m < (1 - kWorthwhile) * before_m;
  }
};

Attempt<Suggested> suggested(const SuggestOptions& options, const refinement::Refined& estimate,
                             const uncertainty::SuggestionConfig& config) {
  const auto search = std::make_unique<uncertainty::SuggestionSearch>();
  Suggested suggested{.poses = std::vector<uncertainty::Suggestion>(options.count)};
  auto found = search->start(estimate, config);
  if (found) {
    suggested.before_m = search->predicted_rms_m();
    found = search->suggest(suggested.poses);
  }
  if (found) return suggested;
  return no_answer({options.signature, 0, 0, std::string(describe(found.error())),
                    "a box that the target gets into within the joint limits"});
}

Read<void> write(const SuggestOptions& options, const SignatureRecord& record,
                 const Suggested& suggested) {
  std::vector<JointVector> poses;
  for (const auto& suggestion : suggested.poses) poses.push_back(suggestion.readings);
  const std::string title =
      fmt::format("{}: poses to measure next, the most useful first", record.arm_name);
  return write_poses(options.out, options.program(title), record.signature.types, poses);
}

nlohmann::ordered_json json_of(const SuggestOptions& options, const Suggested& suggested) {
  auto expected = nlohmann::ordered_json::array();
  for (const auto& suggestion : suggested.poses) expected.push_back(suggestion.predicted_rms_m);
  return {{"status", 0},
          {"predicted_rms_m", suggested.before_m},
          {"predicted_rms_m_after", std::move(expected)},
          {"worthwhile", suggested.worthwhile()},
          {"out", options.out}};
}

std::string table_of(const Suggested& suggested, const JointTypes& types) {
  Table table({"Pose", "Joint readings", "Expected error, mm"});
  table.add_row({"now", "", fmt::format("{:.3f}", 1e3 * suggested.before_m)});
  for (std::size_t k = 0; k < suggested.poses.size(); ++k) {
    const uncertainty::Suggestion& pose = suggested.poses[k];
    std::string readings;
    for (std::size_t j = 0; j < pose.readings.size(); ++j) {
      readings +=
          fmt::format("{}{:>9}", j == 0 ? "" : " ", reading_in_words(types[j], pose.readings[j]));
    }
    table.add_row(
        {fmt::format("{}", k + 1), readings, fmt::format("{:.3f}", 1e3 * pose.predicted_rms_m)});
  }
  return table.render();
}

void print_suggested(const SuggestOptions& options, const SignatureRecord& record,
                     const Suggested& suggested) {
  say("{}: poses worth measuring next\n\n{}\n{}\n", record.arm_name,
      table_of(suggested, record.signature.types),
      paragraph(fmt::format("The error is that of the tool after the pose, 1 sigma, RMS over the "
                            "joint limits less the margin of {}° and {} mm that every pose "
                            "keeps.",
                            options.margin_deg, options.margin_mm)));
  if (!suggested.worthwhile()) {
    say("They would lower the error by less than {:.0f} %: what was measured already will do.\n",
        100 * kWorthwhile);
  }
  say("Written: {}\nNext: measure there, then armsig identify --method refined with all rows\n",
      file_in_words(options.out));
}

Attempt<ExitStatus> run(const SuggestOptions& options) {
  if (auto apart = check_roles({{"--signature", options.signature}}, {{"--out", options.out}});
      !apart) {
    return std::unexpected(std::move(apart).error());
  }
  ARMSIG_TRY(record, read_signature_file(options.signature));
  ARMSIG_TRY(estimate, estimate_of(record, options.signature));
  ARMSIG_TRY(config, search_for(options, record, *estimate));
  ARMSIG_TRY(found, suggested(options, *estimate, config));
  if (auto written = write(options, record, found); !written) {
    return std::unexpected(std::move(written).error());
  }
  if (options.json) {
    print_json(json_of(options, found));
  } else {
    print_suggested(options, record, found);
  }
  return kDone;
}

}  // namespace

void add_suggest(CLI::App& app, int& status) {
  auto options = std::make_shared<SuggestOptions>();
  CLI::App* command = app.add_subcommand("suggest", "the next poses worth measuring");
  command->add_option("--signature", options->signature, "signature with covariance (YAML)")
      ->required();
  command->add_option("--count", options->count, "how many poses")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--sigma-mm", options->sigma_mm,
                   "noise of the sensor per axis, 1 sigma (default: as the signature says)")
      ->check(CLI::PositiveNumber);
  add_pose_options(*command, *options,
                   "where the sensor sees the target: x,y,z lowest, then x,y,z highest");
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
