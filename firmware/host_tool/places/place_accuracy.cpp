// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/base/low_discrepancy.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

using calibration::kDeviations;

namespace {

constexpr Eigen::Index kBaseUnknowns = 6;
// Of the frame itself, 1 sigma: it is given, and a covariance must have an inverse.
constexpr double kFrame = 1e-7;

// The tool's derivatives over the configurations judged, and where it is there.
struct Sampled {
  Eigen::MatrixXd J;  // 3 rows a configuration
  Eigen::VectorXd p;
};

Sampled sampled(const PlaceFit& fit, std::span<const JointVector> judged) {
  const auto rows = 3 * static_cast<Eigen::Index>(judged.size());
  Sampled all{Eigen::MatrixXd::Zero(rows, fit.columns().size), Eigen::VectorXd(rows)};
  Eigen::Index row = 0;
  for (const JointVector& q : judged) {
    const auto tool = fit.rows().tool(q);
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (const auto& [c, value] : tool[static_cast<std::size_t>(i)].J) {
        all.J(row + i, c) = value;
      }
    }
    all.p.segment<3>(row) = fit.state().tool_at(q);
    row += 3;
  }
  return all;
}

// How a turn and a shift move these points, a row a coordinate.
Eigen::MatrixXd rigid_motions(const Eigen::VectorXd& p) {
  Eigen::MatrixXd G(p.size(), kBaseUnknowns);
  for (Eigen::Index k = 0; k < p.size(); k += 3) {
    const Vector3 at = p.segment<3>(k);
    for (Eigen::Index c = 0; c < 3; ++c) {
      G.block<3, 1>(k, c) = Vector3::Unit(c).cross(at);
      G.block<3, 1>(k, 3 + c) = Vector3::Unit(c);
    }
  }
  return G;
}

// The places of the unknowns of tool and deviations among those of the engine's block.
Eigen::MatrixXd to_engine(const PlaceFit& fit, const Eigen::MatrixXd& motion) {
  const Eigen::Index own =
      3 + static_cast<Eigen::Index>(kDeviations * fit.state().arm.joint_count());
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(kBaseUnknowns + own, fit.columns().size);
  T.topRows(kBaseUnknowns) = -motion;
  T.block(kBaseUnknowns, 0, own, own).setIdentity();
  return T;
}

// Unknowns less what the trace of their covariance over their prior leaves.
double share_known(const PlaceFit& fit, Eigen::Index first, Eigen::Index last) {
  double sum = 0;
  for (Eigen::Index c = first; c < last; ++c) {
    sum += 1 - fit.covariance()(c, c) / fit.prior_variance(c);
  }
  return sum;
}

double maps_known(const PlaceFit& fit) {
  const std::array<double, calibration::kSplines> Q = calibration::map_prior();
  double sum = 0;
  for (const auto& [joint, first] : fit.columns().maps) {
    double trace = 0;
    for (std::size_t k = 0; k < calibration::kKnots; ++k) {
      for (std::size_t d = 0; d < calibration::kSplines; ++d) {
        trace += (d == 0 ? 1 : 2) * Q[d] *
                 fit.covariance()(first + static_cast<Eigen::Index>(k),
                                  first + static_cast<Eigen::Index>((k + d) % calibration::kKnots));
      }
    }
    sum += static_cast<double>(calibration::kKnots) - trace / fit.scales().prior.map[joint];
  }
  return sum;
}

// What the readings alone say of tool and deviations, in units of their priors of ordinary size,
// places and gains taken out; gravity and maps as found.
Eigen::MatrixXd said_by_readings(const PlaceFit& fit) {
  const PlaceColumns& columns = fit.columns();
  const Eigen::Index own = columns.gravity;
  const Eigen::Index places = columns.size - columns.places;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(columns.size, columns.size);
  for (const PlaceScalar& scalar : fit.touches()) {
    PlaceFit::add_squares(scalar, fit.weights()[scalar.touch] / fit.variance_of(scalar), H);
  }
  for (const PlaceScalar& scalar : fit.lengths()) PlaceFit::add_squares(scalar, 1, H);
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  Eigen::MatrixXd of_places = H.bottomRightCorner(places, places);
  for (Eigen::Index c = 0; c < places; ++c) {
    of_places(c, c) += 1 / fit.prior_variance(columns.places + c);
  }
  const Eigen::MatrixXd between = H.bottomLeftCorner(places, own);
  Eigen::MatrixXd S =
      H.topLeftCorner(own, own) - between.transpose() * of_places.llt().solve(between);
  for (Eigen::Index c = 0; c < own; ++c) {
    const double unit = std::sqrt(PlaceFit::usual_variance(c));
    S.row(c) *= unit;
    S.col(c) *= unit;
  }
  return S;
}

}  // namespace

std::vector<JointVector> judged_configurations(const JointTypes& types,
                                               const FixedVector<JointLimits, kMaxJoints>& limits) {
  std::vector<JointVector> judged;
  for (int k = 1; k <= kJudgedConfigurations; ++k) {
    judged.push_back(work_configuration(types, limits, k));
  }
  return judged;
}

Eigen::MatrixXd judged_tool(const PlaceFit& fit, std::span<const JointVector> judged) {
  const Sampled at = sampled(fit, judged);
  const Eigen::MatrixXd G = rigid_motions(at.p);
  return at.J - G * (G.transpose() * G).ldlt().solve(G.transpose() * at.J);
}

ToolKnowledge tool_knowledge(const PlaceFit& fit, std::span<const JointVector> judged) {
  const Sampled at = sampled(fit, judged);
  const auto count = static_cast<double>(judged.size());
  const Eigen::MatrixXd G = rigid_motions(at.p);
  ToolKnowledge knowledge;
  knowledge.motion = (G.transpose() * G).ldlt().solve(G.transpose() * at.J);
  const Eigen::MatrixXd left = at.J - G * knowledge.motion;
  const Eigen::MatrixXd left_C = left * fit.covariance();
  knowledge.rms_m = std::sqrt(left.cwiseProduct(left_C).sum() / count);
  // The factor that explains most of an error: along the points, their rigid motions taken off.
  const Eigen::VectorXd along = at.p - G * (G.transpose() * G).ldlt().solve(G.transpose() * at.p);
  const Eigen::VectorXd by = left.transpose() * along / along.squaredNorm();
  knowledge.scale_sigma = std::sqrt(by.dot(fit.covariance() * by));
  knowledge.by_scale_m = knowledge.scale_sigma * along.norm() / std::sqrt(count);
  return knowledge;
}

PlaceCovariance::PlaceCovariance(const PlaceFit& fit, const ToolKnowledge& knowledge) {
  const Eigen::MatrixXd T = to_engine(fit, knowledge.motion);
  covariance_ = T * fit.covariance() * T.transpose();
  for (Eigen::Index c = 0; c < kBaseUnknowns; ++c) covariance_(c, c) += kFrame * kFrame;
}

void PlaceCovariance::times(std::array<double, calibration::kMaxGeometry>& b) const {
  Eigen::Map<Eigen::VectorXd> own(b.data(), covariance_.rows());
  own = (covariance_ * own).eval();
  std::fill(b.begin() + covariance_.rows(), b.end(), 0.0);
}

Determined determined(const PlaceFit& fit) {
  const PlaceColumns& columns = fit.columns();
  Determined count;
  count.of_geometry = static_cast<std::size_t>(columns.gravity);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> said(said_by_readings(fit));
  count.geometry = static_cast<std::size_t>((said.eigenvalues().array() > 1).count());
  count.of_gravity = static_cast<std::size_t>(columns.geometry - columns.gravity);
  count.gravity = share_known(fit, columns.gravity, columns.geometry);
  count.maps = maps_known(fit);
  return count;
}

}  // namespace armsig::tool
