// SPDX-License-Identifier: MIT
// Recursive least squares and the encoder-referenced circle of armsig.
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

CircleWork circle_work(std::size_t points) {
  test::Random random(12);
  const Matrix3 R = random.rotation();
  CircleWork work;
  for (std::size_t k = 0; k < points; ++k) {
    const double t = kPi / 2 * static_cast<double>(k) / static_cast<double>(points - 1);
    const Vector3 p_C(0.5 * std::cos(t), 0.5 * std::sin(t), 0);
    features::SweepPoint point;
    point.reading = t;
    point.p_S = Vector3(0.2, -0.4, 2) + R * p_C + random.normal_vector(1e-4);
    work.points.push_back(point);
  }
  return work;
}

features::CircleFit circle_of(const CircleWork& work) {
  features::MotionStatistics statistics(JointType::kRevolute, work.points[0]);
  statistics.add(work.points);
  return *features::encoder_circle(statistics);
}

namespace {

const Matrix3 kCircleCovariance_m2 = 1e-8 * Matrix3::Identity();

const Row kRls(kRlsPath, "armsig", [] {
  return [&w = rls_work(), rls = features::SquareRootRls<3, 1>()](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      const std::size_t i = k % kRlsRows;
      rls.update(w.regressors[i], Eigen::Matrix<double, 1, 1>(w.measured[i]));
      keep(rls);
    }
  };
});

struct CircleRows {
  CircleRows() {
    for (const std::size_t points : kCirclePoints) {
      const Row row(
          circle_path(points), "armsig",
          [points] {
            return [work = circle_work(points)](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) keep(circle_of(work));
            };
          },
          1);
    }
  }
};
const CircleRows kCircleRows;

// Cost against the points already taken, gate included.
struct FurtherPointRows {
  FurtherPointRows() {
    for (const std::size_t taken : {std::size_t{360}, std::size_t{36000}, std::size_t{360000}}) {
      const Row row("a further point of a sweep, after " + std::to_string(taken), "armsig",
                    [taken] {
                      const CircleWork work = circle_work(256);
                      features::SweepEstimator estimator({});
                      const auto take = [&](std::size_t k) {
                        const features::SweepPoint& point = work.points[k % work.points.size()];
                        if (!estimator.add(point.reading, point.p_S, kCircleCovariance_m2)) {
                          std::abort();
                        }
                      };
                      for (std::size_t k = 0; k < taken; ++k) take(k * 37);
                      return [work, estimator](std::size_t calls) mutable {
                        for (std::size_t k = 0; k < calls; ++k) {
                          const features::SweepPoint& point = work.points[k % work.points.size()];
                          keep(estimator.add(point.reading, point.p_S, kCircleCovariance_m2));
                        }
                      };
                    });
    }
  }
};
const FurtherPointRows kFurtherPointRows;

}  // namespace
}  // namespace armsig::benchmarks
