// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "core/base/joint_range.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/report/coverage.hpp"
#include "firmware/host_tool/report/verdict.hpp"

namespace armsig::tool {
namespace {

// Where a sensor's own sigma was not stated, a file holds next to nothing in its place.
constexpr double kNoShare = 0.01;
// A sweep that ends nearer than this to a limit reaches it.
constexpr double kAtLimit_rad = 0.02;
constexpr double kAtLimit_m = 0.002;

std::string stated_mm(double metres) {
  return metres < 5e-7 ? "< 0.0005 mm" : fmt::format("{:.3f} mm", 1e3 * metres);
}

std::string rows_in_words(const SignatureRecord& record) {
  return record.fit ? fmt::format("{} rows", record.fit->rows_used) : "the rows";
}

// What was found from the scatter, apart where the sensor's own was stated.
void add_scatter(const SignatureRecord& record, double predicted_m, UncertaintyBudget& budget) {
  const double sensor_m = record.sigma_m.value_or(0);
  const double model_m = record.unexplained_m;
  const double in_each_pose = std::min(3 * model_m * model_m, predicted_m * predicted_m);
  const double by_the_fit = predicted_m * predicted_m - in_each_pose;
  if (sensor_m <= kNoShare * model_m) {
    const double scatter_m = std::hypot(sensor_m, model_m);
    const std::string found =
        scatter_m > 0 ? fmt::format(", {} per axis", stated_mm(scatter_m)) : std::string();
    budget.sources.push_back({"Sensor and model together",
                              fmt::format("type A: scatter about the fit of {}{}; nothing was "
                                          "stated that would tell them apart",
                                          rows_in_words(record), found),
                              predicted_m});
    return;
  }
  const double share = sensor_m * sensor_m / (sensor_m * sensor_m + model_m * model_m);
  budget.sources.push_back({"Sensor",
                            fmt::format("type A: its scatter of {} per axis, through the fit of {}",
                                        stated_mm(sensor_m), rows_in_words(record)),
                            std::sqrt(share * by_the_fit)});
  const std::string shown = model_m > 0 ? fmt::format(
                                              "type A: {} per axis beyond the sensor's scatter, in "
                                              "each pose and through the fit",
                                              stated_mm(model_m))
                                        : std::string(
                                              "type A: the residuals show nothing beyond the "
                                              "sensor's scatter");
  budget.sources.push_back({"Model", shown, std::sqrt(in_each_pose + (1 - share) * by_the_fit)});
}

std::optional<ExpandedUncertainty> expanded(const SignatureRecord& record, double combined_m,
                                            const ToolErrorMap& map) {
  std::vector<Vector3> variances;
  double sum_m2 = 0;
  for (const ToolErrorAt& at : map.points) {
    if (!at.predicted_m) return std::nullopt;
    variances.push_back(at.variances_m2);
    sum_m2 += at.variances_m2.sum();
  }
  if (!(sum_m2 > 0)) return std::nullopt;
  const double rms_m = std::sqrt(sum_m2 / static_cast<double>(variances.size()));
  const UnitLength unit(record.noise_freedom);
  ExpandedUncertainty result;
  result.probability = kCoverageProbability;
  result.factor = coverage_length(unit, variances, result.probability) / rms_m;
  result.factor_per_axis = result.factor * std::numbers::sqrt3;
  result.length_m = result.factor * combined_m;
  const double twice_m = 2 * rms_m / std::numbers::sqrt3;
  for (const Vector3& each : variances) {
    result.probability_at_2 += probability_below(unit, each, twice_m);
  }
  result.probability_at_2 /= static_cast<double>(variances.size());
  result.freedom = record.noise_freedom;
  return result;
}

std::string range_in_words(JointType type, double lower, double upper) {
  const bool turns = type == JointType::kRevolute;
  const double unit = turns ? degrees(1) : 1e3;
  std::string words = fmt::format("{:.0f}{} to {:.0f}{}", unit * lower, turns ? "°" : " mm",
                                  unit * upper, turns ? "°" : " mm");
  for (std::size_t k = 0; (k = words.find('-', k)) != std::string::npos;) words.replace(k, 1, "−");
  return words;
}

// The readings of a joint that had a part in the signature: of its sweeps, and of free poses where
// the method uses them.
std::optional<JointLimits> reach_of(const SignatureRecord& record,
                                    const std::vector<SweepPicture>& sweeps,
                                    const FixedVector<JointLimits, kMaxJoints>& mixed_reach,
                                    std::size_t joint) {
  std::optional<JointLimits> reach;
  const auto widen = [&](double lower, double upper) {
    if (!reach) reach = JointLimits{lower, upper};
    reach->lower = std::min(reach->lower, lower);
    reach->upper = std::max(reach->upper, upper);
  };
  for (const SweepPicture& sweep : sweeps) {
    const features::SweepQuality& quality = sweep.feature.quality;
    if (sweep.joint == joint) widen(quality.lowest_reading, quality.highest_reading);
  }
  if (record.method == "refined" && joint < mixed_reach.size()) {
    widen(mixed_reach[joint].lower, mixed_reach[joint].upper);
  }
  return reach;
}

}  // namespace

UncertaintyBudget uncertainty_budget(const SignatureRecord& record,
                                     const std::optional<ToolErrorMap>& map) {
  UncertaintyBudget budget;
  if (map && map->predicted_rms_m) {
    budget.combined_m = map->predicted_rms_m;
    budget.expanded = expanded(record, *map->predicted_rms_m, *map);
    add_scatter(record, *map->predicted_rms_m, budget);
  }
  budget.sources.push_back(
      {"Repeatability of the arm",
       "not measured apart; what did not repeat while it was measured is in the scatter above",
       {}});
  budget.sources.push_back(
      {"Temperature",
       record.air_c ? fmt::format("measured at {:.1f} °C; the arm at another temperature is not in "
                                  "this",
                                  *record.air_c)
                    : std::string("not stated; the arm at another temperature is not in this"),
       {}});
  budget.sources.push_back(
      {"Scale of the instrument", "by its own calibration certificate; not in this", {}});
  return budget;
}

std::vector<AdjustmentLine> before_and_after(const SignatureRecord& record,
                                             const std::optional<ToolErrorMap>& map,
                                             const std::optional<PoseResiduals>& poses) {
  std::vector<AdjustmentLine> lines;
  const std::string nominal = "Before: nominal parameters";
  if (poses && poses->fitted && poses->nominal) {
    const ResidualSummary& found = *poses->nominal;
    lines.push_back(
        {nominal,
         fmt::format("measured at {} free poses, base and tool fitted to them", found.rows),
         found.mean_m, found.rms_m, found.largest_m});
  } else if (map) {
    lines.push_back({nominal,
                     fmt::format("computed over {}: distance of the nominal model, base and tool "
                                 "fitted, from the signature",
                                 map->over),
                     {},
                     map->nominal_rms_m,
                     {}});
  }
  const std::string adjusted = "After: parameters of the signature";
  if (const auto figure = validation_figure(record)) {
    const bool with_mean = record.fit && record.fit->left_out;
    lines.push_back({adjusted,
                     "measured at " + poses_in_words(*figure),
                     with_mean ? std::optional(record.fit->left_out->mean_m) : std::nullopt,
                     figure->rms_m,
                     {}});
  } else if (map && map->predicted_rms_m) {
    lines.push_back({adjusted,
                     fmt::format("predicted over {}, one standard deviation; no validation poses "
                                 "were measured",
                                 map->over),
                     {},
                     *map->predicted_rms_m,
                     {}});
  }
  return lines;
}

std::vector<std::string> accuracy_in_words(const SignatureRecord& record) {
  std::vector<std::string> words;
  if (record.fit && record.fit->left_out) {
    const FitRecord::LeftOut& out = *record.fit->left_out;
    words.push_back(fmt::format(
        "Positioning accuracy: at {} positions left out of the fit{}, one visit each, the "
        "signature puts the target {} off on the mean and {} root mean square, the sensor's "
        "scatter "
        "included. ISO 9283 has AP for the barycentre of 30 visits to each of five poses: this is "
        "what comes nearest, and it is not AP.",
        out.rows, left_out_in_turn(record) ? " in turn" : "", stated_mm(out.mean_m),
        stated_mm(out.rms_m)));
  } else if (const auto& validated = record.accuracy.validated) {
    words.push_back(
        fmt::format("Positioning accuracy: at {} one visit each, the signature puts the target {} "
                    "off, root mean square, the sensor's scatter included. ISO 9283 has AP for the "
                    "barycentre of 30 visits to each of five poses: this is not AP.",
                    poses_in_words(*validation_figure(record)) + ",", stated_mm(validated->rms_m)));
  } else {
    words.emplace_back("Positioning accuracy (ISO 9283: AP): no validation poses were measured.");
  }
  const auto& predicted = record.accuracy.predicted;
  if (predicted && predicted->region == PredictedRegion::kSignatureConfiguration) {
    words.push_back(fmt::format("Predicted tool error at {}: {}, one standard deviation.",
                                region_in_words(predicted->region), stated_mm(predicted->rms_m)));
  }
  words.emplace_back(
      "Positioning repeatability (ISO 9283: RP): not measured. It is the arm's own, and no "
      "signature changes it.");
  return words;
}

std::vector<std::string> not_measured(const SignatureRecord& record,
                                      const std::vector<SweepPicture>& sweeps,
                                      const FixedVector<JointLimits, kMaxJoints>& mixed_reach) {
  std::vector<std::string> words{
      "Pose accuracy and repeatability by the cycles, cube, load and speed of ISO 9283 (AP, RP), "
      "their variation with direction (vAP), and drift.",
      "Path accuracy, and anything while the arm moves: each point was taken at standstill.",
      "Other loads than that under which it was measured, and other temperatures.",
      "The orientation of the tool: the target is a point, its orientation follows from the axes."};
  std::vector<std::string> joints;
  for (std::size_t joint = 0; joint < record.nominal.limits.size(); ++joint) {
    const auto reach = reach_of(record, sweeps, mixed_reach, joint);
    if (!reach) continue;
    const JointLimits& limits = record.nominal.limits[joint];
    const JointType type = record.signature.types[joint];
    const double near = type == JointType::kRevolute ? kAtLimit_rad : kAtLimit_m;
    const bool whole_turn = is_endless(limits) && reach->upper - reach->lower > 2 * kPi - near;
    if (whole_turn) continue;
    if (reach->lower < limits.lower + near && reach->upper > limits.upper - near) continue;
    joints.push_back(fmt::format("joint {} beyond {}", joint + 1,
                                 range_in_words(type, reach->lower, reach->upper)));
  }
  if (!joints.empty()) {
    words.push_back(
        fmt::format("Readings beyond those measured, which the limits allow: {}.", all_of(joints)));
  }
  return words;
}

}  // namespace armsig::tool
