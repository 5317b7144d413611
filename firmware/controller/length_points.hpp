// SPDX-License-Identifier: MIT
// An instrument of lengths as one of points: where the lengths from known anchors meet.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/measurement/trilateration.hpp"
#include "hal/length_instrument.hpp"
#include "hal/point_instrument.hpp"

namespace armsig::controller {

using LengthOffsets = FixedVector<double, hal::kMaxLengths>;

class LengthPoints final : public hal::PointInstrument {
 public:
  // `offsets_m` are added to the lengths; `lengths` outlives it. Preconditions: the anchors have
  // passed measurement::check(), and have one offset each.
  LengthPoints(const measurement::ReceiverArray& anchors, const LengthOffsets& offsets_m,
               hal::LengthInstrument& lengths)
      : anchors_(anchors), offsets_m_(offsets_m), lengths_(lengths) {}
  // What it is working on refers to its own anchors.
  LengthPoints(const LengthPoints&) = delete;
  LengthPoints& operator=(const LengthPoints&) = delete;

 private:
  // Beside the errors of the lengths: kSensorMalformed (more lengths than anchors; lengths that do
  // not tell a point, by words()).
  Result<std::optional<hal::PointReading>> do_poll(hal::Instant now) override;
  [[nodiscard]] std::string_view do_words(Error error) const override;
  [[nodiscard]] std::uint32_t do_malformed() const override {
    return lengths_.malformed() + without_point_;
  }

  [[nodiscard]] Result<void> begin(const hal::LengthReading& reading);
  [[nodiscard]] Result<std::optional<hal::PointReading>> locate();
  [[nodiscard]] std::unexpected<Error> refuse(std::string_view words);

  const measurement::ReceiverArray anchors_;
  const LengthOffsets offsets_m_;
  hal::LengthInstrument& lengths_;
  std::optional<measurement::Trilateration> trilateration_;  // of the reading that is looked at
  hal::LengthReading reading_;
  std::uint32_t without_point_ = 0;
  std::string_view words_;  // of the last reading that tells no point
};

}  // namespace armsig::controller
