// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/range_health.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kSampled = 60;
// A slip with which none of so many meets is given up: of 16 receivers there are 156 to try.
constexpr std::size_t kEnoughToGiveUp = 6;
// A slip is named where so large a share of the rows that failed meets in a point with it.
constexpr double kMost = 0.7;
constexpr double kRuledOut = 5;  // sigmas

constexpr const char* kCureOfScale =
    "air_c of every row where the sound goes, with calibrated_at_c of the sensor, or --method "
    "refined --correct scale";

std::string cure_of(Error error) {
  if (error == Error::kRangesInconsistent) {
    return "where the receivers stand, in the order of the columns r1, r2, ..., the ranges in the "
           "unit of their names and from their zero, and the temperature of the air";
  }
  if (error == Error::kTooFewReceivers) return "targets that three receivers hear, or more";
  if (error == Error::kSingular) return "targets away from the plane of the receivers";
  return remedy_in_words(error);
}

}  // namespace

void RangeHealth::add(const MeasurementRow& row, double scale) {
  if (!sensor_ || row.ranges_m.size() != sensor_->receivers_S.size()) return;
  std::size_t heard = 0;
  for (std::size_t k = 0; k < row.ranges_m.size(); ++k) {
    if (!row.ranges_m[k]) continue;
    ++heard_[k];
    ++heard;
  }
  if (heard == 0) return;
  ++rows_;
  scale_->add(row, scale);
  const auto position = locate(row, *sensor_, scale);
  if (position) return;
  ++failures_[position.error()];
  if (position.error() == Error::kRangesInconsistent && sample_.size() < kSampled) {
    sample_.push_back({row, scale});
  }
}

std::size_t RangeHealth::located_by(const SensorDescription& sensor, double factor) const {
  std::size_t located = 0;
  for (std::size_t k = 0; k < sample_.size(); ++k) {
    if (k == kEnoughToGiveUp && located == 0) return 0;
    located += locate(sample_[k].row, sensor, factor * sample_[k].scale) ? 1 : 0;
  }
  return located;
}

std::size_t RangeHealth::located_by(const RangeScale& scale) const {
  return static_cast<std::size_t>(std::ranges::count_if(sample_, [&](const Kept& kept) {
    return locate(kept.row, *sensor_, kept.scale / (1 + scale.excess(kept.row.line))).has_value();
  }));
}

// The larger of ranges and receivers is left as it is: against its sigma the noise is its own.
// NOLINTNEXTLINE(readability-function-size): a list of slips
std::optional<RangeHealth::Slip> RangeHealth::likeliest_slip() const {
  std::size_t most = 0;
  Slip likeliest;
  const auto try_out = [&](const SensorDescription& sensor, double factor, std::string words,
                           const char* mend) {
    const std::size_t located = located_by(sensor, factor);
    if (located <= most) return;
    most = located;
    likeliest = {.words = std::move(words), .mend = mend};
  };
  const char* units =
      "ranges and receivers in the units of their names, and distances, not ways out and back";
  for (const auto& [factor, words] : {std::pair{1e-3, "a thousandth"},
                                      {1e3, "a thousand times"},
                                      {0.5, "half"},
                                      {2.0, "twice"}}) {
    SensorDescription enlarged = *sensor_;
    for (Vector3& p_S : enlarged.receivers_S) p_S /= std::min(factor, 1.0);
    try_out(enlarged, std::max(factor, 1.0), fmt::format("with {} the ranges", words), units);
  }
  const std::size_t receivers = sensor_->receivers_S.size();
  for (std::size_t a = 0; a < receivers; ++a) {
    for (const auto& [factor, words] :
         {std::pair{1e-3, "a thousandth"}, {1e3, "a thousand times"}}) {
      SensorDescription other_unit = *sensor_;
      other_unit.receivers_S[a] *= factor;
      try_out(other_unit, 1, fmt::format("with {} the place of receiver {}", words, a + 1),
              "the place of every receiver in the unit of its name");
    }
    for (std::size_t b = a + 1; b < receivers; ++b) {
      SensorDescription swapped = *sensor_;
      std::swap(swapped.receivers_S[a], swapped.receivers_S[b]);
      try_out(swapped, 1, fmt::format("with receivers {} and {} swapped", a + 1, b + 1),
              "the receivers in the order of the columns r1, r2, ...");
    }
  }
  const std::optional<RangeScale> scale = scale_->result();
  if (const std::size_t located = scale ? located_by(*scale) : 0; located > most) {
    most = located;
    likeliest = {.words = scale->in_words() + ": with that corrected",
                 .mend = scale->drifts() ? kCureOfDrift : kCureOfScale};
  }
  if (static_cast<double>(most) < kMost * static_cast<double>(sample_.size())) return std::nullopt;
  likeliest.words += fmt::format(" {} of {} of them do", most, sample_.size());
  return likeliest;
}

std::string RangeHealth::never_heard() const {
  std::vector<std::string> silent;
  for (std::size_t k = 0; k < sensor_->receivers_S.size(); ++k) {
    if (heard_[k] == 0) silent.push_back(std::to_string(k + 1));
  }
  if (silent.empty()) return {};
  return fmt::format("; receiver{} {} {} never heard", silent.size() == 1 ? "" : "s",
                     all_of(silent), silent.size() == 1 ? "was" : "were");
}

std::optional<Problem> RangeHealth::problem(const std::string& file) const {
  std::size_t failed = 0;
  for (const auto& [error, count] : failures_) failed += count;
  if (2 * failed <= rows_) return std::nullopt;
  const Error why =
      std::ranges::max_element(failures_, {}, [](const auto& f) { return f.second; })->first;
  return problem_of(why, failed, file);
}

std::optional<Problem> RangeHealth::contradiction(const std::string& file) const {
  const auto found = failures_.find(Error::kRangesInconsistent);
  if (found == failures_.end() || 2 * found->second <= rows_) return std::nullopt;
  return problem_of(found->first, found->second, file);
}

std::optional<RangeScale> RangeHealth::drift() const {
  if (!scale_) return std::nullopt;
  auto scale = scale_->result();
  if (!scale || !scale->drifts()) return std::nullopt;
  return scale;
}

bool RangeHealth::rules_out(double factor) const {
  const auto common = scale_ ? scale_->common() : std::nullopt;
  if (!common) return false;
  const double off = std::abs(factor - 1 - common->excess);
  return off > kRuledOut * common->sigma && 2 * std::abs(common->excess) < std::abs(factor - 1);
}

Problem RangeHealth::problem_of(Error why, std::size_t failed, const std::string& file) const {
  Problem problem{file, 0, 0,
                  fmt::format("{} of {} rows with ranges give no position: {}{}", failed, rows_,
                              describe(why), never_heard()),
                  cure_of(why)};
  if (why != Error::kRangesInconsistent) return problem;
  if (const auto slip = likeliest_slip()) {
    problem.what += "; " + slip->words;
    problem.expected = slip->mend;
  }
  return problem;
}

}  // namespace armsig::tool
