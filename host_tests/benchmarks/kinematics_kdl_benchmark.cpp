// SPDX-License-Identifier: MIT
// The same work by Orocos KDL, on the same chain.
#include <cstdlib>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <memory>
#include <vector>

#include "host_tests/benchmarks/kinematics_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

KDL::JntArray converted(const JointVector& q) {
  KDL::JntArray result(static_cast<unsigned>(q.size()));
  for (std::size_t i = 0; i < q.size(); ++i) result(static_cast<unsigned>(i)) = q[i];
  return result;
}

struct KdlWork {
  KDL::Chain chain;
  std::vector<KDL::JntArray> q;
  std::vector<KDL::JntArray> seed;
  std::vector<KDL::Frame> X_0n;
};

// Poses by KDL itself, checked against armsig's.
const KdlWork& kdl_work() {
  static const KdlWork kWork = [] {
    const KinematicsWork& ours = kinematics_work();
    KdlWork work;
    for (const DhJoint& row : ours.arm.joints) {
      const auto frame = KDL::Frame::DH(row.a_m, row.alpha_rad, row.d_m, row.theta_rad);
      work.chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), frame));
    }
    KDL::ChainFkSolverPos_recursive forward(work.chain);
    for (std::size_t k = 0; k < kPoses; ++k) {
      work.q.push_back(converted(ours.q[k]));
      work.seed.push_back(converted(ours.seed[k]));
      KDL::Frame X;
      forward.JntToCart(work.q[k], X);
      for (int r = 0; r < 3; ++r) {
        if (std::abs(X.p(r) - ours.X_0n[k].p[r]) > 1e-12) std::abort();
      }
      work.X_0n.push_back(X);
    }
    return work;
  }();
  return kWork;
}

const Row kForward("forward", "KDL", [] {
  return [&w = kdl_work()](std::size_t calls) {
    KDL::ChainFkSolverPos_recursive forward(w.chain);
    KDL::Frame X;
    for (std::size_t k = 0; k < calls; ++k) {
      forward.JntToCart(w.q[k % kPoses], X);
      keep(X);
    }
  };
});

const Row kForwardLatency("forward, latency", "KDL", [] {
  return [&w = kdl_work()](std::size_t calls) {
    KDL::ChainFkSolverPos_recursive forward(w.chain);
    KDL::JntArray q = w.q[0];
    KDL::Frame X;
    for (std::size_t k = 0; k < calls; ++k) {
      forward.JntToCart(q, X);
      q(0) = w.q[k % kPoses](0) + 1e-9 * X.p.x();
    }
    keep(q);
  };
});

// The Jacobian alone; KDL computes the pose apart.
const Row kJacobian("forward with Jacobian", "KDL", [] {
  return [&w = kdl_work()](std::size_t calls) {
    KDL::ChainFkSolverPos_recursive forward(w.chain);
    KDL::ChainJntToJacSolver solver(w.chain);
    KDL::Jacobian J(6);
    KDL::Frame X;
    for (std::size_t k = 0; k < calls; ++k) {
      forward.JntToCart(w.q[k % kPoses], X);
      solver.JntToJac(w.q[k % kPoses], J);
      keep(J);
    }
  };
});

const Row kInverseNr("inverse", "KDL NR", [] {
  return [&w = kdl_work()](std::size_t calls) {
    KDL::ChainFkSolverPos_recursive forward(w.chain);
    KDL::ChainIkSolverVel_pinv velocity(w.chain);
    KDL::ChainIkSolverPos_NR inverse(w.chain, forward, velocity, 100, 1e-9);
    KDL::JntArray q(6);
    for (std::size_t k = 0; k < calls; ++k) {
      if (inverse.CartToJnt(w.seed[k % kPoses], w.X_0n[k % kPoses], q) < 0) std::abort();
      keep(q);
    }
  };
});

const Row kInverseLma("inverse", "KDL LMA", [] {
  return [&w = kdl_work()](std::size_t calls) {
    KDL::ChainIkSolverPos_LMA inverse(w.chain, 1e-9);
    KDL::JntArray q(6);
    for (std::size_t k = 0; k < calls; ++k) {
      if (inverse.CartToJnt(w.seed[k % kPoses], w.X_0n[k % kPoses], q) < 0) std::abort();
      keep(q);
    }
  };
});

}  // namespace
}  // namespace armsig::benchmarks
