// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "firmware/host_tool/presentation/differences.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 3> kKinds{"socket", "plane", "wire"};

std::string_view kind_name(InstrumentKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

double sigma_mm(const PlaceFit& fit, std::size_t instrument) {
  return 1e3 * std::sqrt(fit.scales().sigma_squared[instrument]);
}

// Of one place: how many touches, how many of them rejected.
struct TouchCount {
  std::size_t all = 0;
  std::size_t rejected = 0;
};

std::vector<TouchCount> touch_counts(const PlaceCalibration& found) {
  std::vector<TouchCount> of(found.task->places.size());
  for (std::size_t k = 0; k < found.task->touches.size(); ++k) {
    TouchCount& count = of[found.task->touches[k].place];
    ++count.all;
    count.rejected += found.fit->weights()[k] == 0 ? 1U : 0U;
  }
  return of;
}

void print_places(const PlaceCalibration& found) {
  Table table({"Place", "Instrument", "Touches", "Rejected", "x mm", "y mm", "z mm"});
  const std::vector<TouchCount> of = touch_counts(found);
  for (std::size_t s = 0; s < of.size(); ++s) {
    const TouchedPlace& place = found.fit->state().places[s];
    // Of a plane, its point next to the base.
    const Vector3 at = place.kind == InstrumentKind::kPlane
                           ? Vector3(place.distance_m * place.point_B)
                           : place.point_B;
    table.add_row({place.name, std::string(kind_name(place.kind)), fmt::format("{}", of[s].all),
                   fmt::format("{}", of[s].rejected), fmt::format("{:.2f}", 1e3 * at.x()),
                   fmt::format("{:.2f}", 1e3 * at.y()), fmt::format("{:.2f}", 1e3 * at.z())});
  }
  say("\nWhere the places are, in the frame of the nominal base\n\n{}", table.render());
}

void print_lengths(const PlaceCalibration& found) {
  if (found.known.empty()) return;
  Table table({"Known length", "Stated mm", "Found without it mm", "1 sigma mm", "Used"});
  for (std::size_t k = 0; k < found.known.size(); ++k) {
    const SocketLength& known = found.known[k];
    const PredictedLength& length = found.predicted[k];
    const auto& places = found.task->places;
    table.add_row({fmt::format("{} to {}", places[known.from].name, places[known.to].name),
                   fmt::format("{:.3f}", 1e3 * known.length_m),
                   fmt::format("{:.3f}", 1e3 * length.length_m),
                   fmt::format("{:.3f}", 1e3 * length.sigma_m), length.believed ? "yes" : "no"});
  }
  say("\nThe known lengths\n\n{}", table.render());
}

void print_instruments(const PlaceCalibration& found) {
  const PlaceTask& task = *found.task;
  say("\n");
  for (std::size_t i = 0; i < task.instruments.size(); ++i) {
    if (!task.uses(i)) continue;
    const Instrument& instrument = task.instruments[i];
    say("  {}: 1 sigma of a number is {:.4f} mm, the arm's repeatability included\n",
        instrument.name, sigma_mm(*found.fit, i));
    if (instrument.kind != InstrumentKind::kWire) continue;
    const WireScale& scale = found.fit->state().scales[i];
    const Eigen::Index c = found.fit->columns().scales[i];
    const Eigen::MatrixXd& C = found.fit->covariance();
    say("  {}: gain {:+.4f} ± {:.4f} %, zero {:.3f} ± {:.3f} mm\n", instrument.name,
        1e2 * scale.gain, 1e2 * std::sqrt(C(c, c)), 1e3 * scale.zero_m,
        1e3 * std::sqrt(C(c + 1, c + 1)));
  }
}

// A length is known by a bar, or by a wire.
bool has_length(const PlaceTask& task) { return !task.lengths.empty() || task.has_wires(); }

std::string determined_in_words(const PlaceCalibration& found) {
  const Determined& of = found.determined;
  const std::size_t joints = found.task->nominal.joints.size();
  const bool length = has_length(*found.task);
  std::string words = fmt::format(
      "The touches determine {} of the {} numbers of geometry and tool. At most {} can be "
      "determined {} a known length. The nominal base is the frame, and the nominal model holds "
      "the others.",
      of.geometry, of.of_geometry, 4 * joints - (length ? 3 : 4), length ? "with" : "without");
  if (found.fit->parts().gravity) {
    words +=
        fmt::format(" Of the {} gravity terms, {:.1f} are determined.", of.of_gravity, of.gravity);
  }
  if (found.fit->parts().maps) {
    words += fmt::format(" So are {:.0f} coefficients of the joint error maps.", of.maps);
  }
  return words;
}

void print_placements(const PlaceCalibration& found) {
  if (!found.validation) {
    say("  no validation: it needs two placements or more, each with enough touches\n");
    return;
  }
  const PlacementValidation& left_out = *found.validation;
  say("  each of {} placements left out in turn: {:.3f} mm RMS, {:.3f} mm mean, {:.3f} mm at "
      "most\n",
      left_out.placements, 1e3 * left_out.rms_m, 1e3 * left_out.mean_m, 1e3 * left_out.largest_m);
}

void print_stated(const PlaceCalibration& found, const SignatureRecord& record) {
  say("\nHow accurate it is\n\n");
  print_placements(found);
  const ToolAccuracy::Predicted& predicted = *record.accuracy.predicted;
  say("{}", paragraph(fmt::format("predicted tool error, 1 sigma, after the best rigid motion: "
                                  "{:.3f} mm RMS over {}",
                                  1e3 * predicted.rms_m, region_in_words(predicted.region))));
  say("{}", paragraph(fmt::format(
                "the scale of all lengths is part of it: it is known to {:.0f} ppm, 1 sigma, which "
                "move the tool by {:.3f} mm RMS{}",
                1e6 * found.knowledge.scale_sigma, 1e3 * found.knowledge.by_scale_m,
                has_length(*found.task) ? "" : "; a bar of known length determines it")));
}

nlohmann::ordered_json lengths_json(const PlaceCalibration& found) {
  auto json = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < found.known.size(); ++k) {
    const PredictedLength& length = found.predicted[k];
    json.push_back({{"from", found.task->places[found.known[k].from].name},
                    {"to", found.task->places[found.known[k].to].name},
                    {"stated_m", found.known[k].length_m},
                    {"found_without_it_m", length.length_m},
                    {"sigma_m", length.sigma_m},
                    {"used", length.believed}});
  }
  return json;
}

nlohmann::ordered_json places_json(const PlaceCalibration& found) {
  auto json = nlohmann::ordered_json::array();
  const std::vector<TouchCount> of = touch_counts(found);
  for (std::size_t s = 0; s < of.size(); ++s) {
    const TouchedPlace& place = found.fit->state().places[s];
    nlohmann::ordered_json one{{"name", place.name},
                               {"kind", kind_name(place.kind)},
                               {"touches", of[s].all},
                               {"rejected", of[s].rejected}};
    one[place.kind == InstrumentKind::kPlane ? "normal" : "position_m"] = {
        place.point_B.x(), place.point_B.y(), place.point_B.z()};
    if (place.kind == InstrumentKind::kPlane) one["distance_m"] = place.distance_m;
    json.push_back(std::move(one));
  }
  return json;
}

nlohmann::ordered_json instruments_json(const PlaceCalibration& found) {
  auto json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < found.task->instruments.size(); ++i) {
    if (!found.task->uses(i)) continue;
    const Instrument& instrument = found.task->instruments[i];
    nlohmann::ordered_json one{{"name", instrument.name},
                               {"kind", kind_name(instrument.kind)},
                               {"sigma_m", sigma_mm(*found.fit, i) / 1e3}};
    if (instrument.kind == InstrumentKind::kWire) {
      one["gain"] = found.fit->state().scales[i].gain;
      one["zero_m"] = found.fit->state().scales[i].zero_m;
    }
    json.push_back(std::move(one));
  }
  return json;
}

}  // namespace

void print_place_calibration(const PlaceCalibration& found, const SignatureRecord& record,
                             const std::string& measurements, const std::string& out) {
  say("{}: arm signature from {}\n\n", record.arm_name, measurements);
  say("  {} touches of {} places: {} rejected as outliers\n", found.task->touches.size(),
      found.task->places.size(), found.rejected.size());
  print_places(found);
  print_lengths(found);
  print_instruments(found);
  say("\n{}", paragraph(determined_in_words(found)));
  const std::string note = near_parallel_note(record.signature);
  say("\nPseudo Denavit-Hartenberg parameters\n\n{}{}{}", dh_table(record.signature.pseudo_dh),
      note.empty() ? "" : "\n", note);
  if (const auto differences = difference_table(record)) {
    say("\n{}", in_words(*differences, record.signature.joint_count()));
  }
  print_stated(found, record);
  say("\nWritten: {}\n", file_in_words(out));
}

nlohmann::ordered_json json_of(const PlaceCalibration& found, const SignatureRecord& record,
                               const std::string& out) {
  nlohmann::ordered_json json{{"status", 0},
                              {"arm", record.arm_name},
                              {"method", record.method},
                              {"touches", found.task->touches.size()},
                              {"rejected", found.rejected.size()},
                              {"warnings", record.warnings},
                              {"places", places_json(found)},
                              {"known_lengths", lengths_json(found)},
                              {"instruments", instruments_json(found)},
                              {"determined", found.determined.geometry},
                              {"determined_of", found.determined.of_geometry},
                              {"gravity_determined", found.determined.gravity},
                              {"maps_determined", found.determined.maps},
                              {"predicted_tool_error_m", record.accuracy.predicted->rms_m},
                              {"predicted_region", name(record.accuracy.predicted->region)},
                              {"scale_sigma", found.knowledge.scale_sigma},
                              {"moved_by_scale_m", found.knowledge.by_scale_m}};
  json["validation"] = nullptr;
  if (found.validation) {
    json["validation"] = {
        {"placements", found.validation->placements}, {"touches", found.validation->touches},
        {"mean_m", found.validation->mean_m},         {"rms_m", found.validation->rms_m},
        {"largest_m", found.validation->largest_m},   {"enlarged_by", found.validation->factor}};
  }
  json["signature"] = signature_json(record.signature);
  json["out"] = out;
  return json;
}

}  // namespace armsig::tool
