// SPDX-License-Identifier: MIT
// Recursive least squares, the encoder-referenced circle and the refinement, beside dlib and Ceres.
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#ifdef ARMSIG_HAS_DLIB
#include <dlib/svm/rls.h>
#endif
#ifdef ARMSIG_HAS_CERES
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#endif

#include "core/features/encoder_circle.hpp"
#include "core/features/rls.hpp"
#include "core/refinement/refinement.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::benchmarks {
namespace {

constexpr std::size_t kMeasurements = 256;  // a power of two

struct RlsWork {
  std::vector<Vector3> regressors;
  std::vector<double> measured;
};

const RlsWork& rls_work() {
  static const RlsWork kWork = [] {
    test::Random random(11);
    RlsWork work;
    for (std::size_t k = 0; k < kMeasurements; ++k) {
      const double t = random.uniform(-1, 1);
      work.regressors.emplace_back(1, std::cos(t), std::sin(t));
      work.measured.push_back(0.3 + 0.5 * std::cos(t) - 0.2 * std::sin(t) + random.normal(1e-3));
    }
    return work;
  }();
  return kWork;
}

const Row kRls("RLS update, three regressors", "armsig", [] {
  return [&w = rls_work(), rls = features::SquareRootRls<3, 1>()](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      const std::size_t i = k % kMeasurements;
      rls.update(w.regressors[i], Eigen::Matrix<double, 1, 1>(w.measured[i]));
      keep(rls);
    }
  };
});

#ifdef ARMSIG_HAS_DLIB
const Row kRlsDlib("RLS update, three regressors", "dlib", [] {
  using Column = dlib::matrix<double, 3, 1>;
  std::vector<Column> regressors;
  for (const Vector3& x : rls_work().regressors) {
    Column column;
    column = x[0], x[1], x[2];
    regressors.push_back(column);
  }
  return [&w = rls_work(), regressors, rls = dlib::rls(1.0, 1e6)](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      const std::size_t i = k % kMeasurements;
      rls.train(regressors[i], w.measured[i]);
      keep(rls);
    }
  };
});
#endif

// Points on a circle of half a metre, seen over 90 degrees with 0.1 mm of noise.
struct CircleWork {
  std::vector<double> reading;
  std::vector<Vector3> p_S;
};

CircleWork circle_work(std::size_t points) {
  test::Random random(12);
  const Matrix3 R = random.rotation();
  CircleWork work;
  for (std::size_t k = 0; k < points; ++k) {
    const double t = kPi / 2 * static_cast<double>(k) / static_cast<double>(points - 1);
    const Vector3 p_C(0.5 * std::cos(t), 0.5 * std::sin(t), 0);
    work.reading.push_back(t);
    work.p_S.emplace_back(Vector3(0.2, -0.4, 2) + R * p_C + random.normal_vector(1e-4));
  }
  return work;
}

features::CircleFit circle_of(const CircleWork& work) {
  features::SweepStatistics statistics(JointType::kRevolute, {work.reading[0], work.p_S[0]});
  for (std::size_t k = 0; k < work.p_S.size(); ++k) statistics.add({work.reading[k], work.p_S[k]});
  return *features::encoder_circle(statistics);
}

#ifdef ARMSIG_HAS_CERES
// The circle of seven unknowns: centre, rotation vector of the frame about the start's, radius.
struct CircleResidual {
  Matrix3 R_start;
  double reading;
  Vector3 p_S;

  template <typename T>
  bool operator()(const T* circle, T* residual) const {
    const T p_C[3] = {circle[6] * std::cos(reading), circle[6] * std::sin(reading), T(0)};
    T p_turned[3];
    ceres::AngleAxisRotatePoint(circle + 3, p_C, p_turned);
    for (int r = 0; r < 3; ++r) {
      T predicted = circle[r];
      for (int c = 0; c < 3; ++c) predicted += R_start(r, c) * p_turned[c];
      residual[r] = predicted - p_S[r];
    }
    return true;
  }
};

// From a start one degree and a centimetre away.
Eigen::Matrix<double, 7, 1> circle_by_ceres(const CircleWork& work,
                                            const features::CircleFit& near) {
  Eigen::Matrix<double, 7, 1> circle;
  circle << near.centre_S + Vector3(0.01, 0, 0), Vector3(radians(1), 0, 0), near.radius_m + 0.01;
  ceres::Problem problem;
  for (std::size_t k = 0; k < work.p_S.size(); ++k) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CircleResidual, 3, 7>(
                                 new CircleResidual{near.R_SC, work.reading[k], work.p_S[k]}),
                             nullptr, circle.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
  return circle;
}
#endif

// A fit from the points on, so that the cost of taking them is in it.
struct CircleRows {
  CircleRows() {
    for (const std::size_t points : {std::size_t{36}, std::size_t{360}}) {
      const std::string path = "encoder-referenced circle, " + std::to_string(points) + " points";
      const Row own(path, "armsig", [points] {
        return [work = circle_work(points)](std::size_t calls) {
          for (std::size_t k = 0; k < calls; ++k) keep(circle_of(work));
        };
      });
#ifdef ARMSIG_HAS_CERES
      const Row peer(path, "Ceres", [points] {
        return [work = circle_work(points)](std::size_t calls) {
          const features::CircleFit own_fit = circle_of(work);
          for (std::size_t k = 0; k < calls; ++k) {
            const Eigen::Matrix<double, 7, 1> circle = circle_by_ceres(work, own_fit);
            if ((circle.head<3>() - own_fit.centre_S).norm() > 1e-6) std::abort();
            keep(circle);
          }
        };
      });
#endif
    }
  }
};
const CircleRows kCircleRows;

// 27 unknowns, six sweeps of 36 points: the work of one `identify --method refined`.
struct RefinementWork {
  Signature start;
  test::Log log;
};

const Row kRefinement("refinement, 27 parameters, 6 x 36 points", "armsig", [] {
  auto work = std::make_shared<RefinementWork>();
  test::Random random(13);
  const test::Cell cell = test::puma_cell(random);
  const JointVector held = test::puma_configuration();
  work->start = test::disturbed(test::signature_of(cell, held), 2e-3, 2e-3, random);
  test::add_sweeps(cell, held, kPi, 36, 2e-4, random, work->log);
  return [work, outcomes = std::vector<refinement::RowOutcome>(work->log.size()),
          refined = std::make_shared<refinement::Refined>()](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      if (!refinement::refine(work->start, work->log, {}, outcomes, *refined)) std::abort();
      keep(*refined);
    }
  };
});

}  // namespace
}  // namespace armsig::benchmarks
