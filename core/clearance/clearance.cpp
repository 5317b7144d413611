// SPDX-License-Identifier: MIT
#include "core/clearance/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/links.hpp"

namespace armsig::clearance {
namespace {

constexpr int kPlacesAStep = 4;

// Origins of frames 0 ... n.
using Origins = FixedVector<Vector3, kMaxFrames>;

Origins origins_at(const DhRows& rows, const JointVector& q) {
  Origins origins{Vector3::Zero()};
  Pose X_0F;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    X_0F = X_0F * link_transform(rows[i], q[i]);
    origins.push_back(X_0F.p);
  }
  return origins;
}

// How far parts of the arm move at most while the readings go from one to the other: every joint
// turns what is behind it by its change, about an axis that is no farther than the links between
// are long.
class Motion {
 public:
  Motion(const DhRows& rows, const JointVector& from, const JointVector& to) : rows_(rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const DhJoint& row = rows[i];
      const bool turns = row.type == JointType::kRevolute;
      const double d_m =
          turns ? row.d_m : std::max(std::abs(row.d_m + from[i]), std::abs(row.d_m + to[i]));
      change_[i] = std::abs(to[i] - from[i]);
      beyond_m_[i + 1] = beyond_m_[i] + std::hypot(row.a_m, d_m);
    }
  }

  // Of the origin of frame `end`, as seen from link `from` (0: the base).
  [[nodiscard]] double way_m(std::size_t from, std::size_t end) const {
    double way_m = 0;
    for (std::size_t i = from; i < end; ++i) {
      const double lever_m = std::abs(rows_[i].a_m) + beyond_m_[end] - beyond_m_[i + 1];
      way_m += change_[i] * (rows_[i].type == JointType::kRevolute ? lever_m : 1);
    }
    return way_m;
  }

 private:
  const DhRows& rows_;
  std::array<double, kMaxJoints> change_{};
  std::array<double, kMaxFrames> beyond_m_{};  // the length of the links up to each origin
};

struct Segment {
  Vector3 from;
  Vector3 to;
};

// Ericson, Real-Time Collision Detection (2005), 5.1.9: the nearest points of two segments, either
// of which may be a point.
double distance(const Segment& a, const Segment& b) {
  constexpr double kPoint_m2 = 1e-12;
  const Vector3 along_a = a.to - a.from;
  const Vector3 along_b = b.to - b.from;
  const Vector3 apart = a.from - b.from;
  const double aa = along_a.squaredNorm();
  const double bb = along_b.squaredNorm();
  const double on_b = along_b.dot(apart);
  double s = 0;
  double t = 0;
  if (aa > kPoint_m2) {
    const double on_a = along_a.dot(apart);
    const double ab = along_a.dot(along_b);
    const double denominator = aa * bb - ab * ab;
    if (bb > kPoint_m2 && denominator > kPoint_m2 * aa * bb) {
      s = std::clamp((ab * on_b - on_a * bb) / denominator, 0.0, 1.0);
    }
    if (bb > kPoint_m2) t = (ab * s + on_b) / bb;
    if (!(bb > kPoint_m2) || t < 0 || t > 1) {
      t = std::clamp(t, 0.0, 1.0);
      s = std::clamp((ab * t - on_a) / aa, 0.0, 1.0);
    }
  } else if (bb > kPoint_m2) {
    t = std::clamp(on_b / bb, 0.0, 1.0);
  }
  return (apart + s * along_a - t * along_b).norm();
}

// All that must stay clear, at one pose, and how far it moves at most.
class Places {
 public:
  Places(const DhRows& rows, const Surroundings& around, const JointVector& q)
      : rows_(rows), around_(around), origins_(origins_at(rows, q)) {}

  // visit(room, how far what is there moves at most)
  template <typename Visit>
  void each(const Motion& motion, const Visit& visit) const {
    const std::size_t n = rows_.size();
    for (std::size_t end = 1; end <= n; ++end) visit_outer(end, radius(end), motion, visit);
    const bool holds = around_.hand_m > around_.link_radius_m;
    if (holds) visit_outer(n + 1, around_.hand_m, motion, visit);
    if (!(around_.link_radius_m > 0)) return;
    for (std::size_t outer = 3; outer <= (holds ? n + 1 : n); ++outer) {
      double between_m = 0;
      for (std::size_t inner = outer - 2; inner >= 1; --inner) {
        between_m += shortest(inner + 1);
        const double apart_m = radius(inner) + radius(outer);
        // A ball does not know which way a tool points: it is not held against the wrist.
        if (between_m < (outer > n ? 2 * apart_m : apart_m + kLeastRoom_m)) continue;
        visit(Room{distance(link(inner), link(outer)) - apart_m, Limit::kLink, index(outer),
                   index(inner), origins_[std::min(outer, n)]},
              motion.way_m(inner, std::min(outer, n)));
      }
    }
  }

 private:
  static std::uint8_t index(std::size_t link) { return static_cast<std::uint8_t>(link); }
  [[nodiscard]] double radius(std::size_t link) const {
    return link > rows_.size() ? around_.hand_m : around_.link_radius_m;
  }
  [[nodiscard]] double shortest(std::size_t link) const {
    const DhJoint& row = rows_[link - 1];
    return row.type == JointType::kRevolute ? std::hypot(row.a_m, row.d_m) : std::abs(row.a_m);
  }
  [[nodiscard]] Segment link(std::size_t link) const {
    if (link > rows_.size()) return {origins_.back(), origins_.back()};
    const bool stands = link == 1 && rows_[0].type == JointType::kRevolute;
    return {stands ? around_.foot_B : origins_[link - 1], origins_[link]};
  }

  template <typename Visit>
  void visit_outer(std::size_t end, double radius_m, const Motion& motion,
                   const Visit& visit) const {
    const Vector3& p_B = origins_[std::min(end, rows_.size())];
    const double way_m = motion.way_m(0, std::min(end, rows_.size()));
    // The first link is bolted to the mounting plane: it stays as far from it as it is.
    const bool bolted = end == 1 && rows_[0].type == JointType::kRevolute;
    for (const HalfSpace& plane : around_.planes) {
      if (bolted && plane.limit == Limit::kMountingPlane) continue;
      visit(Room{plane.normal_B.dot(p_B) - plane.offset_m - radius_m, plane.limit, index(end), 0,
                 p_B},
            way_m);
    }
    const double inside_m =
        std::min((p_B - around_.lower_B).minCoeff(), (around_.upper_B - p_B).minCoeff());
    visit(Room{inside_m - radius_m, Limit::kBox, index(end), 0, p_B}, way_m);
  }

  const DhRows& rows_;
  const Surroundings& around_;
  Origins origins_;
};

}  // namespace

Room room_at(const DhRows& rows, const Surroundings& around, const JointVector& q,
             const JointVector& within) {
  JointVector from = q;
  JointVector to = q;
  for (std::size_t i = 0; i < within.size(); ++i) {
    from[i] -= within[i];
    to[i] += within[i];
  }
  // `from` and `to` are both off from q by half of that motion.
  Room least;
  Places(rows, around, q).each(Motion(rows, from, to), [&least](Room room, double way_m) {
    room.left_m -= way_m / 2;
    if (room.left_m < least.left_m) least = room;
  });
  return least;
}

WayLook::Says WayLook::step(const DhRows& rows, const Surroundings& around, const JointVector& from,
                            const JointVector& to) {
  if (around.are_empty()) {
    part_ = 1;
    return Says::kClear;
  }
  const Motion motion(rows, from, to);
  const auto least_m = static_cast<double>(least_m_);
  const double spare_m = kLeastRoom_m / 2;
  for (int place = 0; place < kPlacesAStep; ++place) {
    JointVector q = from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += part() * (to[i] - from[i]);
    room_ = {};
    double onward = 1;
    Places(rows, around, q).each(motion, [&](const Room& room, double way_m) {
      if (room.left_m < room_.left_m) room_ = room;
      const double on_m = room.left_m - least_m + spare_m;
      if (way_m > on_m) onward = std::min(onward, on_m / way_m);
    });
    if (room_.left_m < least_m) return Says::kLeaves;
    if (part() + onward >= 1) {
      // From where this way ends the next one begins.
      part_ = 1;
      room_ = room_at(rows, around, to);
      return room_.left_m < least_m ? Says::kLeaves : Says::kClear;
    }
    part_ += static_cast<float>(onward);
  }
  return Says::kMore;
}

WayLook::Says WayLook::whole(const DhRows& rows, const Surroundings& around,
                             const JointVector& from, const JointVector& to) {
  Says says = Says::kMore;
  while (says == Says::kMore) says = step(rows, around, from, to);
  return says;
}

JointLimits free_readings(const DhRows& rows, const JointCouplings& couplings,
                          const Surroundings& around, const JointVector& q, std::size_t joint,
                          const JointLimits& limits) {
  constexpr int kHalvings = 12;
  const auto is_clear = [&](double reading) {
    JointVector to = q;
    to[joint] = reading;
    WayLook look;
    return look.whole(rows, around, effective_readings(couplings, q),
                      effective_readings(couplings, to)) == WayLook::Says::kClear;
  };
  const auto towards = [&](double limit) {
    if (is_clear(limit)) return limit;
    double clear = q[joint];
    double beyond = limit;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (clear + beyond) / 2;
      (is_clear(middle) ? clear : beyond) = middle;
    }
    return clear;
  };
  return {towards(limits.lower), towards(limits.upper)};
}

}  // namespace armsig::clearance
