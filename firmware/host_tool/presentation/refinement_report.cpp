// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/refinement_report.hpp"

#include <cmath>

#include <fmt/core.h>

#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/refinement/corrections_option.hpp"
#include "firmware/host_tool/refinement/refinement_words.hpp"

namespace armsig::tool {
namespace {

void print_corrections(const calibration::Refined& refined) {
  say("  joint errors\n");
  for (std::size_t j = 0; j < refined.readings.corrections.size(); ++j) {
    const calibration::ReadingCorrection& c = refined.readings.corrections[j];
    say("    joint {}: gain {:+.6f}, once a turn {:.4f}°, twice a turn {:.4f}°\n", j + 1, c.gain,
        degrees(std::hypot(c.cos_1, c.sin_1)), degrees(std::hypot(c.cos_2, c.sin_2)));
  }
}

// Noise and model error, as far as they can be told apart. `beyond_chance`: they can.
void print_noise(const NoiseStatement& noise, bool beyond_chance) {
  say("  noise and model error together  {:8.3f} mm per axis\n", 1e3 * noise.total_m);
  if (noise.stated_m == 0) {
    say("  no row states its sigma_mm: all of it counts as error of the model\n");
  } else if (noise.contradicted) {
    say("  that is {:.1f} times the stated noise, which is therefore not believed\n",
        noise.total_m / noise.stated_m);
  } else if (beyond_chance) {
    say("{}",
        paragraph(fmt::format(
            "that is {:.1f} times the stated noise: {:.3f} mm per axis are the arm's, not the "
            "sensor's",
            noise.total_m / noise.stated_m, 1e3 * noise.unexplained_m)));
  }
}

nlohmann::ordered_json corrections_json(const calibration::ReadingModel& readings) {
  nlohmann::ordered_json corrections;
  for (const calibration::ReadingCorrection& c : readings.corrections) {
    corrections.push_back({{"gain", c.gain},
                           {"cos_1_rad", c.cos_1},
                           {"sin_1_rad", c.sin_1},
                           {"cos_2_rad", c.cos_2},
                           {"sin_2_rad", c.sin_2}});
  }
  return corrections;
}

}  // namespace

void print_refinement(const RefinementOutcome& outcome, std::size_t receivers) {
  const calibration::FitQuality& quality = outcome.refined->quality;
  say("\nThe refinement\n\n");
  if (outcome.nominal_rms_m) {
    say("  nominal, base and tool fitted   {:8.3f} mm RMS\n", 1e3 * *outcome.nominal_rms_m);
  }
  say("  residual of the fit             {:8.3f} mm RMS, {} measurements\n", 1e3 * quality.rms_m,
      quality.rows_used);
  print_noise(outcome.noise, quality.covariance_enlarged);
  if (!outcome.rejected_lines.empty()) {
    say("  outliers, by line               {}\n", lines_in_words(outcome.rejected_lines));
  }
  if (!outcome.fitted.readings.empty()) print_corrections(*outcome.refined);
  if (outcome.fitted.receiver_offsets) {
    say("  offsets of the ranges, mm      ");
    for (std::size_t k = 0; k < receivers; ++k) {
      say(" {:+.3f}", 1e3 * outcome.refined->receiver_offsets_m[k]);
    }
    say("\n");
  }
  if (outcome.fitted.scale) {
    say("  measured lengths are {:+.4f} % too long\n", 100 * outcome.refined->scale);
  }
}

void print_models_tried(const RefinementOutcome* outcome) {
  say("\nModels tried: the mean of their validation rows, and the rows rejected\n\n");
  if (outcome == nullptr || outcome->tried.empty()) {
    say("  none: {}\n", outcome == nullptr ? "--method refined tries several"
                                           : "too few rows to leave some of them out of a fit");
    return;
  }
  Table table({"", "mm", "rejected", ""});
  for (const TriedModel& model : outcome->tried) {
    table.add_row({in_words(model), fmt::format("{:.3f}", 1e3 * model.left_out_mean_m),
                   std::to_string(model.rejected), model.written ? "written" : ""});
  }
  say("{}\n", table.render());
}

nlohmann::ordered_json refinement_json(const RefinementOutcome& outcome, std::size_t receivers) {
  const calibration::Refined& refined = *outcome.refined;
  nlohmann::ordered_json json{
      {"rms_m", refined.quality.rms_m},
      {"rows_used", refined.quality.rows_used},
      {"rows_rejected", refined.quality.rows_rejected},
      {"free_poses_rejected", outcome.free_poses_rejected},
      {"iterations", refined.quality.iterations},
      {"noise_factor", refined.quality.noise_factor},
      {"sigma_m", refined.quality.sigma_m},
      {"rejected_lines", outcome.rejected_lines},
      {"undetermined", outcome.undetermined},
      {"noise_and_model_error_m", outcome.noise.total_m},
      {"model_error_m", outcome.noise.unexplained_m},
      {"stated_sigma_believed", outcome.noise.stated_m > 0 && !outcome.noise.contradicted}};
  if (outcome.merged_rows) json["rows_merged_to"] = *outcome.merged_rows;
  if (outcome.geometry_left_out_mean_m) {
    json["geometry_left_out_mean_m"] = *outcome.geometry_left_out_mean_m;
  }
  for (const TriedModel& model : outcome.tried) {
    json["models_tried"].push_back({{"model", in_words(model)},
                                    {"left_out_mean_m", model.left_out_mean_m},
                                    {"rows_rejected", model.rejected},
                                    {"written", model.written}});
  }
  if (outcome.nominal_rms_m) json["nominal_rms_m"] = *outcome.nominal_rms_m;
  if (!outcome.fitted.readings.empty()) {
    json["reading_corrections"] = corrections_json(refined.readings);
  }
  if (outcome.offered) {
    json["corrections_offered"] = {{"correct", corrections_in_words(outcome.offered->terms)},
                                   {"left_out_mean_m", outcome.offered->left_out_mean_m}};
  }
  for (std::size_t k = 0; outcome.fitted.receiver_offsets && k < receivers; ++k) {
    json["range_offsets_m"].push_back(refined.receiver_offsets_m[k]);
  }
  if (outcome.fitted.scale) json["length_scale"] = refined.scale;
  return json;
}

}  // namespace armsig::tool
