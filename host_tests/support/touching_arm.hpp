// SPDX-License-Identifier: MIT
// An arm that touches sockets and planes and is tied to wires, simulated by a chain of its own:
// none of the code under test is used.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>

namespace armsig::touching {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

inline constexpr double kDegree = std::numbers::pi / 180;

// theta, d, a [m], alpha [degrees] of standard Denavit-Hartenberg rows.
struct Row {
  double theta_deg, d, a, alpha_deg;
};

struct Drawing {
  std::string name;
  std::vector<Row> rows;
  std::vector<double> limit_deg;  // either way
};

inline Drawing ur5() {
  return {"UR5",
          {{0, 0.089159, 0, 90},
           {0, 0, -0.425, 0},
           {0, 0, -0.39225, 0},
           {0, 0.10915, 0, 90},
           {0, 0.09465, 0, -90},
           {0, 0.0823, 0, 0}},
          {180, 180, 180, 180, 180, 180}};
}

inline Drawing puma560() {
  return {"Puma 560",
          {{0, 0.6718, 0, -90},
           {0, 0.1397, 0.4318, 0},
           {0, 0, 0.0203, -90},
           {0, 0.4318, 0, 90},
           {0, 0, 0, -90},
           {0, 0.05625, 0, 0}},
          {160, 180, 180, 170, 100, 180}};
}

inline Drawing iiwa() {
  return {"iiwa",
          {{0, 0.36, 0, -90},
           {0, 0, 0, 90},
           {0, 0.42, 0, 90},
           {0, 0, 0, -90},
           {0, 0.4, 0, -90},
           {0, 0, 0, 90},
           {0, 0.126, 0, 0}},
          {170, 120, 170, 120, 170, 120, 175}};
}

// Where the flange is, and how it is turned.
struct Frame {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
};

inline Matrix3d about(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

struct Faults {
  double rotation = 1e-3;
  double shift_m = 0.5e-3;
  double zero = 3e-3;
  double wave = 0.01 * kDegree;
  double sag = 1.5e-3;  // rad per metre of lever, of every joint but the first; halved outwards
};

class TrueArm {
 public:
  TrueArm(const Drawing& drawing, const Faults& faults, std::mt19937& random)
      : drawing_(drawing), joints_(drawing.rows.size()) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    double sag = faults.sag;
    for (Joint& joint : joints_) {
      joint.tilt = {faults.rotation * normal(random), faults.rotation * normal(random), 0};
      joint.shift = {faults.shift_m * normal(random), faults.shift_m * normal(random), 0};
      joint.zero = faults.zero * normal(random);
      joint.sag = sag;
      sag /= 2;
      for (std::size_t k = 0; k < joint.wave.size(); ++k) {
        joint.wave[k] = faults.wave * normal(random) / std::sqrt(2.0);
        joint.phase[k] = phase(random);
      }
    }
    joints_.front().sag = 0;
  }

  [[nodiscard]] std::size_t size() const { return joints_.size(); }
  [[nodiscard]] const Drawing& drawing() const { return drawing_; }
  // Of a joint, from the drawing: turn about and shift along x and y before it [rad, m], zero
  // [rad].
  [[nodiscard]] std::array<double, 5> deviations(std::size_t joint) const {
    const Joint& of = joints_[joint];
    return {of.tilt.x(), of.tilt.y(), of.shift.x(), of.shift.y(), of.zero};
  }

  [[nodiscard]] Frame flange(const VectorXd& q) const {
    // What gravity does is found from where the arm is without it.
    std::vector<Frame> axes;
    std::vector<Vector3d> origins;
    chain(q, VectorXd::Zero(q.size()), &axes, &origins);
    VectorXd sag = VectorXd::Zero(q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const auto i = static_cast<std::size_t>(j);
      Vector3d centre = Vector3d::Zero();
      for (std::size_t k = i; k < origins.size(); ++k) {
        centre += (origins[k] - axes[i].p) / static_cast<double>(origins.size() - i);
      }
      sag[j] = joints_[i].sag * axes[i].R.col(2).dot(centre.cross(-Vector3d::UnitZ()));
    }
    return chain(q, sag, nullptr, nullptr);
  }

  [[nodiscard]] bool within(const VectorXd& q) const {
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      if (std::abs(q[j]) > drawing_.limit_deg[static_cast<std::size_t>(j)] * kDegree) return false;
    }
    return true;
  }

 private:
  struct Joint {
    Vector3d tilt, shift;
    double zero = 0;
    double sag = 0;
    std::array<double, 2> wave{};  // once and twice a turn
    std::array<double, 2> phase{};
  };

  Frame chain(const VectorXd& q, const VectorXd& sag, std::vector<Frame>* axes,
              std::vector<Vector3d>* origins) const {
    Frame X;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Joint& joint = joints_[static_cast<std::size_t>(j)];
      const Row& row = drawing_.rows[static_cast<std::size_t>(j)];
      X.p += X.R * joint.shift;
      const double tilt = joint.tilt.norm();
      if (tilt > 0) X.R = X.R * about(joint.tilt / tilt, tilt);
      if (axes != nullptr) axes->push_back(X);
      double turn = q[j] + row.theta_deg * kDegree + joint.zero + sag[j];
      for (std::size_t k = 0; k < joint.wave.size(); ++k) {
        turn += joint.wave[k] * std::sin(static_cast<double>(k + 1) * q[j] + joint.phase[k]);
      }
      X.R = X.R * about(Vector3d::UnitZ(), turn);
      X.p += X.R * Vector3d(row.a, 0, row.d);
      X.R = X.R * about(Vector3d::UnitX(), row.alpha_deg * kDegree);
      if (origins != nullptr) origins->push_back(X.p);
    }
    return X;
  }

  Drawing drawing_;
  std::vector<Joint> joints_;
};

// Readings at which the point `tool` of the flange is at `target`, the flange's z axis along
// `stem`, found from a random configuration; nothing where the search fails.
inline std::optional<VectorXd> reach(const TrueArm& arm, const Vector3d& tool,
                                     const Vector3d& target, const Vector3d& stem,
                                     std::mt19937& random) {
  VectorXd q(static_cast<Eigen::Index>(arm.size()));
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const double limit = arm.drawing().limit_deg[static_cast<std::size_t>(j)] * kDegree;
    q[j] = std::uniform_real_distribution<double>(-limit, limit)(random);
  }
  const auto error = [&](const VectorXd& at) {
    const Frame X = arm.flange(at);
    VectorXd e(6);
    e << X.R * tool + X.p - target, 0.3 * (X.R.col(2) - stem);
    return e;
  };
  for (int pass = 0; pass < 40; ++pass) {
    const VectorXd e = error(q);
    if (e.norm() < 1e-10) break;
    Eigen::MatrixXd J(6, q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      VectorXd other = q;
      other[j] += 1e-6;
      J.col(j) = (error(other) - e) / 1e-6;
    }
    const Eigen::MatrixXd damped =
        J.transpose() * J + 1e-9 * Eigen::MatrixXd::Identity(q.size(), q.size());
    VectorXd step = damped.ldlt().solve(J.transpose() * e);
    if (step.norm() > 0.5) step *= 0.5 / step.norm();
    q -= step;
  }
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = std::remainder(q[j], 2 * std::numbers::pi);
  if (error(q).norm() > 1e-9 || !arm.within(q)) return std::nullopt;
  return q;
}

// Readings near `q` at which the tool is at `target`, by the shortest steps.
inline VectorXd settle(const TrueArm& arm, const Vector3d& tool, const Vector3d& target,
                       VectorXd q) {
  const auto at = [&](const VectorXd& readings) -> Vector3d {
    const Frame X = arm.flange(readings);
    return X.R * tool + X.p;
  };
  for (int pass = 0; pass < 20; ++pass) {
    const Vector3d off = target - at(q);
    if (off.norm() < 1e-10) break;
    Eigen::Matrix3Xd J(3, q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      VectorXd other = q;
      other[j] += 1e-6;
      J.col(j) = (at(other) - at(q)) / 1e-6;
    }
    q += J.transpose() * (J * J.transpose()).ldlt().solve(off);
  }
  return q;
}

// Within 75 degrees of straight down, evenly over the solid angle.
inline Vector3d any_stem(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const double cosine = 1 - share(random) * (1 - std::cos(75 * kDegree));
  const double sine = std::sqrt(1 - cosine * cosine);
  const double turn = 2 * std::numbers::pi * share(random);
  return {sine * std::cos(turn), sine * std::sin(turn), -cosine};
}

struct Reading {
  std::string place;
  VectorXd q;
  std::optional<double> length_m;
};

// A session: what was touched, and what is written down of it.
class Session {
 public:
  Session(const Drawing& drawing, unsigned seed, const Faults& faults = {})
      : random_(seed), arm_(drawing, faults, random_), seat_m_(0.05e-3) {
    std::normal_distribution<double> off(0, 0.02);
    tool_ = {off(random_), off(random_), 0.15 + off(random_) / 4};
    nominal_tool_ = {0, 0, 0.15};
    lift_ = drawing.rows.front().d > 0.3 ? 0.25 : 0;
  }

  // Bars of two sockets each, about the arm at several heights; their lengths as a caliper of
  // `sigma_m` has them.
  void add_bars(int count, double length_m, double sigma_m) {
    for (int b = 0; b < count; ++b) {
      const double turn = 2 * std::numbers::pi * (b + 0.25 * normal()) / count;
      const double radius = 0.5 + 0.05 * normal();
      const Vector3d middle(radius * std::cos(turn), radius * std::sin(turn),
                            lift_ + 0.05 + 0.12 * (b % 3));
      const Vector3d along =
          Vector3d(std::cos(turn + 1 + b), std::sin(turn + 1 + b), 0.3 * normal()).normalized();
      const std::string name(1, static_cast<char>('A' + b));
      sockets_[name + "1"] = middle - length_m / 2 * along;
      sockets_[name + "2"] = middle + length_m / 2 * along;
      if (sigma_m > 0) {
        lengths_.push_back({name + "1", name + "2", length_m + sigma_m * normal(), sigma_m});
      }
    }
  }

  // Touches of all sockets in turn.
  void touch_sockets(int count) {
    while (count > 0) {
      for (const auto& [name, centre] : sockets_) {
        if (count == 0) break;
        if (touch(name, centre)) --count;
      }
    }
  }

  // Touches of a plane about `middle`, 0.4 m wide.
  void touch_plane(const std::string& name, const Vector3d& middle, const Vector3d& normal,
                   int count) {
    kinds_[name] = "plate";
    planes_[name] = {normal, normal.dot(middle)};
    const Vector3d first = normal.unitOrthogonal();
    std::uniform_real_distribution<double> along(-0.2, 0.2);
    while (count > 0) {
      const Vector3d at = middle + along(random_) * first + along(random_) * normal.cross(first);
      if (touch(name, at)) --count;
    }
  }

  // Lengths of a wire from `anchor` to the tool about the arm, 1 sigma 0.05 mm; a length read is
  // (true - zero) / (1 + gain).
  void read_wire(const std::string& name, const Vector3d& anchor, double gain, double zero_m,
                 int count) {
    kinds_[name] = "encoder";
    anchors_[name] = anchor;
    gain_ = gain;
    zero_m_ = zero_m;
    std::uniform_real_distribution<double> share(-1, 1);
    while (count > 0) {
      const Vector3d at(0.65 * share(random_), 0.65 * share(random_),
                        lift_ + 0.35 + 0.3 * share(random_));
      if (at.head<2>().norm() < 0.25 || !touch(name, at)) continue;
      const double length_m = (at - anchor).norm() + 0.05e-3 * normal();
      readings_.back().length_m = (length_m - zero_m) / (1 + gain);
      --count;
    }
  }

  // One touch, if a random configuration leads there.
  bool touch(const std::string& name, const Vector3d& centre) {
    const Vector3d seated = centre + seat_m_ * Vector3d(normal(), normal(), normal());
    const auto q = reach(arm_, tool_, seated, any_stem(random_), random_);
    if (!q) return false;
    readings_.push_back({name, *q, std::nullopt});
    return true;
  }

  // The same led from readings near it.
  void touch_near(const std::string& name, const Vector3d& centre, const VectorXd& near) {
    const Vector3d seated = centre + seat_m_ * Vector3d(normal(), normal(), normal());
    readings_.push_back({name, settle(arm_, tool_, seated, near), std::nullopt});
  }

  [[nodiscard]] std::string csv() const {
    std::string text = "place";
    bool lengths = false;
    for (const Reading& reading : readings_) lengths = lengths || reading.length_m.has_value();
    for (std::size_t j = 0; j < arm_.size(); ++j) text += ",q" + std::to_string(j + 1) + "_deg";
    text += lengths ? ",length_mm\n" : "\n";
    for (const Reading& reading : readings_) {
      text += reading.place;
      for (const double q : reading.q) text += "," + number(q / kDegree);
      if (lengths) text += "," + (reading.length_m ? number(1e3 * *reading.length_m) : "");
      text += "\n";
    }
    return text;
  }

  [[nodiscard]] std::string instrument_yaml() const {
    std::string text = "armsig: instrument/1\nname: simulated\ntool_mm: [" +
                       number(1e3 * nominal_tool_.x()) + ", " + number(1e3 * nominal_tool_.y()) +
                       ", " + number(1e3 * nominal_tool_.z()) +
                       "]\ninstruments:\n  - {name: ball, kind: socket}\n";
    if (has("plate")) text += "  - {name: plate, kind: plane}\n";
    if (has("encoder")) {
      text += "  - {name: encoder, kind: wire, gain_sigma: 0.002, zero_sigma_mm: 10}\n";
    }
    if (!kinds_.empty()) text += "places:\n";
    for (const auto& [name, kind] : kinds_) text += "  " + name + ": " + kind + "\n";
    if (lengths_.empty()) return text;
    text += "lengths:\n";
    for (const Length& length : lengths_) {
      text += "  - {from: " + length.from + ", to: " + length.to +
              ", length_mm: " + number(1e3 * length.length_m) +
              ", sigma_mm: " + number(1e3 * length.sigma_m) + "}\n";
    }
    return text;
  }

  [[nodiscard]] std::string arm_yaml() const {
    std::string text = "armsig: arm/1\nname: " + arm_.drawing().name + "\njoints:\n";
    for (std::size_t j = 0; j < arm_.size(); ++j) {
      const Row& row = arm_.drawing().rows[j];
      const std::string limit = number(arm_.drawing().limit_deg[j]);
      text += "  - {type: revolute, theta_deg: " + number(row.theta_deg) +
              ", d_mm: " + number(1e3 * row.d) + ", a_mm: " + number(1e3 * row.a) +
              ", alpha_deg: " + number(row.alpha_deg) + ", limits_deg: [-" + limit + ", " + limit +
              "]}\n";
    }
    return text;
  }

  // RMS of the tool's error by `predicted` (a function of the readings to a point) over random
  // readings within those of the touches, after the best rigid motion.
  template <typename Predicted>
  [[nodiscard]] double tool_error_m(Predicted predicted, int count = 400) {
    VectorXd lower = readings_.front().q;
    VectorXd upper = lower;
    for (const Reading& reading : readings_) {
      lower = lower.cwiseMin(reading.q);
      upper = upper.cwiseMax(reading.q);
    }
    std::vector<VectorXd> judged;
    std::uniform_real_distribution<double> share(0, 1);
    for (int k = 0; k < count; ++k) {
      VectorXd q = lower;
      for (double& one : q) one = share(random_);
      judged.emplace_back(lower + q.cwiseProduct(upper - lower));
    }
    return tool_error_over_m(predicted, judged);
  }

  // The same over these readings.
  template <typename Predicted>
  [[nodiscard]] double tool_error_over_m(Predicted predicted,
                                         const std::vector<VectorXd>& judged) const {
    Eigen::Matrix3Xd found(3, static_cast<Eigen::Index>(judged.size()));
    Eigen::Matrix3Xd truth = found;
    for (Eigen::Index k = 0; k < found.cols(); ++k) {
      const VectorXd& q = judged[static_cast<std::size_t>(k)];
      const Frame X = arm_.flange(q);
      truth.col(k) = X.R * tool_ + X.p;
      found.col(k) = predicted(q);
    }
    const Eigen::Matrix4d T = Eigen::umeyama(found, truth, false);
    const Eigen::Matrix3Xd turned = T.topLeftCorner<3, 3>() * found;
    const Vector3d shift = T.topRightCorner<3, 1>();
    const Eigen::Matrix3Xd left = turned.colwise() + shift - truth;
    return left.norm() / std::sqrt(static_cast<double>(found.cols()));
  }

  struct Plane {
    Vector3d normal;
    double distance_m = 0;  // normal times any of its points
  };

  struct Length {
    std::string from, to;
    double length_m = 0;
    double sigma_m = 0;
  };

  [[nodiscard]] std::vector<Reading>& readings() { return readings_; }
  [[nodiscard]] std::vector<Length>& lengths() { return lengths_; }
  [[nodiscard]] std::map<std::string, Vector3d>& sockets() { return sockets_; }
  [[nodiscard]] const std::map<std::string, Plane>& planes() const { return planes_; }
  [[nodiscard]] const std::map<std::string, Vector3d>& anchors() const { return anchors_; }
  [[nodiscard]] double wire_gain() const { return gain_; }
  [[nodiscard]] double wire_zero_m() const { return zero_m_; }
  // Of everything that is touched, where the first joint is high.
  [[nodiscard]] double lift_m() const { return lift_; }
  [[nodiscard]] Vector3d& tool() { return tool_; }
  [[nodiscard]] Vector3d& nominal_tool() { return nominal_tool_; }
  [[nodiscard]] std::mt19937& random() { return random_; }
  [[nodiscard]] const TrueArm& arm() const { return arm_; }
  double normal() { return normal_(random_); }

  static std::string number(double value) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.7g", value);
    return text.data();
  }

 private:
  [[nodiscard]] bool has(const std::string& kind) const {
    for (const auto& [name, of] : kinds_) {
      if (of == kind) return true;
    }
    return false;
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  TrueArm arm_;
  double seat_m_;
  double lift_ = 0;
  Vector3d tool_ = Vector3d::Zero();
  Vector3d nominal_tool_ = Vector3d::Zero();
  std::map<std::string, Vector3d> sockets_;
  std::map<std::string, std::string> kinds_;  // of places that are no sockets
  std::map<std::string, Plane> planes_;
  std::map<std::string, Vector3d> anchors_;
  double gain_ = 0;
  double zero_m_ = 0;
  std::vector<Length> lengths_;
  std::vector<Reading> readings_;
};

}  // namespace armsig::touching
