// SPDX-License-Identifier: MIT
// armsig suggest: the next poses worth measuring.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/analysis/uncertainty/suggestion.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/commands/pose_options.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/simulation/clear_sweeps.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

struct SuggestOptions : PoseOptions {
  std::string signature;
  std::size_t count = 30;
  std::optional<double> sigma_mm;
  std::vector<double> seen_mm;  // where the sensor sees the target: lowest x, y, z, then highest

  [[nodiscard]] clearance::Surroundings around(const SignatureRecord& record) const;
};

// How far target `p_S` is from the last origin of the nominal model. Where a last axis was found
// its frame lies anywhere along it: counted from where the common normal with the axis before meets
// it, the origin is at d of the last row.
double distance_from_flange(const SignatureRecord& record, const Vector3& p_S) {
  const Signature& found = record.signature;
  const DhJoint& last = record.nominal.joints.back();
  const std::size_t n = found.joint_count();
  const double fallback_m = (p_S - found.X_SL.back().p).norm() + std::hypot(last.a_m, last.d_m);
  if (n < 2 || last.type != JointType::kRevolute) return fallback_m;
  const Vector3 z_S = found.X_SL[n - 1].R.col(2);
  const Vector3 before_S = found.X_SL[n - 2].R.col(2);
  const Vector3 across = z_S.cross(before_S);
  constexpr double kParallel = 0.1;
  if (across.norm() < kParallel) return fallback_m;
  const Vector3 apart = found.X_SL[n - 2].p - found.X_SL[n - 1].p;
  const double part = apart.cross(before_S).dot(across) / across.squaredNorm();
  const Vector3 from_foot = p_S - (found.X_SL[n - 1].p + part * z_S);
  const double along_m = from_foot.dot(z_S) - last.d_m;
  const double aside_m = (from_foot - from_foot.dot(z_S) * z_S).norm() + std::abs(last.a_m);
  return std::hypot(along_m, aside_m);
}

// `around` with links, and with a ball about the flange, no thicker than fits in the signature
// configuration: the arm was measured there.
clearance::Surroundings fitted(clearance::Surroundings around, const SignatureRecord& record) {
  constexpr double kRounding_m = 1e-9;
  constexpr double kThinnest_m = 1e-3;
  constexpr int kMost = 8;  // each may leave another link as the nearest
  const JointVector q = effective_readings(record.nominal, record.signature.configuration);
  for (int k = 0; k < kMost; ++k) {
    const clearance::Room room = clearance::room_at(record.nominal.joints, around, q);
    const double lacks_m = clearance::kLeastRoom_m - room.left_m + kRounding_m;
    if (lacks_m <= kRounding_m) break;
    const bool of_hand = room.link > record.nominal.joints.size();
    double& thick_m = of_hand ? around.hand_m : around.link_radius_m;
    thick_m = std::max(of_hand ? 0.0 : std::min(kThinnest_m, thick_m), thick_m - lacks_m);
  }
  return around;
}

// What the arm stays clear of with its target, wherever that is on the last link.
clearance::Surroundings SuggestOptions::around(const SignatureRecord& record) const {
  const auto target = tool_target(record.signature);
  return fitted(
      PoseOptions::around(
          record.nominal, record.mounting,
          target ? distance_from_flange(record, record.signature.targets[*target].p_S) : 0),
      record);
}

// A further pose that lowers the predicted error by less than this share is not worth the robot's
// time.
constexpr double kWorthwhile = 0.05;

// What is asked for, of the arm and by the options.
Attempt<uncertainty::SuggestionConfig> search_for(const SuggestOptions& options,
                                                  const SignatureRecord& record,
                                                  const calibration::Refined& estimate) {
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
  if (const auto& seen_mm = options.seen_mm; !seen_mm.empty()) {
    config.box.lower_S = 1e-3 * Vector3(seen_mm[0], seen_mm[1], seen_mm[2]);
    config.box.upper_S = 1e-3 * Vector3(seen_mm[3], seen_mm[4], seen_mm[5]);
  }
  config.rows = record.nominal.joints;
  config.around = options.around(record);
  config.home = record.signature.configuration;
  if (auto ok = check_configuration(record.nominal, config.around, config.home); !ok) {
    Problem problem = std::move(ok).error();
    problem.file = options.signature;
    problem.what = "in the signature configuration " + problem.what;
    problem.expected =
        "room there, as all poses are come to from it: in the arm description where "
        "its floor is (floor_mm) and how thick its links are (link_radius_mm)";
    return no_answer(problem);
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

Attempt<Suggested> suggested(const SuggestOptions& options, const calibration::Refined& estimate,
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
                    "a box that the arm, and its target, get into within the joint limits"});
}

Read<void> write(const SuggestOptions& options, const SignatureRecord& record,
                 const Suggested& suggested) {
  std::vector<JointVector> poses;
  for (const auto& suggestion : suggested.poses) poses.push_back(suggestion.readings);
  const std::string title =
      fmt::format("{}: poses to measure next, the most useful first", record.arm_name);
  const clearance::Surroundings around = options.around(record);
  const std::vector<Stop> route =
      route_by_home(record.nominal, around, record.signature.configuration, poses);
  return write_route(options.out, options.program(title, around), record.signature.types, route);
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

// Identification by the rows of the signature and the new ones together, where those are still
// under the names that it states.
void say_how_to_go_on(const std::optional<Origin>& origin) {
  const bool there = origin && is_there_to_read(origin->measurements) &&
                     (origin->sensor.empty() || is_there_to_read(origin->sensor)) &&
                     read_arm(origin->arm);
  if (!there) {
    say("Next: measure there, then identify by all rows, the former and the new, --method "
        "refined\n");
    return;
  }
  TypedCommand identify("identify");
  identify.file_option("--arm", origin->arm);
  add_rows(identify, {origin->measurements, origin->columns, origin->sensor});
  say("Measure there, and add the rows to {}\n", origin->measurements);
  say_next(identify.option("--method", "refined").option("--out", "signature.yaml"));
}

void print_suggested(const SuggestOptions& options, const SignatureRecord& record,
                     const Suggested& suggested) {
  say("{}: poses worth measuring next\n\n{}\n{}\n", record.arm_name,
      table_of(suggested, record.signature.types),
      paragraph(fmt::format("The error is that of the tool after the pose, 1 sigma, RMS over the "
                            "joint limits less the margin of {}° and {} mm that every pose "
                            "keeps.{}",
                            options.margin_deg, options.margin_mm,
                            record.deflections ? " What the joint error maps leave open is not in "
                                                 "it; identify states it."
                                               : "")));
  say("{}\n",
      paragraph(fmt::format("Every pose and the way to it keep those limits, and: {}. Where "
                            "the straight way between two is not clear, the arm goes by "
                            "the signature configuration.",
                            surroundings_in_words(options.around(record)))));
  if (!suggested.worthwhile()) {
    say("They would lower the error by less than {:.0f} %: what was measured already will do.\n",
        100 * kWorthwhile);
  }
  say("Written: {}\n", file_in_words(options.out));
  say_how_to_go_on(record.origin);
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
  command
      ->add_option("--seen-mm", options->seen_mm,
                   "where the sensor sees the target, in its frame: x,y,z lowest, then highest")
      ->delimiter(',')
      ->expected(6);
  add_pose_options(*command, *options);
  command->callback([options, &status] { status = status_of(run(*options), *options); });
}

}  // namespace armsig::tool
