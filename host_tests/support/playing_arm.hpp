// SPDX-License-Identifier: MIT
// An arm whose joints have play, and that calibrates itself, with nothing around it: where it truly
// is, is computed apart from the model that is fitted.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/servo_readings.hpp"
#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/controller/sweep.hpp"
#include "firmware/self_calibration/self_calibration.hpp"
#include "firmware/virtual_cabinet/bent_arm.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/random.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::test {

struct PlayingWorld {
  Arm drawing;
  JointVector configuration;  // the signature's
  JointVector play;           // of each joint [rad or m], from one end of it to the other
  std::uint64_t seed = 1;     // of the arm as built, its maps, and the noise
  double sigma_m = 0.1e-3;    // of a point, per axis
  std::size_t poses = 120;    // after which time is over
};

// Behind every joint's encoder is its play: the joint follows when its end is reached.
class PlayingArm {
 public:
  explicit PlayingArm(const PlayingWorld& world)
      : world_(world), random_(world.seed), calibration_(configuration_, *memory_) {
    configuration_.drawing = world.drawing;
    configuration_.sweeps.configuration = world.configuration;
    configuration_.sweeps.arc_rad = radians(120);
    simulated::Random drawn(world.seed, 1);
    arm_.arm = simulated::drawn_arm(world.drawing, {}, drawn);
    arm_.X_S0 = simulated::demo_base_pose();
    const std::size_t n = world.drawing.joints.size();
    arm_.targets.push_back({.number = 1, .link = n, .p_L = {0.15, 0.0, 0.05}});
    bent_ = cabinet::bent_model(world.drawing, {.map_rad = radians(0.02), .sag_m = 0.5e-3}, drawn);
    stands_ = world.configuration;
    const KnownTarget known{1, n, arm_.targets[0].p_L};
    record_.signature = signature_of(arm_.arm, world.configuration, arm_.X_S0, {&known, 1});
  }

  // All of it; false where no model was written.
  bool calibrate(double accuracy_m) {
    const auto ends = std::chrono::seconds(static_cast<int>(world_.poses));
    (void)calibration_.begin({.accuracy_m = accuracy_m, .ends = hal::Instant() + ends}, {});
    sweep();
    calibration_.refine(record_.signature);
    using Next = controller::Refinement::Next;
    for (Next next = Next::kComputes; next != Next::kDone;) {
      next = calibration_.step(now_);
      if (next == Next::kVisits) visit();
      if (next != Next::kTells) continue;
      controller::Line line;
      calibration_.tell(line);
      told_.emplace_back(line.view());
    }
    return calibration_.write(record_).has_value();
  }

  // The last line with these words.
  [[nodiscard]] std::string heard(std::string_view words) const {
    const auto found = std::find_if(told_.rbegin(), told_.rend(),
                                    [&](const std::string& line) { return line.contains(words); });
    return found == told_.rend() ? "" : *found;
  }

  // Drives to random poses, as many as that; RMS of the way from where the record puts the tool.
  [[nodiscard]] double miss_m(int poses = 200) {
    const auto chain = kinematics::chain_of<double>(record_.signature);
    const calibration::ServoReadings joints(record_.deflections, configuration_.drawing,
                                            record_.signature.configuration);
    const std::size_t n = world_.drawing.joints.size();
    const Vector3 p_L = record_.signature.X_SL.back().inverse() * record_.signature.targets[0].p_S;
    simulated::Random random(99);
    double squares = 0;
    for (int k = 0; k < poses; ++k) {
      JointVector q = world_.configuration;
      for (std::size_t i = 0; i < n; ++i) {
        const auto [lower, upper] = configuration_.drawing.limits[i];
        q[i] += configuration_.sweeps.validation_reach * (random.uniform(lower, upper) - q[i]);
      }
      go_to(q);
      squares +=
          (kinematics::link_pose(chain, *joints.turned(q), n) * p_L - target_at(q)).squaredNorm();
    }
    return std::sqrt(squares / poses);
  }

 private:
  void go_to(const JointVector& q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      stands_[i] = std::clamp(stands_[i], q[i] - world_.play[i] / 2, q[i] + world_.play[i] / 2);
    }
  }

  [[nodiscard]] Vector3 target_at(const JointVector& q) const {
    JointVector behind = q;
    for (std::size_t i = 0; i < q.size(); ++i) behind[i] -= stands_[i];
    return simulated::target_position(arm_, cabinet::turned(bent_, q, behind), arm_.targets[0]);
  }

  void measure(std::size_t sweep, const JointVector& q) {
    go_to(q);
    calibration_.take(sweep, q,
                      {.p_S = target_at(q) + world_.sigma_m * random_.normal_vector(),
                       .covariance_m2 = world_.sigma_m * world_.sigma_m * Matrix3::Identity(),
                       .pings = 1});
  }

  void sweep() {
    constexpr int kPoints = 24;
    for (std::size_t joint = 0; joint < world_.drawing.joints.size(); ++joint) {
      const auto [lower, upper] = controller::planned_arc(configuration_, joint);
      for (int k = 0; k < kPoints; ++k) {
        JointVector q = world_.configuration;
        q[joint] = lower + (upper - lower) * k / (kPoints - 1);
        measure(joint + 1, q);
      }
    }
  }

  void visit() {
    now_ += std::chrono::seconds(1);
    const controller::Refinement::Visit to = calibration_.visit();
    go_to(to.approach);
    measure(0, to.pose);
  }

  PlayingWorld world_;
  simulated::Random random_;
  simulated::SimulatedArm arm_;
  calibration::ArmModel bent_;
  JointVector stands_;  // where the joints are, by their encoders
  controller::Configuration configuration_;
  std::unique_ptr<controller::SelfCalibrationMemory<600>> memory_ =
      std::make_unique<controller::SelfCalibrationMemory<600>>();
  controller::SelfCalibration calibration_;
  controller::SignatureRecord record_;
  hal::Instant now_;
  std::vector<std::string> told_;
};

}  // namespace armsig::test
