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

// What a wire's rows miss an anchor by, softly weighted, with the zero as it was stated.
struct AnchorMisses {
  Matrix3 squares = Matrix3::Zero();
  Vector3 pull = Vector3::Zero();
  double median_m = 0;
};

AnchorMisses misses_of(const SeenPlace& at, double zero_m, const Vector3& anchor) {
  std::vector<double> misses_m;
  std::vector<double> sizes_m;
  for (std::size_t k = 0; k < at.points_B.size(); ++k) {
    misses_m.push_back((at.points_B[k] - anchor).norm() - at.lengths_m[k] - zero_m);
    sizes_m.push_back(std::abs(misses_m.back()));
  }
  AnchorMisses all;
  all.median_m = median_of(sizes_m);
  const double scale_m = std::max(all.median_m / kMedianLength1, kLeastScale_m);
  for (std::size_t k = 0; k < at.points_B.size(); ++k) {
    const Vector3 u = (at.points_B[k] - anchor).normalized();
    const double weight = soft_weight(sizes_m[k], scale_m);
    all.squares += weight * u * u.transpose();
    all.pull += weight * misses_m[k] * u;
  }
  return all;
}

// The anchor from which the median miss of the lengths is least, of those that a few steps find
// from all about the points: a wire near one plane of them fits beyond it almost as well.
void find_anchor(const SeenPlace& at, double zero_m, TouchedPlace& wire) {
  const auto count = static_cast<double>(at.points_B.size());
  Vector3 middle = Vector3::Zero();
  double length_m = zero_m;
  for (std::size_t k = 0; k < at.points_B.size(); ++k) {
    middle += at.points_B[k] / count;
    length_m += at.lengths_m[k] / count;
  }
  double least_m = std::numeric_limits<double>::infinity();
  for (int direction = 0; direction < 27; ++direction) {
    const Eigen::Vector3i cell(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
    if (cell.isZero()) continue;
    const Vector3 towards = cell.cast<double>();
    Vector3 anchor = middle + length_m * towards.normalized();
    for (int pass = 0; pass < kPasses; ++pass) {
      const AnchorMisses misses = misses_of(at, zero_m, anchor);
      const Matrix3 held = 1e-3 * count * Matrix3::Identity();
      anchor += (misses.squares + held).ldlt().solve(misses.pull);
    }
    const double median_m = misses_of(at, zero_m, anchor).median_m;
    if (!(median_m < least_m)) continue;
    least_m = median_m;
    wire.point_B = anchor;
  }
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
