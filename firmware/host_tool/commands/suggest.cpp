// SPDX-License-Identifier: MIT
// armsig suggest: the next poses worth measuring.
#include <fmt/core.h>

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

int run(const SuggestOptions& options) {
  const auto apart = check_roles({{"--signature", options.signature}}, {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  const auto record = read_signature_file(options.signature);
  if (!record) return fail(record.error(), kBadInput, options);
  const auto estimate = estimate_of(*record, options.signature);
  if (!estimate) return fail(estimate.error(), kBadInput, options);
  const auto target = tool_target(record->signature);
  if (!target) {
    return fail({options.signature, 0, 0, "no target on the last link",
                 "a signature with a target on the last link"},
                kNoAnswer, options);
  }
  uncertainty::SuggestionConfig config;
  const auto limits =
      limits_with_margin(record->nominal.limits, record->signature.types, options.margin());
  if (!limits) return fail(limits.error(), kBadInput, options);
  config.limits = *limits;
  config.target = *target;
  config.sigma_m = options.sigma_mm ? 1e-3 * *options.sigma_mm : 0;
  if (!(config.sigma_m > 0) && !((*estimate)->quality.sigma_m > 0)) {
    return fail({options.signature, 0, 0, "the signature does not say how noisy the sensor is",
                 "--sigma-mm"},
                kBadInput, options);
  }
  if (const auto box = options.box()) {
    config.box.lower_S = box->lower;
    config.box.upper_S = box->upper;
  }

  const auto search = std::make_unique<uncertainty::SuggestionSearch>();
  std::vector<uncertainty::Suggestion> suggestions(options.count);
  auto found = search->start(**estimate, config);
  const double before_m = found ? search->predicted_rms_m() : 0;
  if (found) found = search->suggest(suggestions);
  if (!found) {
    return fail({options.signature, 0, 0, std::string(describe(found.error())),
                 "a box that the target gets into within the joint limits"},
                kNoAnswer, options);
  }

  std::vector<JointVector> poses;
  poses.reserve(suggestions.size());
  for (const auto& suggestion : suggestions) poses.push_back(suggestion.readings);
  const auto written =
      write_poses(options.out,
                  options.program(fmt::format("{}: poses to measure next, the most useful first",
                                              record->arm_name)),
                  record->signature.types, poses);
  if (!written) return fail(written.error(), kBadInput, options);

  const double after_m = suggestions.back().predicted_rms_m;
  const bool worthwhile = after_m < (1 - kWorthwhile) * before_m;
  if (options.json) {
    nlohmann::ordered_json expected = nlohmann::ordered_json::array();
    for (const auto& suggestion : suggestions) expected.push_back(suggestion.predicted_rms_m);
    print_json({{"status", 0},
                {"predicted_rms_m", before_m},
                {"predicted_rms_m_after", std::move(expected)},
                {"worthwhile", worthwhile},
                {"out", options.out}});
    return kDone;
  }
  Table table({"Pose", "Joint readings", "Expected error, mm"});
  table.add_row({"now", "", fmt::format("{:.3f}", 1e3 * before_m)});
  for (std::size_t k = 0; k < suggestions.size(); ++k) {
    std::string readings;
    for (std::size_t j = 0; j < suggestions[k].readings.size(); ++j) {
      readings +=
          fmt::format("{}{:>9}", j == 0 ? "" : " ",
                      reading_in_words(record->signature.types[j], suggestions[k].readings[j]));
    }
    table.add_row({fmt::format("{}", k + 1), readings,
                   fmt::format("{:.3f}", 1e3 * suggestions[k].predicted_rms_m)});
  }
  say("{}: poses worth measuring next\n\n{}\n{}\n", record->arm_name, table.render(),
      paragraph(fmt::format("The error is that of the tool after the pose, 1 sigma, RMS over the "
                            "joint limits less the margin of {}° and {} mm that every pose "
                            "keeps.",
                            options.margin_deg, options.margin_mm)));
  if (!worthwhile) {
    say("They would lower the error by less than {:.0f} %: what was measured already will do.\n",
        100 * kWorthwhile);
  }
  say("Written: {}\nNext: measure there, then armsig identify --method refined with all rows\n",
      file_in_words(options.out));
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
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
