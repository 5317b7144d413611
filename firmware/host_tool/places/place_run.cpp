// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/calibration/packed_deflections.hpp"
#include "firmware/host_tool/places/place_signature.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr int kMostRounds = 25;
// A simpler model must be so much likelier, in nats: arms bend and gears run out of true, and what
// few touches do not show is missed by what is stated where the model has no place for it.
constexpr double kAgainstGravity = 3;
constexpr double kAgainstMaps = 6;
// No ball in a socket and no wire is worse; and no session has more outliers.
constexpr double kWorstSigma_m = 1e-3;
constexpr double kMostRejectedShare = 0.4;
// So many neighbouring touches are not rejected by chance.
constexpr std::size_t kNeighbours = 5;
// Numbers beyond the unknowns that a sigma is found from.
constexpr std::size_t kToFindSigma = 6;

std::unique_ptr<PlaceFit> fit_from(const PlaceTask& task, const PlaceState& from,
                                   const PlaceParts& parts, const PlaceScales* scales, int rounds) {
  auto fit = std::make_unique<PlaceFit>(task, from, parts, scales);
  fit->run(rounds);
  return fit;
}

PlaceState state_of_places(const PlaceTask& task) {
  PlaceState start = nominal_state(task);
  find_places(task, start);
  constexpr PlaceParts kPlacesAlone{.geometry = false, .gravity = false, .maps = false};
  return fit_from(task, start, kPlacesAlone, nullptr, kMostRounds)->state();
}

std::unique_ptr<PlaceFit> geometry_alone(const PlaceTask& task) {
  return fit_from(task, state_of_places(task), {.gravity = false, .maps = false}, nullptr,
                  kMostRounds);
}

std::unique_ptr<PlaceFit> with_gravity(const PlaceTask& task, const PlaceFit& geometry) {
  return fit_from(task, geometry.state(), {.maps = false}, nullptr, kMostRounds);
}

// Fewer rejected touches count before the evidence, which is about those kept.
bool is_better(const PlaceFit& one, const PlaceFit& other, double nats) {
  if (one.rejected() != other.rejected()) return one.rejected() < other.rejected();
  return one.log_evidence() > other.log_evidence() + nats;
}

bool can_be_written(const PlaceFit& fit, const Arm& nominal) {
  return calibration::check(calibration::packed(fit.state().arm), nominal).has_value();
}

std::unexpected<Problem> no_fit(const std::string& file, std::string what, std::string expected) {
  return std::unexpected(Problem{file, 0, 0, std::move(what), std::move(expected)});
}

Read<void> check_touch_counts(const PlaceTask& task, const std::string& file) {
  std::size_t numbers = task.lengths.size();
  for (const TouchRow& touch : task.touches) {
    numbers += task.places[touch.place].kind == InstrumentKind::kSocket ? 3 : 1;
  }
  const std::size_t unknowns =
      3 * task.places.size() + 4 * task.nominal.joints.size() - 4 + kToFindSigma;
  if (numbers >= unknowns) return {};
  return no_fit(file,
                fmt::format("{} touches of {} places: {} numbers for {} unknowns",
                            task.touches.size(), task.places.size(), numbers, unknowns),
                "more touches of the same places, in other configurations");
}

// Without the lengths that are not believed; refused where half of them or more are not.
Read<void> judge_lengths(PlaceCalibration& found, const std::string& file) {
  PlaceTask& task = *found.task;
  if (task.lengths.empty()) return {};
  found.known = task.lengths;
  PlaceTask free = task;
  free.lengths.clear();
  const auto alone = fit_from(free, state_of_places(free), {.maps = false}, nullptr, kMostRounds);
  found.predicted = predicted_lengths(task, *alone);
  std::vector<std::string> wrong;
  std::vector<SocketLength> believed;
  for (std::size_t k = 0; k < found.known.size(); ++k) {
    const PredictedLength& length = found.predicted[k];
    if (length.believed) believed.push_back(found.known[k]);
    if (std::abs(length.off) <= kContradictingLength) continue;
    wrong.push_back(
        fmt::format("{} to {}: {:.3f} mm is stated, {:.3f} ± {:.3f} mm is found by all else",
                    task.places[found.known[k].from].name, task.places[found.known[k].to].name,
                    1e3 * found.known[k].length_m, 1e3 * length.length_m, 1e3 * length.sigma_m));
  }
  const std::size_t left_out = found.known.size() - believed.size();
  if (2 * left_out >= found.known.size() && left_out > 0) {
    return no_fit(file, fmt::format("the known lengths contradict each other: {}", wrong.front()),
                  "the lengths of the bars as they stand; exchanged bars look like this");
  }
  for (const std::string& words : wrong) {
    found.warnings.push_back(words + (left_out > 0
                                          ? "; it is left out: measure the bar again"
                                          : "; measure the bar again, or look whether the base "
                                            "was pushed"));
  }
  task.lengths = std::move(believed);
  return {};
}

Read<void> check_fit(const PlaceCalibration& found, const std::string& file) {
  const PlaceFit& fit = *found.fit;
  const PlaceTask& task = *found.task;
  if (static_cast<double>(fit.rejected()) >
      kMostRejectedShare * static_cast<double>(task.touches.size())) {
    return no_fit(file,
                  fmt::format("{} of {} touches fit no place", fit.rejected(), task.touches.size()),
                  "touches of this arm, each with the name of the place that it was at");
  }
  for (std::size_t i = 0; i < task.instruments.size(); ++i) {
    const double sigma_m = std::sqrt(fit.scales().sigma_squared[i]);
    if (!task.uses(i) || sigma_m <= kWorstSigma_m) continue;
    return no_fit(file,
                  fmt::format("{}: the touches miss their places by {:.1f} mm, 1 sigma of a "
                              "number",
                              task.instruments[i].name, 1e3 * sigma_m),
                  "at most 1 mm: look at the names of the places, the lengths, the arm "
                  "description and the units");
  }
  return {};
}

void warn_of_single_touches(PlaceCalibration& found) {
  std::vector<std::size_t> touched(found.task->places.size(), 0);
  for (const TouchRow& touch : found.task->touches) ++touched[touch.place];
  for (std::size_t s = 0; s < touched.size(); ++s) {
    if (touched[s] > 1) continue;
    found.warnings.push_back(
        fmt::format("{}: a single touch, which nothing checks", found.task->places[s].name));
  }
}

void warn_of_gains(PlaceCalibration& found) {
  for (std::size_t i = 0; i < found.task->instruments.size(); ++i) {
    const auto off = gain_off(*found.fit, i);
    if (!off || std::abs(*off) <= kContradictingLength) continue;
    found.warnings.push_back(fmt::format(
        "{}: a gain of {:.3f} % is found, {:.1f} sigma from what is stated; measure "
        "the wire beside a known length",
        found.task->instruments[i].name, 100 * found.fit->state().scales[i].gain, std::abs(*off)));
  }
}

// Neighbouring touches that are rejected say the same as a push that was found.
void warn_of_pushes(PlaceCalibration& found) {
  if (const auto push = find_push(*found.task, *found.fit)) {
    found.warnings.push_back(
        fmt::format("from line {} on the tool is {:.2f} mm from where it was before: the base or "
                    "all places were pushed; measure again, or keep one part",
                    push->line, 1e3 * push->moved_m));
  }
  std::size_t together = 0;
  for (std::size_t k = 0; k < found.task->touches.size(); ++k) {
    together = found.fit->weights()[k] > 0 ? 0 : together + 1;
    if (together != kNeighbours) continue;
    found.warnings.push_back(
        fmt::format("line {} and those after it are rejected together: the base or a place was "
                    "pushed, or a wire is off its pulley",
                    found.task->touches[k + 1 - kNeighbours].line));
  }
}

void warn_of_rejected(PlaceCalibration& found) {
  for (const RejectedTouch& touch : found.rejected) {
    const std::string& name = found.task->places[touch.place].name;
    found.warnings.push_back(
        touch.fits ? fmt::format("line {}: named {}, but the tool was at {}; it is rejected",
                                 touch.line, name, found.task->places[*touch.fits].name)
                   : fmt::format("line {}: {:.2f} mm off {}: slipped, or another place; it is "
                                 "rejected",
                                 touch.line, 1e3 * touch.off_m, name));
  }
}

}  // namespace

std::unique_ptr<PlaceFit> fit_without_maps(const PlaceTask& task) {
  return with_gravity(task, *geometry_alone(task));
}

std::unique_ptr<PlaceFit> fit_places(const PlaceTask& task) {
  auto geometry = geometry_alone(task);
  auto bent = with_gravity(task, *geometry);
  auto best = fit_from(task, bent->state(), {}, &bent->scales(), kMostRounds);
  const auto is_beaten_by = [&](const PlaceFit& simpler, double nats) {
    return !can_be_written(*best, task.nominal) || is_better(simpler, *best, nats);
  };
  if (is_beaten_by(*bent, kAgainstMaps)) best = std::move(bent);
  if (is_beaten_by(*geometry, kAgainstGravity)) best = std::move(geometry);
  return best;
}

Read<PlaceCalibration> calibrate_by_places(PlaceTask task, const std::string& file) {
  PlaceCalibration found;
  found.task = std::make_unique<PlaceTask>(std::move(task));
  if (auto counted = check_touch_counts(*found.task, file); !counted) {
    return std::unexpected(std::move(counted).error());
  }
  if (auto judged = judge_lengths(found, file); !judged) {
    return std::unexpected(std::move(judged).error());
  }
  found.fit = fit_places(*found.task);
  if (auto checked = check_fit(found, file); !checked) {
    return std::unexpected(std::move(checked).error());
  }
  found.rejected = rejected_touches(*found.task, *found.fit);
  found.validation = validate_by_placement(*found.task, *found.fit);
  found.determined = determined(*found.fit);
  warn_of_rejected(found);
  warn_of_single_touches(found);
  warn_of_gains(found);
  warn_of_pushes(found);
  if (auto written = add_signature(found); !written) {
    return no_fit(file, refusal_in_words(written.error(), JointType::kRevolute),
                  remedy_in_words(written.error().error));
  }
  return found;
}

}  // namespace armsig::tool
