// SPDX-License-Identifier: MIT
// A sound set of measurements: a machine as it was built and mounted, a sensor, and the order in
// which poses were measured, all drawn by a number.
#pragma once

#include <functional>

#include <fmt/core.h>

#include "host_tests/mistakes/other_drawings.hpp"

namespace armsig::mistakes::other {

enum class Rows { kSweeps, kSweepsAndPoses, kPoses, kPosesOfThree };
enum class Seen { kPositions, kPositionsWithoutSigma, kUneven, kRanges };
inline constexpr std::array<const char*, 4> kRowsNames{"sweeps", "sweeps+poses", "poses",
                                                       "poses of three"};
inline constexpr std::array<const char*, 4> kSeenNames{"positions", "no sigma", "uneven noise",
                                                       "ranges"};

// What the machine of a set does that its drawing does not say, and how it was measured.
struct Traits {
  std::size_t drawing = 0;
  Rows rows = Rows::kPoses;
  Seen seen = Seen::kPositions;
  std::size_t mounted = 0;  // floor, ceiling, wall, 45 degrees
  bool backlash = false;
  bool gains = false;
  bool waves = false;
  bool sags = false;
  bool leans = false;
  bool coupled = false;  // and described so
  double sigma = 1e-4;
  std::size_t poses = 100;

  [[nodiscard]] std::string words() const {
    std::string text = fmt::format(
        "{}, {}, {} poses, sigma {:.2f} mm, mount {}", kRowsNames[static_cast<std::size_t>(rows)],
        kSeenNames[static_cast<std::size_t>(seen)], poses, 1e3 * sigma, mounted);
    const auto add = [&](bool is, const char* what) { text += is ? std::string(", ") + what : ""; };
    add(backlash, "backlash");
    add(gains, "gains");
    add(waves, "waves");
    add(sags, "sags");
    add(leans, "leans");
    add(coupled, "coupled");
    return text;
  }
};

inline Traits drawn_traits(Draw& draw, std::size_t number) {
  Traits traits;
  traits.drawing = number % kDrawings;
  traits.rows = static_cast<Rows>(draw.one_of(4));
  traits.seen = static_cast<Seen>(draw.one_of(4));
  traits.mounted = draw.chance(0.5) ? 0 : 1 + draw.one_of(3);
  traits.backlash = draw.chance(0.35);
  traits.gains = draw.chance(0.35);
  traits.waves = draw.chance(0.6);
  traits.sags = draw.chance(0.7);
  traits.leans = draw.chance(0.25);
  traits.coupled = draw.chance(0.25);
  constexpr std::array<double, 4> kSigmas{0.02e-3, 0.05e-3, 0.1e-3, 0.2e-3};
  traits.sigma = kSigmas[draw.one_of(4)];
  traits.poses = 50 + draw.one_of(150);
  if (traits.rows == Rows::kSweepsAndPoses) traits.poses = 30 + draw.one_of(50);
  if (traits.rows == Rows::kPosesOfThree) traits.poses = 40 + draw.one_of(60);
  if (traits.rows == Rows::kSweeps) traits.poses = 0;
  // Sweeps of coupled joints are no circles, and features need them.
  if (traits.rows == Rows::kSweeps) {
    traits.coupled = false;
    if (traits.drawing == kPalletizer) traits.drawing = 0;
  }
  const bool three = traits.rows == Rows::kPosesOfThree;
  if (traits.seen == Seen::kRanges && three) traits.seen = Seen::kPositions;
  return traits;
}

struct OtherRow {
  std::size_t sweep = 0;
  std::size_t target = 0;       // from 0
  std::vector<double> q;        // radians, metres
  Vec p{0, 0, 0};               // true, then seen [m]
  std::array<double, 3> sigma;  // of it
};

// What becomes unsound: before a row is measured, and of it afterwards. `share` of all rows are
// before it.
struct Wrong {
  std::function<void(Machine&, double share)> before = {};
  std::function<void(OtherRow&, double share)> after = {};
  std::function<void(std::vector<OtherRow>&)> at_last = {};
  double lag = 0;      // share of the way from the row before that is left, of all joints
  bool lasts = false;  // readings will be read so ever after
};

class Measurement {
 public:
  explicit Measurement(std::size_t number)
      : draw_(number + 1), traits_(drawn_traits(draw_, number)) {
    assemble();
  }
  Measurement(std::size_t number, const Traits& traits) : draw_(number + 1), traits_(traits) {
    assemble();
  }

  [[nodiscard]] const Traits& traits() const { return traits_; }
  [[nodiscard]] const Machine& machine() const { return machine_; }
  [[nodiscard]] bool by_ranges() const { return traits_.seen == Seen::kRanges; }

  [[nodiscard]] std::string arm_text() const {
    std::string text = "armsig: arm/1\nname: " + drawing_.name + "\njoints:\n";
    const auto degrees = [](double angle) { return angle * 180 / std::numbers::pi; };
    for (const Joint& joint : drawing_.joints) {
      const auto reading = [&](double q) { return joint.turns ? degrees(q) : 1e3 * q; };
      text += fmt::format(
          "  - {{type: {}, theta_deg: {:.9f}, d_mm: {:.9f}, a_mm: {:.9f}, alpha_deg: {:.9f}, "
          "limits_{}: [{:.6f}, {:.6f}]}}\n",
          joint.turns ? "revolute" : "prismatic", degrees(joint.theta), 1e3 * joint.d,
          1e3 * joint.a, degrees(joint.alpha), joint.turns ? "deg" : "mm",
          reading(joint.low) - 1e-5, reading(joint.high) + 1e-5);
    }
    if (!drawing_.couplings.empty()) text += "coupling:\n";
    for (const Coupling& c : drawing_.couplings) {
      text +=
          fmt::format("  - {{joint: {}, from: {}, ratio: {}}}\n", c.joint + 1, c.from + 1, c.ratio);
    }
    return text + fmt::format("mounted: {{gravity: [{:.9f}, {:.9f}, {:.9f}]}}\n", drawing_.down[0],
                              drawing_.down[1], drawing_.down[2]);
  }

  [[nodiscard]] std::string sensor_text() const {
    std::string text = "armsig: sensor/1\nname: seven receivers\nreceivers:\n";
    for (const Vec& p : receivers()) {
      text += fmt::format("  - {{x_mm: {:.3f}, y_mm: {:.3f}, z_mm: {:.3f}}}\n", 1e3 * p[0],
                          1e3 * p[1], 1e3 * p[2]);
    }
    return text + fmt::format("range_sigma_mm: {}\npath: one-way\n", 1e3 * traits_.sigma);
  }

  // All rows in the order in which they were measured.
  [[nodiscard]] std::string rows_text(const Wrong& wrong = {}) {
    std::vector<OtherRow> rows = plan();
    const auto count = static_cast<double>(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double share = static_cast<double>(k) / count;
      if (wrong.before) wrong.before(machine_, share);
      std::vector<double> there = rows[k].q;
      for (std::size_t j = 0; j < there.size() && k > 0; ++j) {
        there[j] += wrong.lag * (rows[k - 1].q[j] - there[j]);
      }
      machine_.go_to(there);
      rows[k].p = machine_.target(rows[k].target);
      if (!by_ranges()) see(rows[k]);
      if (wrong.after) wrong.after(rows[k], share);
    }
    if (wrong.at_last) wrong.at_last(rows);
    std::string text = header();
    for (const OtherRow& row : rows) text += line(row);
    return text;
  }

  // Poses that follow the rows, within what was measured, and where target 1 is there.
  struct Later {
    std::string poses;
    std::vector<Vec> points;
  };
  [[nodiscard]] Later later(std::size_t count, const Wrong& wrong = {}) {
    Later later{.poses = reading_names() + "\n", .points = {}};
    for (std::size_t k = 0; k < count; ++k) {
      const std::vector<double> q = traits_.poses > 0 ? anywhere() : within_sweeps();
      machine_.go_to(q);
      OtherRow row{.q = q, .sigma = sigmas()};
      if (wrong.lasts) wrong.after(row, 1);
      later.poses += readings(row.q).substr(1) + "\n";
      later.points.push_back(machine_.target(0));
    }
    return later;
  }

 private:
  void assemble() {
    machine_ = drawings()[traits_.drawing];
    mount();
    drawing_ = machine_;
    build();
  }

  void mount() {
    const bool arm = machine_.down == Vec{0, 0, -1};
    const double half = std::sqrt(0.5);
    const std::array<Vec, 4> downs{Vec{0, 0, -1}, Vec{0, 0, 1}, Vec{-1, 0, 0},
                                   Vec{-half, 0, -half}};
    if (arm) machine_.down = downs[traits_.mounted];
    if (!arm) traits_.mounted = 0;
    if (!traits_.coupled || !machine_.couplings.empty() || machine_.size() < 6) {
      traits_.coupled = !machine_.couplings.empty();
      return;
    }
    const std::size_t last = machine_.size() - 1;
    machine_.couplings.push_back({last, last - 1, draw_.either_sign(0.005, 1)});
    if (draw_.chance(0.5))
      machine_.couplings.push_back({last - 1, last - 2, draw_.either_sign(0.005, 0.1)});
  }

  void build() {
    constexpr double kDegree = std::numbers::pi / 180;
    machine_.base.turn(2, draw_.between(-3, 3));
    machine_.base.turn(0, draw_.between(-0.2, 0.2));
    for (double& x : machine_.base.origin) x = draw_.between(-0.4, 0.4);
    const double softness = draw_.between(0.1, 1) * 1e-3;
    for (Joint& joint : machine_.joints) {
      joint.theta += draw_.normal(0.2 * kDegree);
      joint.alpha += draw_.normal(0.1 * kDegree);
      joint.beta = draw_.normal(0.05 * kDegree);
      joint.d += draw_.normal(0.5e-3);
      joint.a += draw_.normal(0.5e-3);
      build_drive(joint, softness);
    }
    if (traits_.leans) machine_.lean = draw_.between(0.1, 0.8) * 1e-3;
    machine_.mass.assign(machine_.size(), 0.6 / static_cast<double>(machine_.size()));
    machine_.mass.back() += 0.4;
    machine_.targets = {{0.15, 0.05, 0.12}, {-0.1, 0.12, 0.1}, {0.02, -0.14, 0.16}};
    for (Vec& target : machine_.targets) target = sum(target, {draw_.normal(5e-3), 0, 0});
  }

  void build_drive(Joint& joint, double softness) {
    constexpr double kDegree = std::numbers::pi / 180;
    if (traits_.gains) {
      joint.gain = joint.turns ? draw_.normal(2e-4) : draw_.either_sign(2e-4, 2e-3);
    }
    if (traits_.backlash && draw_.chance(0.7)) {
      joint.half_backlash =
          joint.turns ? draw_.between(0.005, 0.04) * kDegree : draw_.between(5e-6, 40e-6);
    }
    for (std::size_t k = 0; traits_.waves && k < joint.wave.size(); ++k) {
      joint.wave[k] = joint.turns ? draw_.normal(0.006 * kDegree) : draw_.normal(10e-6);
      joint.phase[k] = draw_.between(0, 2 * std::numbers::pi);
    }
    const double share = draw_.between(0.2, 1);
    if (traits_.sags) joint.softness = share * (joint.turns ? softness : 0.2 * softness);
  }

  [[nodiscard]] static std::vector<Vec> receivers() {
    std::vector<Vec> all;
    for (int k = 0; k < 7; ++k) {
      const double turn = 2 * std::numbers::pi * k / 7;
      all.push_back({3 * std::cos(turn), 3 * std::sin(turn), 0.9 * (k % 3) - 1.5});
    }
    return all;
  }

  [[nodiscard]] std::string reading_names() const {
    std::string text;
    for (std::size_t j = 0; j < machine_.size(); ++j) {
      text += fmt::format("{}q{}_{}", j == 0 ? "" : ",", j + 1,
                          machine_.joints[j].turns ? "deg" : "mm");
    }
    return text;
  }

  [[nodiscard]] std::string header() const {
    std::string text = "sweep,target," + reading_names();
    if (by_ranges()) {
      for (std::size_t k = 1; k <= receivers().size(); ++k) text += fmt::format(",r{}_mm", k);
      return text + ",sigma_mm\n";
    }
    text += ",x_mm,y_mm,z_mm";
    if (traits_.seen != Seen::kPositionsWithoutSigma) text += ",sigma_mm";
    return text + "\n";
  }

  [[nodiscard]] std::vector<double> anywhere() {
    std::vector<double> q;
    for (const Joint& joint : machine_.joints) q.push_back(draw_.between(joint.low, joint.high));
    return q;
  }

  // How far sweeps go.
  [[nodiscard]] std::array<double, 2> arc(std::size_t j) const {
    const Joint& joint = machine_.joints[j];
    const double reach = joint.turns ? 75 * std::numbers::pi / 180 : 10;
    return {std::max(joint.low, joint.home - reach), std::min(joint.high, joint.home + reach)};
  }
  [[nodiscard]] std::vector<double> within_sweeps() {
    std::vector<double> q;
    for (std::size_t j = 0; j < machine_.size(); ++j)
      q.push_back(draw_.between(arc(j)[0], arc(j)[1]));
    return q;
  }

  // Sweeps come from below to every point.
  [[nodiscard]] std::vector<OtherRow> plan() {
    constexpr int kPoints = 40;
    std::vector<OtherRow> rows;
    const bool sweeps = traits_.rows == Rows::kSweeps || traits_.rows == Rows::kSweepsAndPoses;
    for (std::size_t j = 0; j < machine_.size() && sweeps; ++j) {
      for (int k = 0; k < kPoints; ++k) {
        OtherRow row{.sweep = j + 1, .q = {}, .sigma = sigmas()};
        for (const Joint& joint : machine_.joints) row.q.push_back(joint.home);
        const auto [from, to] = arc(j);
        row.q[j] = from + (to - from) * k / (kPoints - 1);
        rows.push_back(row);
      }
    }
    const std::size_t targets = traits_.rows == Rows::kPosesOfThree ? 3 : 1;
    for (std::size_t k = 0; k < traits_.poses; ++k) {
      const std::vector<double> q = anywhere();
      for (std::size_t t = 0; t < targets; ++t) rows.push_back({0, t, q, {}, sigmas()});
    }
    return rows;
  }

  // A tracker sees along its line better than across, and states one figure.
  [[nodiscard]] std::array<double, 3> sigmas() const {
    const double s = traits_.sigma;
    if (traits_.seen == Seen::kUneven) return {0.5 * s, s, 2 * s};
    return {s, s, s};
  }

  void see(OtherRow& row) {
    for (std::size_t i = 0; i < 3; ++i) row.p[i] += draw_.normal(row.sigma[i]);
  }

  [[nodiscard]] std::string readings(const std::vector<double>& q) const {
    std::string text;
    for (std::size_t j = 0; j < machine_.size(); ++j) {
      const double a_unit = machine_.joints[j].turns ? 180 / std::numbers::pi : 1e3;
      text += fmt::format(",{:.9f}", a_unit * q[j]);
    }
    return text;
  }

  [[nodiscard]] std::string line(const OtherRow& row) {
    std::string text = fmt::format("{},{}{}", row.sweep, row.target + 1, readings(row.q));
    if (by_ranges()) return text + ranges(row);
    for (const double x : row.p) text += fmt::format(",{:.9f}", 1e3 * x);
    if (traits_.seen == Seen::kPositionsWithoutSigma) return text + "\n";
    double squares = 0;
    for (const double sigma : row.sigma) squares += sigma * sigma / 3;
    return text + fmt::format(",{:.6f}\n", 1e3 * std::sqrt(squares));
  }

  [[nodiscard]] std::string ranges(const OtherRow& row) {
    std::string text;
    for (const Vec& receiver : receivers()) {
      const Vec way = sum(row.p, receiver, -1);
      const double range_mm = 1e3 * (std::sqrt(dot(way, way)) + draw_.normal(traits_.sigma));
      text += draw_.chance(0.1) ? "," : fmt::format(",{:.9f}", range_mm);
    }
    return text + fmt::format(",{:.6f}\n", 1e3 * traits_.sigma);
  }

  Draw draw_;
  Traits traits_;
  Machine drawing_;
  Machine machine_;
};

}  // namespace armsig::mistakes::other
