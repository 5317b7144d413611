// SPDX-License-Identifier: MIT
// What has happened to an identified arm since, as rows measured later show it: the sensor or the
// target stands elsewhere, zeros moved, a gear was changed, a link was bent; singly, and with the
// place and the target, which change together with anything. Compared by marginal likelihood
// (MacKay, Information Theory, Inference and Learning Algorithms, 2003, chapter 28); the simplest
// of those that are nearly as good is taken, larger noise last.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/refined.hpp"
#include "firmware/host_tool/diagnosis/place.hpp"

namespace armsig::tool {

// One number that has changed, by so much. Kinds: the place and the target have three or six.
struct SinceThen {
  enum class Of : std::uint8_t { kPlace, kTarget, kZero, kGear, kLink };
  struct Change {
    Of of;
    std::size_t joint = 0;  // of a zero, a gear, a link from that joint on
    double size = 0;   // zero: rad or m; gear: share; target, place and link: m, at what it moves
    double sigma = 0;  // of a zero or a gear
    double turn_rad = 0;  // of a place or a link
  };
  std::vector<Change> changes;  // those that matter
  double before_m = 0;          // RMS of the residuals without it
  double after_m = 0;           // and with it
  double nats = 0;              // ahead of larger noise, as a logarithm of likelihoods

  [[nodiscard]] bool has(Of of) const;
};

// The likeliest history of the rows that were not rejected. `place`: where they fit best, or none.
// Nothing for fewer than six positions, or where larger noise explains as much.
[[nodiscard]] std::optional<SinceThen> since_then(const calibration::Refined& estimate,
                                                  std::span<const calibration::Observation> rows,
                                                  std::span<const calibration::RowOutcome> outcomes,
                                                  const std::optional<Place>& place);

// "the zero of joint 2 has moved by -0.300 ± 0.002°", one a change.
[[nodiscard]] std::vector<std::string> in_words(const SinceThen& found, const Signature& signature);
// What to do about it.
[[nodiscard]] std::string mend_of(const SinceThen& found);

}  // namespace armsig::tool
