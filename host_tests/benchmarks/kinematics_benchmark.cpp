// SPDX-License-Identifier: MIT
// Forward kinematics, Jacobian, inverse and cold start of armsig.
#include <cstdlib>
#include <random>
#include <string>

#include "firmware/analysis/postures/cold_start.hpp"
#include "host_tests/benchmarks/kinematics_work.hpp"
#include "host_tests/benchmarks/rows.hpp"
#include "host_tests/support/kinematics_random.hpp"

namespace armsig::benchmarks {

const KinematicsWork& kinematics_work() {
  static const KinematicsWork kWork = [] {
    std::mt19937_64 random(5);
    KinematicsWork work;
    work.arm = test::perturbed_puma(random);
    work.chain = kinematics::make_chain(work.arm.joints);
    for (std::size_t k = 0; k < kPoses; ++k) {
      JointVector q;
      for (std::size_t i = 0; i < 6; ++i) q.push_back(test::uniform(random, -2, 2));
      q[2] = test::uniform(random, 0.1, 0.9);  // elbow bent
      q[4] = test::uniform(random, 0.3, 1.6);  // wrist bent
      JointVector seed;
      for (const double reading : q) {
        seed.push_back(reading + radians(0.5) * (random() % 2 == 0 ? 1 : -1));
      }
      work.q[k] = q;
      work.seed[k] = seed;
      work.X_0n[k] = *kinematics::forward(work.chain, q);
    }
    return work;
  }();
  return kWork;
}

namespace {

using kinematics::Chain;

const Row kForward("forward", "armsig", [] {
  return [&w = kinematics_work()](std::size_t calls) {
    for (std::size_t k = 0; k < calls; ++k) keep(kinematics::forward(w.chain, w.q[k % kPoses]));
  };
});

// Each call waits for the result of the one before.
const Row kForwardLatency("forward, latency", "armsig", [] {
  return [&w = kinematics_work()](std::size_t calls) {
    JointVector q = w.q[0];
    for (std::size_t k = 0; k < calls; ++k) {
      q[0] = w.q[k % kPoses][0] + 1e-9 * kinematics::forward(w.chain, q)->p.x();
    }
    keep(q);
  };
});

const Row kJacobian("forward with Jacobian", "armsig", [] {
  return [&w = kinematics_work()](std::size_t calls) {
    for (std::size_t k = 0; k < calls; ++k) {
      keep(kinematics::forward_with_jacobian(w.chain, w.q[k % kPoses]));
    }
  };
});

const Row kInverse("inverse", "armsig", [] {
  return [&w = kinematics_work()](std::size_t calls) {
    for (std::size_t k = 0; k < calls; ++k) {
      const auto solution = kinematics::inverse(w.chain, w.X_0n[k % kPoses], w.seed[k % kPoses]);
      if (solution->position_error_m > 1e-9) std::abort();
      keep(solution);
    }
  };
});

const Row kColdStart("cold start, all eight solutions", "armsig", [] {
  return [&w = kinematics_work(),
          form = kinematics::closed_form(kinematics_work().chain)](std::size_t calls) {
    for (std::size_t k = 0; k < calls; ++k) {
      const auto solutions = kinematics::cold_start(w.chain, form, w.X_0n[0]);
      if (solutions->size() != 8) std::abort();
      keep(solutions);
    }
  };
});

// Cost against the number of joints.
struct JointRows {
  JointRows() {
    for (std::size_t joints = 1; joints <= kMaxJoints; ++joints) {
      const Row row("forward, " + std::to_string(joints) + " joints", "armsig", [joints] {
        DhRows links;
        std::array<JointVector, kPoses> q;
        for (std::size_t i = 0; i < joints; ++i) {
          links.push_back({JointType::kRevolute, 0, 0.2, 0.05, radians(i % 2 == 0 ? -90 : 90)});
        }
        std::mt19937_64 random(7);
        for (JointVector& readings : q) {
          for (std::size_t i = 0; i < joints; ++i) {
            readings.push_back(test::uniform(random, -2, 2));
          }
        }
        return [chain = kinematics::make_chain(links), q](std::size_t calls) {
          for (std::size_t k = 0; k < calls; ++k) keep(kinematics::forward(chain, q[k % kPoses]));
        };
      });
    }
  }
};
const JointRows kJointRows;

}  // namespace
}  // namespace armsig::benchmarks
