// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr double kShortArc_rad = kPi / 3;
// A joint that brings more than its share of the remaining variance.
constexpr double kDominant = 0.5;
// Errors of the scale of an encoder below this move a tool at 1 m by less than 0.1 mm.
constexpr double kScaleOfInterest = 1e-4;

// As the page writes lengths.
std::string length_in_words(double metres) {
  if (metres < 1e-5) return fmt::format("{:.1f} µm", 1e6 * metres);
  return fmt::format("{:.{}f} mm", 1e3 * metres, metres < 1e-3 ? 3 : 2);
}

// Arms as built are nearer to their drawings than this.
constexpr double kFarFromDrawing_m = 0.02;

void doubt_the_drawing(double before_m, Verdict& verdict) {
  if (before_m <= kFarFromDrawing_m) return;
  verdict.sentences.push_back(
      fmt::format("Arms as built are some millimetres from their nominal models, and this one is "
                  "{} away: it is "
                  "another arm's nominal model, or one of its units is wrong.",
                  length_in_words(before_m)));
}

void judge_with_truth(const ToolErrorMap& map, Verdict& verdict) {
  const double before_m = *map.true_nominal_rms_m;
  const double after_m = *map.true_rms_m;
  verdict.headline =
      fmt::format("By the nominal model the tool misses by {}, by the arm signature by {}.",
                  length_in_words(before_m), length_in_words(after_m));
  verdict.before_after = {{"Nominal model", map.over, before_m}, {"Signature", map.over, after_m}};
  verdict.sentences.push_back(fmt::format(
      "Over {} the nominal model misses by {} (root mean square, its base and tool fitted), "
      "the signature "
      "by {}. This arm is simulated, so that its true error is known.",
      map.over, length_in_words(before_m), length_in_words(after_m)));
  doubt_the_drawing(before_m, verdict);
  if (map.predicted_rms_m) {
    verdict.sentences.push_back(
        fmt::format("From the measurements alone the signature predicted an error of {} (1σ), in "
                    "the sensor's frame as well.",
                    length_in_words(*map.predicted_rms_m)));
  }
}

// The measurements do not tell the arm from its nominal model.
bool is_nothing_gained(const ToolErrorMap& map) {
  return map.predicted_rms_m && map.nominal_rms_m < 2 * *map.predicted_rms_m;
}

void judge_nothing_gained(const ToolErrorMap& map, Verdict& verdict) {
  verdict.headline =
      "The measurements can't tell this arm from its nominal model: nothing is gained yet.";
  verdict.before_after = {{"Nominal model", map.over, map.nominal_rms_m},
                          {"Signature, 1σ", map.over, *map.predicted_rms_m}};
  verdict.sentences.push_back(fmt::format(
      "Nominal model and signature differ by {} over {}, and the signature itself is "
      "uncertain by {} "
      "(1σ).",
      length_in_words(map.nominal_rms_m), map.over, length_in_words(*map.predicted_rms_m)));
}

void judge_by_validation(const ValidationFigure& figure, const std::optional<PoseResiduals>& poses,
                         Verdict& verdict) {
  const std::string after = length_in_words(figure.rms_m);
  // The nominal model is judged at the very poses, or not at all.
  const bool both = poses && poses->fitted && poses->nominal;
  const std::string over = poses_in_words(figure);
  std::string same = "the same poses";
  if (both && poses->outliers > 0) {
    same += fmt::format(" without {}", counted(poses->outliers, "outlier"));
  }
  if (both) {
    const double before_m = poses->nominal->rms_m;
    verdict.headline = fmt::format(
        "At validation poses the tool is {} from where the arm signature puts it, {} "
        "from where the nominal model does.",
        after, length_in_words(before_m));
    verdict.before_after.push_back({"Nominal model", same, before_m});
  } else {
    verdict.headline = fmt::format(
        "At validation poses the tool is {} from where the arm signature puts it.", after);
  }
  verdict.before_after.push_back({"Signature", over, figure.rms_m});
  verdict.sentences.push_back(
      fmt::format("The signature's figure is the root mean square over {}. The sensor's own noise "
                  "is included.",
                  over));
  if (both) {
    verdict.sentences.push_back(
        fmt::format("The nominal model's is over {}, its base and tool fitted to them.", same));
  }
  if (both) doubt_the_drawing(poses->nominal->rms_m, verdict);
}

void judge_by_prediction(const ToolErrorMap& map, Verdict& verdict) {
  const double before_m = map.nominal_rms_m;
  const double after_m = *map.predicted_rms_m;
  verdict.headline = fmt::format(
      "By the nominal model the tool misses by {}, by the arm signature by about {} (1σ).",
      length_in_words(before_m), length_in_words(after_m));
  verdict.before_after = {{"Nominal model", map.over, before_m},
                          {"Signature, 1σ", map.over, after_m}};
  verdict.sentences.push_back(
      fmt::format("Over {} the nominal model, its base and tool fitted, is {} (root mean square) "
                  "from the signature; "
                  "the signature is uncertain by {} (1σ).",
                  map.over, length_in_words(before_m), length_in_words(after_m)));
  doubt_the_drawing(before_m, verdict);
}

void judge_without_covariance(const SignatureRecord& record, const std::optional<ToolErrorMap>& map,
                              Verdict& verdict) {
  if (!map) {
    verdict.headline =
        "An arm signature; no target on the last link says how well it places a tool.";
    return;
  }
  verdict.headline = fmt::format("The nominal model is {} from this signature over {}.",
                                 length_in_words(map->nominal_rms_m), map->over);
  verdict.before_after = {{"Nominal model", map->over, map->nominal_rms_m}};
  if (record.accuracy.predicted) return;
  verdict.sentences.emplace_back(
      "The uncertainty of the signature is not known: the file holds neither covariance nor "
      "sweeps.");
}

// The stated prediction of a signature without covariance, which says nothing of other places.
void add_stated_prediction(const SignatureRecord& record, const ToolErrorMap& map,
                           Verdict& verdict) {
  const auto& predicted = record.accuracy.predicted;
  if (!predicted || map.predicted_rms_m) return;
  verdict.others.push_back(
      {"Predicted tool error, 1σ", region_in_words(predicted->region), predicted->rms_m});
  verdict.sentences.push_back(
      fmt::format("The predicted tool error is {} (1σ) at {}; over {} it is not known.",
                  length_in_words(predicted->rms_m), region_in_words(predicted->region), map.over));
}

// What is not in the headline, each figure with the poses that it is of.
void add_other_figures(const SignatureRecord& record, const std::optional<ToolErrorMap>& map,
                       const std::optional<PoseResiduals>& poses, Verdict& verdict) {
  if (record.fit) {
    verdict.others.push_back(
        {"Residual of the fit", "the rows that it was fitted to", record.fit->rms_m});
  }
  if (poses && !poses->fitted) {
    verdict.others.push_back(
        {"Residual, no part in the fit", "the free poses shown here", poses->signature.rms_m});
  }
  if (!map) return;
  add_stated_prediction(record, *map, verdict);
  if (map->predicted_rms_m) {
    verdict.others.push_back({"Predicted tool error, 1σ", map->over, *map->predicted_rms_m});
  }
  if (map->predicted_over_limits_m) {
    verdict.others.push_back(
        {"Predicted tool error, 1σ", "the joint limits", *map->predicted_over_limits_m});
  }
  verdict.others.push_back({"Nominal model from the signature", map->over, map->nominal_rms_m});
}

// How sure: what the scatter says, and what it cannot.
void say_how_sure(const SignatureRecord& record, Verdict& verdict) {
  std::size_t used = 0;
  std::size_t rejected = 0;
  for (const features::JointFeature& feature : record.signature.features) {
    used += feature.quality.used;
    rejected += feature.quality.rejected;
  }
  if (record.fit) {
    used = record.fit->rows_used;
    rejected = record.fit->rows_rejected;
  }
  if (used > 0) {
    const std::string outliers = rejected == 0 ? "none was rejected as an outlier"
                                 : rejected == 1
                                     ? "one more was rejected as an outlier"
                                     : fmt::format("{} more were rejected as outliers", rejected);
    verdict.sentences.push_back(fmt::format("It rests on {} measured points; {}.", used, outliers));
  }
  if (record.method != "exact") {
    verdict.sentences.emplace_back(
        "A predicted error (1σ) comes from the scatter of the points and from what they leave "
        "open. What was alike "
        "at all of them (load, heat) is not in it; poses measured another day, or under another "
        "load, show it.");
  }
}

void add_joint_steps(const std::vector<SweepPicture>& sweeps, Verdict& verdict) {
  for (const SweepPicture& sweep : sweeps) {
    const features::SweepQuality& quality = sweep.feature.quality;
    if (sweep.wave && sweep.wave->significant()) {
      verdict.next_steps.push_back(
          fmt::format("Look at the encoder of joint {}: its readings err by {:.3f}° once per turn.",
                      sweep.joint + 1, degrees(sweep.wave->amplitude_rad())));
    }
    const double scale_error = std::abs(quality.encoder_ratio - 1);
    if (scale_error > 5 * quality.encoder_ratio_sigma && scale_error > kScaleOfInterest) {
      verdict.next_steps.push_back(fmt::format(
          "Check the gear ratio of joint {} and the scale of the sensor: the reading and the "
          "measured motion differ by {:.3f} %.",
          sweep.joint + 1, 100 * scale_error));
    }
    if (sweep.feature.type == JointType::kRevolute && quality.arc() < kShortArc_rad) {
      verdict.next_steps.push_back(fmt::format(
          "Sweep joint {} further: {:.0f}° of arc leave the centre of its circle uncertain.",
          sweep.joint + 1, degrees(quality.arc())));
    }
  }
}

}  // namespace

std::optional<ValidationFigure> validation_figure(const SignatureRecord& record) {
  if (record.fit && record.fit->left_out) {
    return ValidationFigure{.rms_m = record.fit->left_out->rms_m,
                            .poses = record.fit->left_out->rows,
                            .in_turn = left_out_in_turn(record)};
  }
  if (!record.accuracy.validated) return std::nullopt;
  return ValidationFigure{.rms_m = record.accuracy.validated->rms_m,
                          .poses = record.accuracy.validated->poses};
}

std::string poses_in_words(const ValidationFigure& figure) {
  const std::string count = figure.poses > 0 ? fmt::format("{} ", figure.poses) : "the ";
  return count + (figure.in_turn ? "validation poses, each left out of the fit in turn"
                                 : "validation poses, which no fit has used");
}

Verdict verdict(const SignatureRecord& record, const std::vector<SweepPicture>& sweeps,
                const std::optional<ToolErrorMap>& map, const std::optional<PoseResiduals>& poses) {
  Verdict verdict;
  const auto validated = validation_figure(record);
  verdict.validation = validated;
  if (map && map->true_rms_m) {
    judge_with_truth(*map, verdict);
  } else if (map && is_nothing_gained(*map)) {
    judge_nothing_gained(*map, verdict);
  } else if (validated) {
    judge_by_validation(*validated, poses, verdict);
  } else if (map && map->predicted_rms_m) {
    judge_by_prediction(*map, verdict);
  } else {
    judge_without_covariance(record, map, verdict);
  }
  add_other_figures(record, map, poses, verdict);
  say_how_sure(record, verdict);
  add_joint_steps(sweeps, verdict);
  if (map && !map->joint_share.empty()) {
    const auto most = std::ranges::max_element(map->joint_share);
    if (*most > kDominant) {
      verdict.next_steps.push_back(
          fmt::format("Measure joint {} again, with more points or a longer arc: {:.0f} % of the "
                      "remaining uncertainty comes from its axis.",
                      most - map->joint_share.begin() + 1, 100 * *most));
    }
  }
  if (record.method == "encoder" || record.method == "paper") {
    verdict.next_steps.emplace_back(
        "Identify with --method refined: it uses all measurements at once, and poses beside the "
        "sweeps too.");
  } else if (record.covariance) {
    verdict.next_steps.emplace_back(
        "If this is not enough: armsig suggest names the poses worth measuring next.");
  }
  verdict.next_steps.emplace_back(
      "Measure ten poses that had no part in this: armsig check says whether they agree.");
  return verdict;
}

bool left_out_in_turn(const SignatureRecord& record) {
  if (!record.fit || !record.fit->left_out) return false;
  return record.method == "refined" ||
         record.fit->left_out->rows == record.fit->rows_used + record.fit->rows_rejected;
}

std::string residuals_in_words(const SweepPicture& sweep) {
  if (sweep.feature.type == JointType::kPrismatic) {
    return "Distances from the line that the target moves along.";
  }
  if (!sweep.wave) {
    return "Less than half a turn: a once-per-turn error of the encoder looks like a "
           "shifted "
           "circle.";
  }
  const EncoderWave& wave = *sweep.wave;
  if (!wave.significant()) {
    return fmt::format(
        "Scatter without a pattern: no once-per-turn error of the encoder above {:.3f}° "
        "(3σ).",
        degrees(3 * wave.sigma_rad));
  }
  return fmt::format(
      "A sinusoid, once per turn: the readings of this joint err by {:.3f}° ± {:.3f}° ({} at the "
      "target). So does an encoder whose disk is mounted off its centre. The circle takes up part "
      "of "
      "it, which is why the residuals show half. A signature with constant offsets can't hold it.",
      degrees(wave.amplitude_rad()), degrees(wave.sigma_rad),
      length_in_words(wave.amplitude_rad() * sweep.feature.radius_m));
}

}  // namespace armsig::tool
