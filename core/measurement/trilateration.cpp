// SPDX-License-Identifier: MIT
#include "core/measurement/trilateration.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numerics/quantiles.hpp"

namespace armsig::measurement {

namespace {

// Good ranges are called contradictory once in 10,000 measurements. Three ranges leave no freedom,
// but their spheres may fail to meet: by as much as one degree is put down to noise.
constexpr auto& kConsistent = numerics::kChiSquare9999;
static_assert(kConsistent.size() == kMaxReceivers - 3);
// Difference of chi-square that decides between two hypotheses.
constexpr double kEvidence = 9;
constexpr std::size_t kMostBad = 3;

std::size_t most_bad(std::size_t heard) {
  if (heard < 5) return 0;
  return heard == 5 ? 1 : std::min(kMostBad, heard - 5);
}

bool faces(const ReceiverArray& array, const Vector3& centroid_S, const Vector3& p_S) {
  return array.facing_S.isZero(0) || (p_S - centroid_S).dot(array.facing_S) > 0;
}

}  // namespace

Result<Position> trilaterate(const ReceiverArray& array, const Ranges& ranges) {
  Trilateration trilateration(array, ranges);
  while (trilateration.step()) {
  }
  return trilateration.result();
}

Trilateration::Trilateration(const ReceiverArray& array, const Ranges& ranges) : array_(array) {
  ARMSIG_CHECK(ranges.size() == array.p_S.size());
  if (const auto heard = take_heard(ranges); !heard) error_ = heard.error();
}

Result<void> Trilateration::take_heard(const Ranges& ranges) {
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    if (!ranges[j].valid) continue;
    if (!std::isfinite(ranges[j].metres)) return std::unexpected(Error::kNotFinite);
    ARMSIG_CHECK(ranges[j].sigma_factor > 0);
    spheres_.push_back({.centre_S = array_.p_S[j],
                        .radius_m = ranges[j].metres,
                        .sigma_m = array_.range_sigma_m * ranges[j].sigma_factor});
    receiver_.push_back(static_cast<std::uint8_t>(j));
  }
  if (spheres_.size() < 3) return std::unexpected(Error::kTooFewReceivers);
  Points centres;
  for (const Sphere& sphere : spheres_) centres.push_back(sphere.centre_S);
  if (spread_of(centres).on_a_line()) return std::unexpected(Error::kReceiversCollinear);
  centroid_S_ = spread_of(array_.p_S).centroid;
  return {};
}

bool Trilateration::step() {
  if (error_ || over_) return false;
  try_without(bad_);
  // Fewest bad ranges first: a hypothesis of more is not looked at where one of fewer holds.
  const Subset next = bad_ == 0 ? Subset{0} : next_of_as_many(bad_);
  if (bad_ != 0 && next < 1U << spheres_.size()) {
    bad_ = next;
    return true;
  }
  ++bad_count_;
  over_ = !std::isinf(best_.score) || bad_count_ > most_bad(spheres_.size());
  bad_ = (1U << bad_count_) - 1;
  return !over_;
}

// Enters what the ranges other than `bad` say about the target, if they agree with each other.
void Trilateration::try_without(Subset bad) {
  Spheres good;
  for (std::size_t j = 0; j < spheres_.size(); ++j)
    if (!contains(bad, j)) good.push_back(spheres_[j]);
  const std::size_t freedom = std::max<std::size_t>(good.size() - 3, 1);

  for (const PointFit& fit : fit_point(good)) {
    if (!(fit.chi_square <= kConsistent[freedom - 1])) continue;
    // Where the ranges don't fix the point, they don't fix its side either.
    if (fit.determined && !faces(array_, centroid_S_, fit.p_S)) continue;
    double score = fit.chi_square;
    for (std::size_t j = 0; j < spheres_.size(); ++j) {
      const bool too_short = spheres_[j].radius_m < (fit.p_S - spheres_[j].centre_S).norm();
      if (contains(bad, j) && too_short) score += kEvidence;
    }
    enter({.fit = fit, .bad = bad, .score = score});
  }
}

void Trilateration::enter(const Hypothesis& hypothesis) {
  if (hypothesis.score < best_.score) {
    second_ = best_;
    best_ = hypothesis;
  } else if (hypothesis.score < second_.score) {
    second_ = hypothesis;
  }
}

Result<Position> Trilateration::result() const {
  if (error_) return std::unexpected(*error_);
  if (std::isinf(best_.score)) return std::unexpected(Error::kRangesInconsistent);
  const auto& [fit, bad, score] = best_;
  if (!fit.determined) return std::unexpected(Error::kSingular);
  if (second_.score - score < kEvidence)
    return std::unexpected(second_.bad == bad ? Error::kMirrorAmbiguity
                                              : Error::kRangesInconsistent);
  Position position;
  position.p_S = fit.p_S;
  position.covariance_m2 = fit.covariance_m2;
  position.chi_square = fit.chi_square;
  for (std::size_t j = 0; j < spheres_.size(); ++j)
    if (contains(bad, j)) position.excluded.push_back(receiver_[j]);
  position.degrees_of_freedom = spheres_.size() - position.excluded.size() - 3;
  return position;
}

}  // namespace armsig::measurement
