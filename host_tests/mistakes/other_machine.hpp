// SPDX-License-Identifier: MIT
// A machine that shares no code with armsig: its motion by frames of its own, with what arms do
// that no drawing says. Metres and radians.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace armsig::mistakes::other {

using Vec = std::array<double, 3>;

inline Vec sum(const Vec& a, const Vec& b, double times = 1) {
  return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]};
}
inline double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Three columns and an origin.
struct Frame {
  std::array<Vec, 3> axes{Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}};
  Vec origin{0, 0, 0};

  [[nodiscard]] Vec turned(const Vec& v) const {
    return sum(sum(sum({0, 0, 0}, axes[0], v[0]), axes[1], v[1]), axes[2], v[2]);
  }
  [[nodiscard]] Vec point(const Vec& v) const { return sum(origin, turned(v)); }
  // About its own axis `k`, by the two other axes.
  void turn(std::size_t k, double angle) {
    Vec& u = axes[(k + 1) % 3];
    Vec& v = axes[(k + 2) % 3];
    const Vec u_before = u;
    u = sum(sum({0, 0, 0}, u, std::cos(angle)), v, std::sin(angle));
    v = sum(sum({0, 0, 0}, v, std::cos(angle)), u_before, -std::sin(angle));
  }
  void shift(std::size_t k, double way) { origin = sum(origin, axes[k], way); }
};

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15ULL + 1) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1p-53;
  }
  double normal(double sigma) {  // Box and Muller
    const double radius = std::sqrt(-2 * std::log(between(0, 1)));
    return sigma * radius * std::cos(between(0, 2 * std::numbers::pi));
  }
  bool chance(double share) { return between(0, 1) < share; }
  double either_sign(double low, double high) {
    const double size = between(low, high);
    return chance(0.5) ? size : -size;
  }
  std::size_t one_of(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(between(0, static_cast<double>(count))));
  }

 private:
  std::mt19937_64 engine_;
};

struct Joint {
  bool turns = true;
  double theta = 0;
  double d = 0;
  double a = 0;
  double alpha = 0;
  double low = 0;
  double high = 0;
  double home = 0;
  // What no drawing says.
  double beta = 0;           // of the next axis, about y
  double gain = 0;           // share of the reading
  double half_backlash = 0;  // of the joint
  std::array<double, 3> wave{0, 0, 0};
  std::array<double, 3> phase{0, 0, 0};
  double softness = 0;  // turn or way by a unit of torque or force
};

// Waves in a turn, or in a metre of a prismatic joint.
inline constexpr std::array<double, 3> kWavesATurn{1, 2, 7};

struct Coupling {
  std::size_t joint;
  std::size_t from;
  double ratio;
};

struct Machine {
  std::string name;
  std::vector<Joint> joints = {};
  std::vector<Coupling> couplings = {};
  Vec down{0, 0, -1};              // in the base frame
  std::vector<double> mass = {};   // at the origin of each frame, of all one
  double lean = 0;                 // of the base, by a unit of moment
  std::vector<Vec> targets = {};   // on the last link
  Frame base = {};                 // in the sensor frame
  std::vector<double> sides = {};  // from which each joint came
  std::vector<double> at = {};     // its readings

  [[nodiscard]] std::size_t size() const { return joints.size(); }

  // The joints go there from where they are.
  void go_to(const std::vector<double>& readings) {
    sides.resize(size(), 1);
    at.resize(size(), 0);
    for (std::size_t j = 0; j < size(); ++j) {
      if (readings[j] > at[j] + 1e-9) sides[j] = 1;
      if (readings[j] < at[j] - 1e-9) sides[j] = -1;
    }
    at = readings;
  }

  // Of the pose to which it went, in the sensor frame.
  [[nodiscard]] Vec target(std::size_t number) const {
    std::vector<double> turned = moved();
    const std::vector<Frame> stiff = frames(turned);
    deflect(stiff, turned);
    Vec p = frames(turned).back().point(targets[number]);
    if (lean > 0) {
      const Vec& foot = stiff[foot_frame()].origin;
      const Vec turn = cross(sum(centre(stiff), foot, -1), down);
      p = sum(p, cross(turn, sum(p, foot, -1)), lean);
    }
    return base.point(p);
  }

 private:
  [[nodiscard]] std::vector<double> moved() const {
    std::vector<double> way(size());
    for (std::size_t j = 0; j < size(); ++j) {
      const Joint& joint = joints[j];
      way[j] = at[j] * (1 + joint.gain) - sides[j] * joint.half_backlash;
      for (std::size_t k = 0; k < kWavesATurn.size(); ++k) {
        const double a_unit = joint.turns ? 1 : 2 * std::numbers::pi;
        way[j] += joint.wave[k] * std::sin(kWavesATurn[k] * a_unit * at[j] + joint.phase[k]);
      }
    }
    for (const Coupling& c : couplings) way[c.joint] += c.ratio * at[c.from];
    return way;
  }

  // Of the base and behind every joint.
  [[nodiscard]] std::vector<Frame> frames(const std::vector<double>& way) const {
    std::vector<Frame> all{Frame{}};
    for (std::size_t j = 0; j < size(); ++j) {
      const Joint& joint = joints[j];
      Frame next = all.back();
      next.turn(2, joint.theta + (joint.turns ? way[j] : 0));
      next.shift(2, joint.d + (joint.turns ? 0 : way[j]));
      next.shift(0, joint.a);
      next.turn(0, joint.alpha);
      next.turn(1, joint.beta);
      all.push_back(next);
    }
    return all;
  }

  void deflect(const std::vector<Frame>& stiff, std::vector<double>& way) const {
    for (std::size_t j = 0; j < size(); ++j) {
      const Vec& axis = stiff[j].axes[2];
      double pull = 0;
      for (std::size_t k = j + 1; k < stiff.size(); ++k) {
        const Vec lever = sum(mass_point(stiff, k), stiff[j].origin, -1);
        pull += mass[k - 1] * dot(axis, joints[j].turns ? cross(lever, down) : down);
      }
      way[j] += joints[j].softness * pull;
    }
  }

  // What leans is what is bolted to the last of the slides that carry the arm.
  [[nodiscard]] std::size_t foot_frame() const {
    std::size_t foot = 0;
    while (foot < size() && !joints[foot].turns) ++foot;
    return foot;
  }

  // The last mass is what the flange carries.
  [[nodiscard]] Vec mass_point(const std::vector<Frame>& stiff, std::size_t k) const {
    return k + 1 < stiff.size() ? stiff[k].origin : stiff[k].point(targets[0]);
  }

  [[nodiscard]] Vec centre(const std::vector<Frame>& stiff) const {
    Vec middle{0, 0, 0};
    for (std::size_t k = 1; k < stiff.size(); ++k) {
      middle = sum(middle, mass_point(stiff, k), mass[k - 1]);
    }
    return middle;
  }
};

}  // namespace armsig::mistakes::other
