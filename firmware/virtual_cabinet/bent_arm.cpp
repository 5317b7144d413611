// SPDX-License-Identifier: MIT
#include "firmware/virtual_cabinet/bent_arm.hpp"

#include <array>
#include <cmath>

namespace armsig::cabinet {
namespace {

using calibration::ArmModel;
using calibration::GravityTerm;
using calibration::JointModel;
using calibration::kKnots;

constexpr std::array<double, 4> kWaves{1, 2, 7, 17};  // a turn
constexpr double kSlideLength_m = 0.5;

void add_waves(double largest, simulated::Random& random, JointModel& joint) {
  std::array<double, kWaves.size()> share{};
  double sum = 0;
  for (double& part : share) sum += part = random.uniform(0.3, 1);
  for (std::size_t w = 0; w < kWaves.size(); ++w) {
    const double phase = random.uniform(-kPi, kPi);
    const double step = 2 * kPi * kWaves[w] / static_cast<double>(kKnots);
    // What a spline of such coefficients is at its knots, per unit.
    const double passed = (4 + 2 * std::cos(step)) / 6;
    for (std::size_t k = 0; k < kKnots; ++k) {
      joint.map[k] += largest / calibration::map_unit(joint.type) * share[w] / sum / passed *
                      std::sin(step * static_cast<double>(k) + phase);
    }
  }
}

// One weight at the last link's origin: of every joint the lever of that, if it has one.
void add_sag(const Arm& drawing, double sag_m, ArmModel& model) {
  calibration::choose_gravity_terms(drawing, model);
  const std::size_t n = model.joint_count();
  FixedVector<GravityTerm, calibration::kMaxGravityTerms> kept;
  double squares = 0;  // of the stretched levers
  for (std::size_t j = 0; j < n; ++j) {
    bool has_lever = false;
    for (const GravityTerm& term : model.gravity) has_lever = has_lever || term.joint == j;
    if (!has_lever || model.joints[j].type != JointType::kRevolute) continue;
    double length = 0;
    for (std::size_t i = j; i < n; ++i) {
      const bool slides = drawing.joints[i].type == JointType::kPrismatic;
      const double along_m = slides ? drawing.limits[i].upper : drawing.joints[i].d_m;
      length += std::hypot(drawing.joints[i].a_m, along_m);
    }
    squares += length * length;
    kept.push_back({static_cast<std::uint8_t>(j), static_cast<std::uint8_t>(n), 1});
  }
  model.gravity = kept;
  for (GravityTerm& term : model.gravity) term.coefficient = squares > 0 ? sag_m / squares : 0;
}

}  // namespace

double bend_amount(JointType type, double rad) {
  return type == JointType::kRevolute ? rad : kSlideLength_m * rad;
}

ArmModel bent_model(const Arm& drawing, const Bends& bends, simulated::Random& random) {
  ArmModel model = calibration::model_of(drawing, {});
  if (bends.sag_m > 0) add_sag(drawing, bends.sag_m, model);
  for (JointModel& joint : model.joints) {
    if (bends.map_rad > 0) add_waves(bend_amount(joint.type, bends.map_rad), random, joint);
  }
  return model;
}

JointVector turned(const ArmModel& model, const JointVector& readings, const JointVector& behind) {
  std::array<double, kMaxJoints> by{};
  calibration::deflections(model, readings, by);
  JointVector turned = effective_readings(model.couplings, readings);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    turned[i] += by[i] - (behind.empty() ? 0 : behind[i]);
  }
  return readings_for(model.couplings, turned);
}

}  // namespace armsig::cabinet
