// SPDX-License-Identifier: MIT
#include "firmware/virtual_cabinet/hand_leading.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/virtual_cabinet/virtual_cabinet.hpp"

namespace armsig::cabinet {
namespace {

constexpr std::uint64_t kHandStream = 3;  // of the seed
// A hand leads no joint faster.
constexpr double kTurnRate = 1;      // rad/s
constexpr double kSlideSpeed = 0.2;  // m/s
// The ball stays in its socket up to here.
constexpr double kLargestLean = radians(75);
constexpr int kMostPostures = 1000;
constexpr int kMostPasses = 40;
constexpr double kReached_m = 1e-9;
constexpr double kLongestStep = 0.5;  // rad or m
// Of the time that a lead takes, after which the hand holds still: play is taken up.
constexpr hal::Duration kHolds = std::chrono::milliseconds(50);

}  // namespace

HandLeading::HandLeading(const World& world, const canopen::CheckedConfiguration& drives,
                         VirtualSensor& sensor, std::span<std::optional<simulated::Drive>> motors)
    : world_(world),
      drives_(drives),
      sensor_(sensor),
      motors_(motors),
      random_(world.seed, kHandStream) {}

const EmulatedSocket* HandLeading::find(std::string_view place) const {
  const auto& all = world_.sockets.all;
  const EmulatedSocket* const found = std::ranges::find(all, place, &EmulatedSocket::name);
  return found == all.end() ? nullptr : found;
}

HandLeading::Ball HandLeading::ball_at(const simulated::SimulatedArm& arm,
                                       const JointVector& readings) const {
  const JointVector q = world_.bent ? turned(*world_.bent, readings) : readings;
  const Pose X_SF = simulated::link_pose(arm, q, arm.arm.joints.size());
  const Vector3& ball_F = world_.sockets.ball_F;
  return {.p_S = X_SF * ball_F, .stem_S = X_SF.R * ball_F};
}

// Steps of least squares by differences.
std::optional<JointVector> HandLeading::reached(const simulated::SimulatedArm& arm,
                                                const Vector3& seat_S, JointVector q) const {
  constexpr double kDifference = 1e-6;
  constexpr double kDamping = 1e-9;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const Vector3 at = ball_at(arm, q).p_S;
    const Vector3 off = seat_S - at;
    if (off.norm() < kReached_m) return q;
    Matrix3 JJt = kDamping * Matrix3::Identity();
    FixedVector<Vector3, kMaxJoints> J;
    for (std::size_t i = 0; i < q.size(); ++i) {
      JointVector other = q;
      other[i] += kDifference;
      J.push_back((ball_at(arm, other).p_S - at) / kDifference);
      JJt += J[i] * J[i].transpose();
    }
    const Vector3 weights = JJt.ldlt().solve(off);
    double longest = 0;
    for (const Vector3& column : J) longest = std::max(longest, std::abs(column.dot(weights)));
    const double part = longest > kLongestStep ? kLongestStep / longest : 1;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += part * J[i].dot(weights);
  }
  return std::nullopt;
}

bool HandLeading::may_stand(const simulated::SimulatedArm& arm, const JointVector& q) const {
  for (std::size_t i = 0; i < q.size(); ++i) {
    const JointLimits& limits = drives_->axes[i].limits;
    if (q[i] < limits.lower || q[i] > limits.upper) return false;
  }
  const Vector3 stem_S = ball_at(arm, q).stem_S;
  const Vector3 down_S = -(arm.X_S0.R * arm.arm.up_0);
  return stem_S.dot(down_S) >= std::cos(kLargestLean) * stem_S.norm() * down_S.norm();
}

JointVector HandLeading::anywhere() {
  JointVector q;
  for (const canopen::AxisConfiguration& axis : drives_->axes) {
    q.push_back(random_.uniform(axis.limits.lower, axis.limits.upper));
  }
  return q;
}

Result<void> HandLeading::begin(const EmulatedSocket& socket, double slip_m, hal::Instant now) {
  const simulated::SimulatedArm arm = sensor_.arm_at(now);
  const Vector3 seat_S = world_.arm.X_S0 * socket.p_0 +
                         world_.sockets.seat_sigma_m * random_.normal_vector() +
                         slip_m * random_.direction();
  for (int posture = 0; posture < kMostPostures; ++posture) {
    const auto q = reached(arm, seat_S, anywhere());
    if (!q || !may_stand(arm, *q)) continue;
    double longest_s = 0;
    const JointVector from = sensor_.true_readings();
    for (std::size_t i = 0; i < from.size(); ++i) {
      const bool turns = drives_->axes[i].scaling.type == JointType::kRevolute;
      longest_s =
          std::max(longest_s, std::abs((*q)[i] - from[i]) / (turns ? kTurnRate : kSlideSpeed));
    }
    lead_ = {.from = from,
             .to = *q,
             .since = now,
             .time = std::chrono::duration_cast<hal::Duration>(
                 std::chrono::duration<double>(longest_s))};
    return {};
  }
  return std::unexpected(Error::kOutOfReach);
}

void HandLeading::do_advance(hal::Instant until) {
  if (!lead_) return;
  const double share =
      lead_->time > hal::Duration{}
          ? std::min(1.0, hal::seconds(until - lead_->since) / hal::seconds(lead_->time))
          : 1.0;
  const JointVector at = sensor_.true_readings();
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double goal = lead_->from[i] + share * (lead_->to[i] - lead_->from[i]);
    const cia402::Scaling& scaling = drives_.scaling(i);
    motors_[i]->push((goal - at[i]) / (scaling.reading(1) - scaling.reading(0)));
  }
  if (until - lead_->since >= lead_->time + kHolds) lead_.reset();
}

}  // namespace armsig::cabinet
