// SPDX-License-Identifier: MIT
// Where tool and places are by the nominal arm, from nothing (docs/model.md, section 13).
#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Dense>

#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/places/place_task.hpp"

namespace armsig::tool {
namespace {

constexpr int kPasses = 20;
constexpr double kSoft = 4;          // of the robust weights, in sigma
constexpr double kToolNear_m = 0.3;  // of its nominal place, 1 sigma
constexpr double kLeastScale_m = 1e-6;
constexpr int kTriples = 200;
constexpr double kMedianLength1 = 0.6745;  // of a normal number, in sigma
constexpr double kMedianLength3 = 1.538;   // of the length of three

double soft_weight(double length_m, double scale_m) {
  const double share = length_m / (kSoft * scale_m);
  return 1 / ((1 + share * share) * (1 + share * share));
}

// A touch with its flange by the nominal arm.
struct FlangeAt {
  const TouchRow* touch;
  Pose X_BF;
  double weight = 1;
};

std::vector<FlangeAt> flanges(const PlaceTask& task, const PlaceState& state, InstrumentKind kind) {
  std::vector<FlangeAt> found;
  for (const TouchRow& touch : task.touches) {
    if (task.places[touch.place].kind != kind) continue;
    calibration::ChainFrames frames;
    evaluate_chain(state.arm, touch.q, state.tool.link, frames);
    found.push_back({&touch, frames.X_SL});
  }
  return found;
}

// Centres as weighted means of where the tool was.
void put_sockets(const std::vector<FlangeAt>& touches, PlaceState& state) {
  std::vector<double> weights(state.places.size(), 0);
  std::vector<Vector3> sums(state.places.size(), Vector3::Zero());
  for (const FlangeAt& at : touches) {
    weights[at.touch->place] += at.weight;
    sums[at.touch->place] += at.weight * (at.X_BF * state.tool.p_L);
  }
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (weights[s] > 0) state.places[s].point_B = sums[s] / weights[s];
  }
}

// The tool with which the touches of every socket meet best, R t + o - c_s = 0.
Vector3 best_tool(const std::vector<FlangeAt>& touches, const PlaceState& state, double pull) {
  const std::size_t count = state.places.size();
  std::vector<double> weights(count, 0);
  std::vector<Matrix3> turned(count, Matrix3::Zero());
  std::vector<Vector3> origins(count, Vector3::Zero());
  for (const FlangeAt& at : touches) {
    weights[at.touch->place] += at.weight;
    turned[at.touch->place] += at.weight * at.X_BF.R;
    origins[at.touch->place] += at.weight * at.X_BF.p;
  }
  Matrix3 A = pull * Matrix3::Identity();
  Vector3 b = pull * state.tool.start_L;
  for (const FlangeAt& at : touches) {
    const std::size_t s = at.touch->place;
    if (!(weights[s] > 0)) continue;
    const Matrix3 R = at.X_BF.R - turned[s] / weights[s];
    const Vector3 o = at.X_BF.p - origins[s] / weights[s];
    A += at.weight * R.transpose() * R;
    b -= at.weight * R.transpose() * o;
  }
  return A.ldlt().solve(b);
}

void find_sockets(const PlaceTask& task, PlaceState& state) {
  std::vector<FlangeAt> touches = flanges(task, state, InstrumentKind::kSocket);
  if (touches.empty()) return;
  double scale_m = kToolNear_m;
  for (int pass = 0; pass < kPasses; ++pass) {
    state.tool.p_L = best_tool(touches, state, std::pow(scale_m / kToolNear_m, 2));
    put_sockets(touches, state);
    std::vector<double> lengths;
    for (const FlangeAt& at : touches) {
      lengths.push_back((at.X_BF * state.tool.p_L - state.places[at.touch->place].point_B).norm());
    }
    scale_m = std::max(median_of(lengths) / kMedianLength3, kLeastScale_m);
    for (std::size_t k = 0; k < touches.size(); ++k) {
      touches[k].weight = soft_weight(lengths[k], scale_m);
    }
  }
}

// The places of one kind other than sockets, each with the points that the tool was at.
struct SeenPlace {
  std::size_t place = 0;
  std::vector<Vector3> points_B;
  std::vector<double> lengths_m;
};

std::vector<SeenPlace> seen_places(const PlaceTask& task, const PlaceState& state,
                                   InstrumentKind kind) {
  std::vector<SeenPlace> all;
  for (const FlangeAt& at : flanges(task, state, kind)) {
    auto found = std::ranges::find(all, at.touch->place, &SeenPlace::place);
    if (found == all.end()) found = all.insert(all.end(), {at.touch->place, {}, {}});
    found->points_B.push_back(at.X_BF * state.tool.p_L);
    found->lengths_m.push_back(at.touch->length_m);
  }
  return all;
}

// The plane from which the median distance of the points is least, among those of random triples.
void find_plane(const SeenPlace& at, TouchedPlace& plane) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> any(0, at.points_B.size() - 1);
  double least = std::numeric_limits<double>::infinity();
  plane.point_B = Vector3::UnitZ();
  plane.distance_m = at.points_B.front().z();
  for (int k = 0; k < kTriples; ++k) {
    const Vector3& a = at.points_B[any(random)];
    const Vector3 normal = (at.points_B[any(random)] - a).cross(at.points_B[any(random)] - a);
    if (!(normal.norm() > 1e-9)) continue;
    const Vector3 u = normal.normalized();
    std::vector<double> distances;
    for (const Vector3& p : at.points_B) distances.push_back(std::abs(u.dot(p - a)));
    const double median = median_of(distances);
    if (!(median < least)) continue;
    least = median;
    plane.point_B = u;
    plane.distance_m = u.dot(a);
  }
}

// |p|^2 - l^2 = 2 a p + 2 o l + const, l with the nominal zero, o what it is off by: linear.
void find_anchor(const SeenPlace& at, double zero_m, TouchedPlace& wire) {
  const auto count = static_cast<Eigen::Index>(at.points_B.size());
  Eigen::MatrixXd A(count, 5);
  Eigen::VectorXd b(count);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : at.points_B) middle += p / static_cast<double>(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector3 p = at.points_B[static_cast<std::size_t>(k)] - middle;
    const double length_m = at.lengths_m[static_cast<std::size_t>(k)] + zero_m;
    A.row(k) << 2 * p.transpose(), 2 * length_m, 1;
    b[k] = p.squaredNorm() - length_m * length_m;
  }
  // A zero that a bar of one length does not tell stays where it was stated.
  Eigen::VectorXd held = Eigen::VectorXd::Constant(5, 1e-9);
  held[3] = 1e-2;
  Eigen::VectorXd x;
  for (int pass = 0; pass < kPasses; ++pass) {
    Eigen::MatrixXd normal = A.transpose() * weights.asDiagonal() * A;
    normal += held.asDiagonal();
    x = normal.ldlt().solve(A.transpose() * weights.asDiagonal() * b);
    const Eigen::VectorXd r = A * x - b;
    std::vector<double> sizes;
    for (Eigen::Index k = 0; k < count; ++k) sizes.push_back(std::abs(r[k]));
    const double scale = std::max(median_of(sizes) / kMedianLength1, kLeastScale_m);
    for (Eigen::Index k = 0; k < count; ++k) weights[k] = soft_weight(std::abs(r[k]), scale);
  }
  wire.point_B = middle + Vector3(x.head<3>());
}

}  // namespace

void find_places(const PlaceTask& task, PlaceState& state) {
  find_sockets(task, state);
  for (const SeenPlace& at : seen_places(task, state, InstrumentKind::kPlane)) {
    find_plane(at, state.places[at.place]);
  }
  for (const SeenPlace& at : seen_places(task, state, InstrumentKind::kWire)) {
    TouchedPlace& wire = state.places[at.place];
    find_anchor(at, state.scales[wire.instrument].zero_m, wire);
  }
}

}  // namespace armsig::tool
