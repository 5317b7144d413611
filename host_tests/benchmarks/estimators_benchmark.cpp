// SPDX-License-Identifier: MIT
// Recursive least squares and sweeps of armsig.
#include <cmath>
#include <cstdlib>

#include "core/features/rls.hpp"
#include "core/features/sweep_estimator.hpp"
#include "host_tests/benchmarks/estimators_work.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::benchmarks {

const RlsWork& rls_work() {
  static const RlsWork kWork = [] {
    test::Random random(11);
    RlsWork work;
    for (std::size_t k = 0; k < kRlsRows; ++k) {
      const double t = random.uniform(-1, 1);
      work.regressors[k] = {1, std::cos(t), std::sin(t)};
      work.measured[k] = 0.3 + 0.5 * std::cos(t) - 0.2 * std::sin(t) + random.normal(1e-3);
    }
    return work;
  }();
  return kWork;
}

std::vector<features::SweepPoint> sweep_of(std::size_t points) {
  test::Random random(12);
  const Matrix3 R = random.rotation();
  std::vector<features::SweepPoint> sweep;
  for (std::size_t k = 0; k < points; ++k) {
    const double t = kPi / 2 * static_cast<double>(k) / static_cast<double>(points - 1);
    const Vector3 p_C(0.5 * std::cos(t), 0.5 * std::sin(t), 0);
    const Vector3 p_S = Vector3(0.2, -0.4, 2) + R * p_C + random.normal_vector(kSweepSigma_m);
    sweep.push_back({t, p_S, kSweepSigma_m * kSweepSigma_m * Matrix3::Identity()});
  }
  return sweep;
}

namespace {

void take(const features::SweepPoint& point, features::SweepEstimator& estimator) {
  if (!estimator.add(point.reading, point.p_S, point.covariance_m2)) std::abort();
}

}  // namespace

features::JointFeature feature_of(const std::vector<features::SweepPoint>& sweep) {
  features::SweepEstimator estimator({});
  for (const features::SweepPoint& point : sweep) take(point, estimator);
  const auto feature = estimator.estimate();
  if (!feature || feature->quality.rejected != 0) std::abort();
  return *feature;
}

namespace {

const Row kRls(kRlsPath, "armsig", [] {
  return [&w = rls_work(), rls = features::SquareRootRls<3, 1>()](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      const std::size_t i = k % kRlsRows;
      rls.update(w.regressors[i], Eigen::Matrix<double, 1, 1>(w.measured[i]));
      keep(rls.solve());
    }
  };
});

struct SweepRows {
  SweepRows() {
    for (const std::size_t points : kSweepPoints) {
      const Row row(
          sweep_path(points), "armsig",
          [points] {
            return [sweep = sweep_of(points)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) keep(feature_of(sweep));
            };
          },
          1);
    }
  }
};
const SweepRows kSweepRows;

// As ranges give them: where the target is nearer a receiver, its point is better that way.
std::vector<features::SweepPoint> sweep_of_own_covariances(std::size_t points) {
  std::vector<features::SweepPoint> sweep = sweep_of(points);
  for (features::SweepPoint& point : sweep) {
    const Vector3 better(1.5, 1 + 0.4 * std::sin(point.reading), 1 + 0.4 * std::cos(point.reading));
    point.covariance_m2 = kSweepSigma_m * kSweepSigma_m * Matrix3(better.asDiagonal());
  }
  return sweep;
}

struct OwnCovarianceRows {
  OwnCovarianceRows() {
    for (const std::size_t points : kSweepPoints) {
      const Row row(
          "sweep of " + std::to_string(points) + " points with covariances of their own", "armsig",
          [points] {
            return [sweep = sweep_of_own_covariances(points)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) keep(feature_of(sweep));
            };
          },
          1);
    }
  }
};
const OwnCovarianceRows kOwnCovarianceRows;

// The points alone, without an estimate: that the last one of 128 costs no more than the others is
// the difference of two rows.
struct TakenRows {
  TakenRows() {
    for (const std::size_t points : {8, 64, 127, 128, 129}) {
      const Row row(
          "points of a sweep taken: " + std::to_string(points), "armsig",
          [points] {
            return [sweep = sweep_of(points)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) {
                features::SweepEstimator estimator({});
                for (const features::SweepPoint& point : sweep) take(point, estimator);
                keep(estimator);
              }
            };
          },
          1);
    }
  }
};
const TakenRows kTakenRows;

// Cost against the points already taken, gate included.
struct FurtherPointRows {
  FurtherPointRows() {
    for (const std::size_t taken : {std::size_t{360}, std::size_t{36000}, std::size_t{360000}}) {
      const Row row("a further point of a sweep, after " + std::to_string(taken), "armsig",
                    [taken] {
                      const auto sweep = sweep_of(256);
                      features::SweepEstimator estimator({});
                      for (std::size_t k = 0; k < taken; ++k)
                        take(sweep[k * 37 % sweep.size()], estimator);
                      return [sweep, estimator](std::size_t calls) mutable {
                        for (std::size_t k = 0; k < calls; ++k) {
                          take(sweep[k % sweep.size()], estimator);
                          keep(estimator);
                        }
                      };
                    });
    }
  }
};
const FurtherPointRows kFurtherPointRows;

}  // namespace
}  // namespace armsig::benchmarks
