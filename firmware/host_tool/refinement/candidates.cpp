// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/calibration/packed_deflections.hpp"
#include "core/calibration/signature_of_model.hpp"
#include "core/calibration/standing_still.hpp"
#include "firmware/analysis/starts/determination.hpp"

namespace armsig::tool {
namespace {

// Rows that may be rejected before the fit itself is in doubt.
constexpr double kMostRejected = 0.4;
// Residual lengths of three coordinates are 1.7 sigma; so many are more than outliers let through.
constexpr double kCoarse = 4;
// A richer model must earn its keep by this much on poses that it has not seen.
constexpr double kWorthDeflections = 0.98;

constexpr calibration::ModelParts kGeometryAlone{.gravity = false, .maps = false};
constexpr calibration::ModelParts kWithGravity{.gravity = true, .maps = false};
constexpr calibration::ModelParts kWithMaps{.gravity = false, .maps = true};
constexpr calibration::ModelParts kWholeModel{};
// Of a vertical, beside the one that is known (a logarithm of likelihoods); and how often one is
// looked for.
constexpr double kWorthVertical = 12;
constexpr int kLooksForVertical = 3;
constexpr double kCertain = 5;  // sigmas of a joint's play
constexpr calibration::ReadingTerms kGearsAlone{true, false, false};
constexpr std::array<calibration::ReadingTerms, 4> kCorrections{
    {{false, true, false}, {false, false, true}, {true, true, false}, {true, true, true}}};
// Errors of gears larger than this are no encoder's; and beyond so many sigmas no chance.
constexpr double kNotableGain = 5e-4;
constexpr double kSignificantGain = 4;

bool fits_the_engine(const FitStart& start) {
  return calibration::Engine::columns(start.model, start.targets.size()) <=
         calibration::kMaxGeometry;
}

// Joints whose maps no signature holds, and no servo goes by; each a bit.
std::uint8_t without_bounds(const calibration::PackedDeflections& deflections) {
  std::uint8_t joints = 0;
  for (std::size_t j = 0; j < deflections.maps.size(); ++j) {
    if (!calibration::is_bounded(deflections.maps[j])) {
      joints = static_cast<std::uint8_t>(joints | 1U << j);
    }
  }
  return joints;
}

}  // namespace

bool predicts_better(const Candidate& candidate, const Candidate& other, double share) {
  if (!candidate.left_out || !other.left_out) return false;
  double sum_m = 0;
  double other_sum_m = 0;
  for (std::size_t k = 0; k < candidate.verdicts.size(); ++k) {
    if (candidate.verdicts[k].rejected && other.verdicts[k].rejected) continue;
    sum_m += static_cast<double>(candidate.left_out->length_m[k]);
    other_sum_m += static_cast<double>(other.left_out->length_m[k]);
  }
  return sum_m <= share * other_sum_m;
}

std::size_t taken_back(const Candidate& candidate, const Candidate& other) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < candidate.verdicts.size(); ++k) {
    if (other.verdicts[k].rejected && !candidate.verdicts[k].rejected) ++count;
  }
  return count;
}

bool is_certain(const calibration::HalfPlay& half) {
  return std::abs(half.value) > kCertain * half.sigma;
}

bool has_certain_play(const Candidate& found) {
  return std::ranges::any_of(found.half_plays, is_certain);
}

bool is_off_by_its_gear(const calibration::Refined& refined, std::size_t joint) {
  const auto& corrections = refined.readings.corrections;
  const std::size_t column = refined.layout.gain[joint];
  if (joint >= corrections.size() || column == calibration::kNoColumn) return false;
  const double gain = std::abs(corrections[joint].gain);
  return gain >= kNotableGain &&
         gain > kSignificantGain * calibration::parameter_sigma(refined.information, column);
}

double Candidates::most_m() const {
  return std::max(limits_.rms_m, kCoarse * std::sqrt(fitting_.stated_variance()));
}

std::expected<Candidate, Refusal> Candidates::fitted(const FitStart& from,
                                                     const calibration::ModelParts& parts,
                                                     const calibration::ParameterRequest& request) {
  FitStart start = from;
  const auto summary = fitting_.run(start, parts);
  if (!summary) return std::unexpected(Refusal{summary.error(), 0, 0});
  Candidate found;
  found.start = from;
  found.end = start;
  found.parts = parts;
  found.request = request;
  found.half_plays = fitting_.half_plays(start.model.joint_count());
  found.moved_by_play = fitting_.moved_by_play();
  found.half = fitting_.play().half;
  found.summary = *summary;
  found.variance = fitting_.engine().scales().sigma_squared;
  found.model = std::make_shared<calibration::ArmModel>(start.model);
  calibration::Refined& refined = *found.refined;
  refined.signature = from.signature;
  refined.signature.s_model.clear();
  refined.signature.pseudo_dh.clear();
  refined.readings.couplings = log_.nominal.couplings;
  if (!request.readings.empty()) {
    for (const calibration::JointModel& joint : start.model.joints) {
      refined.readings.corrections.push_back(joint.correction);
    }
  }
  refined.receiver_offsets_m = start.model.sensor.offset_m;
  refined.scale = start.model.sensor.scale;
  found.verdicts.resize(log_.rows.size());
  fitting_.report(found.verdicts, refined.quality);
  refined.quality.iterations = summary->rounds;
  refined.quality.noise_freedom =
      static_cast<double>(refined.quality.scalars) - summary->degrees_of_model;
  std::vector<double> scratch(calibration::kMaxParameters * calibration::kMaxParameters);
  const auto done = calibration::geometry_to_signature(
      start.model, start.targets, fitting_.engine(), refined, request, scratch);
  if (!done) return std::unexpected(done.error());
  for (std::size_t t = 0; t < start.targets.size(); ++t) {
    if (start.targets[t].rows == 1) found.alone.push_back(t);
  }
  return found;
}

std::expected<void, Refusal> Candidates::believable(const Candidate& found) const {
  const auto refuse = [](Error error, double value, double allowed) {
    return std::unexpected(Refusal{error, value, allowed});
  };
  const double allowed = kMostRejected * static_cast<double>(found.summary.rows);
  if (static_cast<double>(found.summary.rejected) > allowed) {
    return refuse(Error::kTooManyOutliers, static_cast<double>(found.summary.rejected), allowed);
  }
  if (const double rms_m = found.refined->quality.rms_m; !(rms_m <= most_m())) {
    return refuse(Error::kNotConverged, rms_m, most_m());
  }
  if (log_.start) return {};
  return calibration::like_its_drawing(found.start.signature, found.refined->signature, limits_);
}

std::expected<Candidate, Refusal> Candidates::geometry(const FitStart& from) {
  return geometry(from, log_.request);
}

std::expected<Candidate, Refusal> Candidates::geometry(
    const FitStart& from, const calibration::ParameterRequest& request) {
  auto found = fitted(from, kGeometryAlone, request);
  if (!found) return found;
  if (const auto good = believable(*found); !good) return std::unexpected(good.error());
  score(*found);
  return found;
}

// A model too rich for the rows is no error, only no choice.
std::optional<Candidate> Candidates::with_terms(const Candidate& plain,
                                                const calibration::ReadingTerms& terms) {
  FitStart start = plain.start;
  calibration::ParameterRequest request = log_.request;
  request.readings.resize(log_.nominal.joints.size(), terms);
  const auto readings = [](const calibration::Observation& row) { return row.readings; };
  for (std::size_t j = 0; j < request.readings.size(); ++j) {
    const JointType type = log_.nominal.joints[j].type;
    if (calibration::stood_still(log_.rows, readings, j, type)) request.readings[j] = {};
  }
  calibration::ask_for(request, start.model);
  if (!fits_the_engine(start)) return std::nullopt;
  auto candidate = fitted(start, kGeometryAlone, request);
  if (!candidate || !believable(*candidate)) return std::nullopt;
  return std::move(*candidate);
}

bool Candidates::corrections_take_back(const Candidate& plain) {
  if (plain.summary.rejected < kFewestTakenBack) return false;
  const auto richest = with_terms(plain, kCorrections.back());
  return richest && taken_back(*richest, plain) >= kFewestTakenBack;
}

std::optional<Candidate> Candidates::corrected(const Candidate& plain) {
  std::optional<Candidate> best;
  for (const calibration::ReadingTerms& terms : kCorrections) {
    auto candidate = with_terms(plain, terms);
    if (!candidate) continue;
    score(*candidate);
    if (predicts_better(*candidate, best ? *best : plain, kWorthCorrections)) {
      best = std::move(candidate);
    }
  }
  return best;
}

std::optional<Candidate> Candidates::geared(const Candidate& plain, const Candidate& whole) {
  auto candidate = with_terms(plain, kGearsAlone);
  if (!candidate) return std::nullopt;
  bool off = false;
  for (std::size_t j = 0; j < log_.nominal.joints.size(); ++j) {
    off = off || is_off_by_its_gear(*candidate->refined, j);
  }
  if (!off) return std::nullopt;
  score(*candidate);
  if (!predicts_better(*candidate, whole, 1)) return std::nullopt;
  return candidate;
}

std::optional<Candidate> Candidates::bounded(const FitStart& bent, calibration::ModelParts parts,
                                             const calibration::ParameterRequest& request) {
  // What one pose alone shows, or a target next to an axis, may become a step in a map.
  for (std::size_t tries = 0; tries <= log_.nominal.joints.size(); ++tries) {
    auto found = fitted(bent, parts, request);
    if (!found || !believable(*found)) return std::nullopt;
    const calibration::PackedDeflections packed = calibration::packed(*found->model);
    if (calibration::check(packed, log_.nominal)) {
      score(*found);
      return std::move(*found);
    }
    const std::uint8_t steep = without_bounds(packed);
    if (steep == 0) return std::nullopt;
    parts.without_map = static_cast<std::uint8_t>(parts.without_map | steep);
  }
  return std::nullopt;
}

std::optional<Candidate> Candidates::pulled_along(const Vector3& up_0, const Candidate& geometry,
                                                  std::optional<Candidate> best) {
  FitStart bent = geometry.start;
  bent.model.up_0 = up_0;
  calibration::choose_gravity_terms(log_.nominal, bent.model);
  if (!fits_the_engine(bent)) return best;
  const bool bent_before = best.has_value();
  const auto consider = [&](const calibration::ModelParts& parts) {
    auto found = bounded(bent, parts, geometry.request);
    const bool better =
        found && predicts_better(*found, best ? *best : geometry, kWorthDeflections);
    if (better) best = std::move(found);
  };
  consider(kWithGravity);
  const bool bends = best.has_value();
  consider(kWholeModel);
  // Every arm bends a little: gravity that helps by itself, or does no harm, stays.
  if (!bends && !bent_before) consider(kWithMaps);
  return best;
}

std::optional<Candidate> Candidates::deflected(const Candidate& geometry) {
  if (!geometry.left_out) return std::nullopt;
  auto best = pulled_along(geometry.start.model.up_0, geometry, std::nullopt);
  // The second look is from a model that knows of it.
  for (int look = 0; look < kLooksForVertical; ++look) {
    const Candidate& known = best ? *best : geometry;
    const SuspectedVertical found = beside(known, Beside::Asked::kVertical).vertical();
    const Vector3 former = known.start.model.up_0;
    if (found.nats < kWorthVertical || found.share > kWorthDeflections) break;
    best = pulled_along(found.up_0, geometry, std::move(best));
    if (!best || best->start.model.up_0 == former) break;
  }
  if (best) deflect(*best);
  return best;
}

std::optional<Candidate> Candidates::fitted_as(const FitStart& start, const Candidate& like) {
  if (like.deflected) return bounded(start, like.parts, like.request);
  auto found = geometry(start, like.request);
  if (!found) return std::nullopt;
  return std::move(*found);
}

std::optional<Candidate> Candidates::played(const Candidate& plain, double worth) {
  if (!plain.left_out) return std::nullopt;
  const Beside more = beside(plain);
  if (more.nats_of_play() < worth) return std::nullopt;
  fitting_.assume_first_sides(more.first_sides());
  fitting_.find_play(true);
  auto found = fitted_as(plain.start, plain);
  if (found && has_certain_play(*found) && predicts_better(*found, plain, kWorthCorrections)) {
    if (plain.deflected) deflect(*found);
    return found;
  }
  fitting_.find_play(false);
  return std::nullopt;
}

void Candidates::score(Candidate& found) {
  if (found.parts.gravity || found.parts.maps) fitting_.note_covered(*found.model);
  found.left_out = fitting_.score(found.end, found.parts);
  if (!found.left_out) return;
  found.tried = tried_.size();
  tried_.push_back(model_tried(found));
}

TriedModel Candidates::model_tried(const Candidate& found) const {
  const auto& readings = found.request.readings;
  const auto corrected = std::ranges::find_if(readings, [](const calibration::ReadingTerms& terms) {
    return terms.gain || terms.first || terms.second;
  });
  return {.readings = corrected != readings.end() ? *corrected : calibration::ReadingTerms{},
          .parts = found.parts,
          .other_vertical = found.parts.gravity && found.end.model.up_0 != log_.nominal.up_0,
          .backlash = !found.half_plays.empty(),
          .coupling = std::nullopt,
          .left_out_mean_m = found.left_out->score.mean_m,
          .rejected = found.summary.rejected,
          .written = false};
}

// `found` was the last fit, with gravity or maps, and is taken.
void Candidates::deflect(Candidate& found) {
  const double k = found.left_out->score.factor;
  for (calibration::JointModel& joint : found.model->joints) {
    joint.deviation.fill(0);
    for (float& variance : joint.map_variance) variance *= static_cast<float>(k * k);
  }
  found.refined->readings.deflections = found.model.get();
  found.deflected = true;
}

}  // namespace armsig::tool
