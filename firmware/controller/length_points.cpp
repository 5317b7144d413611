// SPDX-License-Identifier: MIT
#include "firmware/controller/length_points.hpp"

#include <cstddef>

namespace armsig::controller {
namespace {

// Hypotheses of which lengths are bad that are looked at in one tick; eight lengths have 93.
constexpr int kStepsATick = 8;

std::string_view in_words(Error error) {
  switch (error) {
    case Error::kTooFewReceivers:
      return "fewer than three lengths";
    case Error::kReceiversCollinear:
      return "the anchors of the lengths that were read stand on one line";
    case Error::kRangesInconsistent:
      return "the lengths do not meet in a point";
    default:
      return "the lengths do not fix a point: it is too near the plane of the anchors";
  }
}

}  // namespace

std::unexpected<Error> LengthPoints::refuse(std::string_view words) {
  ++without_point_;
  words_ = words;
  return std::unexpected(Error::kSensorMalformed);
}

Result<void> LengthPoints::begin(const hal::LengthReading& reading) {
  const std::size_t anchors = anchors_.p_S.size();
  if (reading.lengths_m.size() > anchors) return refuse("more lengths than anchors");
  measurement::Ranges ranges;
  for (std::size_t i = 0; i < anchors; ++i) {
    const auto length_m = i < reading.lengths_m.size() ? reading.lengths_m[i] : std::nullopt;
    const double metres = length_m.value_or(0) + offsets_m_[i];
    ranges.push_back({.metres = metres, .valid = length_m.has_value() && metres > 0});
  }
  reading_ = reading;
  trilateration_.emplace(anchors_, ranges);
  return {};
}

Result<std::optional<hal::PointReading>> LengthPoints::locate() {
  for (int i = 0; i < kStepsATick; ++i) {
    if (trilateration_->step()) continue;
    const auto position = trilateration_->result();
    trilateration_.reset();
    if (!position) return refuse(in_words(position.error()));
    return hal::PointReading{.p_S = position->p_S,
                             .covariance_m2 = position->covariance_m2,
                             .at = reading_.at,
                             .sequence = reading_.sequence};
  }
  return std::nullopt;
}

// A reading that comes while another one is looked at waits.
Result<std::optional<hal::PointReading>> LengthPoints::do_poll(hal::Instant now) {
  if (!trilateration_) {
    const auto polled = lengths_.poll(now);
    if (!polled) {
      words_ = {};
      return std::unexpected(polled.error());
    }
    if (!*polled) return std::nullopt;
    if (auto begun = begin(**polled); !begun) return std::unexpected(begun.error());
  }
  return locate();
}

std::string_view LengthPoints::do_words(Error error) const {
  return error == Error::kSensorMalformed && !words_.empty() ? words_ : lengths_.words(error);
}

}  // namespace armsig::controller
