// SPDX-License-Identifier: MIT
#include "core/measurement/trilateration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/measurement/range_fit.hpp"

namespace armsig::measurement {

namespace {

// 99.99 % quantiles of chi-square with 1, 2, ... degrees of freedom: good ranges are called
// contradictory once in 10,000 measurements. Three ranges leave none, but their spheres may fail to
// meet: by as much as the first entry is put down to noise.
constexpr std::array<double, kMaxReceivers - 3> kConsistent = {
    15.137, 18.421, 21.108, 23.513, 25.745, 27.856, 29.878,
    31.828, 33.720, 35.564, 37.367, 39.134, 40.871};
// Difference of chi-square that decides between two hypotheses.
constexpr double kEvidence = 9;
constexpr std::size_t kMostBad = 3;

// A set of receivers, as bits.
using ReceiverSet = std::uint32_t;

struct Hypothesis {
  PointFit fit;
  ReceiverSet bad = 0;
  double score = std::numeric_limits<double>::infinity();
};

// The two best hypotheses so far.
struct Contest {
  Hypothesis best;
  Hypothesis second;

  void enter(const Hypothesis& hypothesis) {
    if (hypothesis.score < best.score) {
      second = best;
      best = hypothesis;
    } else if (hypothesis.score < second.score) {
      second = hypothesis;
    }
  }
};

struct HeardRanges {
  Spheres spheres;
  FixedVector<std::size_t, kMaxReceivers> receiver;  // that each sphere is about
};

Result<HeardRanges> heard_ranges(const ReceiverArray& array, const Ranges& ranges) {
  HeardRanges heard;
  for (std::size_t j = 0; j < ranges.size(); ++j) {
    if (!ranges[j].valid) continue;
    if (!std::isfinite(ranges[j].metres)) return std::unexpected(Error::kNotFinite);
    ARMSIG_CHECK(ranges[j].sigma_factor > 0);
    heard.spheres.push_back({.centre_S = array.p_S[j],
                             .radius_m = ranges[j].metres,
                             .sigma_m = array.range_sigma_m * ranges[j].sigma_factor});
    heard.receiver.push_back(j);
  }
  return heard;
}

std::size_t most_bad(std::size_t heard) {
  if (heard < 5) return 0;
  return heard == 5 ? 1 : std::min(kMostBad, heard - 5);
}

bool faces(const ReceiverArray& array, const Vector3& centroid_S, const Vector3& p_S) {
  return array.facing_S.isZero(0) || (p_S - centroid_S).dot(array.facing_S) > 0;
}

// Enters what the ranges other than `bad` say about the target, if they agree with each other.
void try_without(ReceiverSet bad, const Spheres& spheres, const ReceiverArray& array,
                 const Vector3& centroid_S, Contest& contest) {
  Spheres good;
  for (std::size_t j = 0; j < spheres.size(); ++j)
    if ((bad >> j & 1U) == 0) good.push_back(spheres[j]);
  const std::size_t freedom = std::max<std::size_t>(good.size() - 3, 1);

  for (const PointFit& fit : fit_point(good)) {
    if (!(fit.chi_square <= kConsistent[freedom - 1])) continue;
    // Where the ranges don't fix the point, they don't fix its side either.
    if (fit.determined && !faces(array, centroid_S, fit.p_S)) continue;
    double score = fit.chi_square;
    for (std::size_t j = 0; j < spheres.size(); ++j) {
      const bool too_short = spheres[j].radius_m < (fit.p_S - spheres[j].centre_S).norm();
      if ((bad >> j & 1U) != 0 && too_short) score += kEvidence;
    }
    contest.enter({.fit = fit, .bad = bad, .score = score});
  }
}

// The next larger number with as many bits set: enumerates the subsets of a size.
ReceiverSet next_subset(ReceiverSet set) {
  const ReceiverSet lowest = set & (~set + 1);
  const ReceiverSet ripple = set + lowest;
  return ripple | (((set ^ ripple) >> 2) / lowest);
}

Result<Position> verdict(const Contest& contest, const HeardRanges& heard) {
  const auto& [fit, bad, score] = contest.best;
  if (!fit.determined) return std::unexpected(Error::kSingular);
  if (contest.second.score - score < kEvidence)
    return std::unexpected(contest.second.bad == bad ? Error::kMirrorAmbiguity
                                                     : Error::kRangesInconsistent);
  Position position;
  position.p_S = fit.p_S;
  position.covariance_m2 = fit.covariance_m2;
  position.chi_square = fit.chi_square;
  for (std::size_t j = 0; j < heard.spheres.size(); ++j)
    if ((bad >> j & 1U) != 0) position.excluded.push_back(heard.receiver[j]);
  position.degrees_of_freedom = heard.spheres.size() - position.excluded.size() - 3;
  return position;
}

}  // namespace

Result<Position> trilaterate(const ReceiverArray& array, const Ranges& ranges) {
  ARMSIG_CHECK(ranges.size() == array.p_S.size());
  ARMSIG_TRY(heard, heard_ranges(array, ranges));
  const std::size_t count = heard.spheres.size();
  if (count < 3) return std::unexpected(Error::kTooFewReceivers);
  Points centres;
  for (const Sphere& sphere : heard.spheres) centres.push_back(sphere.centre_S);
  if (spread_of(centres).on_a_line()) return std::unexpected(Error::kReceiversCollinear);

  const Vector3 centroid_S = spread_of(array.p_S).centroid;
  Contest contest;
  try_without(0, heard.spheres, array, centroid_S, contest);
  for (std::size_t bad = 1; bad <= most_bad(count) && std::isinf(contest.best.score); ++bad)
    for (ReceiverSet set = (1U << bad) - 1; set < 1U << count; set = next_subset(set))
      try_without(set, heard.spheres, array, centroid_S, contest);
  if (std::isinf(contest.best.score)) return std::unexpected(Error::kRangesInconsistent);
  return verdict(contest, heard);
}

}  // namespace armsig::measurement
