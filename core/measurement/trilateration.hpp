// SPDX-License-Identifier: MIT
// Position of a target from its ranges to receivers at known places, docs/model.md, section 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/subset.hpp"
#include "core/measurement/range_fit.hpp"
#include "core/measurement/ranges.hpp"
#include "core/measurement/receivers.hpp"

namespace armsig::measurement {

struct Position {
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();  // from the noise of the ranges alone
  double chi_square = 0;                    // of the ranges used
  std::size_t degrees_of_freedom = 0;       // ranges used - 3
  // Receivers heard but not believed: their places in the array, from 0.
  FixedVector<std::size_t, kMaxReceivers> excluded;
};

// Weighted least squares over the valid ranges, under the hypothesis that all are good; if they
// contradict each other (chi-square above its 99.99 % quantile; needs four or more), under the
// hypotheses that one of them is bad, then two, then three. Five ranges can give up one; every
// further one given up must leave two more than the three that a position takes. A hypothesis wins
// if it is consistent and no other with as many bad ranges comes near it: a likelihood ratio of
// exp(4.5) = 90, in which a range that would be too short counts 90 to 1 against, because a detour
// (multipath) only ever lengthens a range.
//
// `array` has passed check() and `ranges` has one entry per receiver.
// Errors: kNotFinite (a valid range); kTooFewReceivers: fewer than three valid;
// kReceiversCollinear: the valid ones stand on one line; kMirrorAmbiguity: a point and its mirror
// image explain the ranges alike and facing_S doesn't decide; kSingular: the target stands where
// the ranges don't fix it, as next to the plane of a flat array; kRangesInconsistent: they don't
// meet in a point, and the culprit isn't certain.
[[nodiscard]] Result<Position> trilaterate(const ReceiverArray& array, const Ranges& ranges);

// trilaterate(), a bounded step at a time: one hypothesis of which ranges are bad. `array` must
// outlive it.
class Trilateration {
 public:
  Trilateration(const ReceiverArray& array, const Ranges& ranges);

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] Result<Position> result() const;

 private:
  struct Hypothesis {
    PointFit fit;
    Subset bad = 0;  // of the receivers that were heard
    double score = std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] Result<void> take_heard(const Ranges& ranges);
  void try_without(Subset bad);
  void enter(const Hypothesis& hypothesis);

  const ReceiverArray& array_;
  std::optional<Error> error_;
  Spheres spheres_;                                    // of the receivers that were heard
  FixedVector<std::uint8_t, kMaxReceivers> receiver_;  // that each sphere is about
  Vector3 centroid_S_ = Vector3::Zero();               // of all receivers
  std::size_t bad_count_ = 0;
  Subset bad_ = 0;  // the hypothesis to be looked at next
  bool over_ = false;
  Hypothesis best_;  // so far
  Hypothesis second_;
};

}  // namespace armsig::measurement
