// SPDX-License-Identifier: MIT
// A Puma with maps of its readings, sag and play in a virtual cabinet that can calibrate itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/kinematics/s_model_chain.hpp"
#include "firmware/self_calibration/self_calibration.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {

using test::PumaCabinet;

inline constexpr cabinet::Bends kBends{
    .map_rad = radians(0.02), .sag_m = 0.5e-3, .play_rad = radians(0.005)};

// ARMSIG_SELF_SEED=N: another arm, other noise, for the proof on seeds that nothing was tuned on.
inline std::uint64_t seed_of_the_world() {
  const char* const asked = std::getenv("ARMSIG_SELF_SEED");  // NOLINT(concurrency-mt-unsafe)
  return asked == nullptr ? 3 : std::strtoull(asked, nullptr, 10);
}

struct BentPuma : PumaCabinet {
  explicit BentPuma(const cabinet::Bends& bends = kBends, PointJournal* journal = nullptr,
                    const Configuration& configured = arc_of_90_degrees())
      : configuration(configured),
        world(test::puma_world(seed_of_the_world())),
        calibration(configuration, *room, journal) {
    world.drive = test::honest_puma_drive();
    world.drive->motion.play = 0;
    simulated::Random random(4 + seed_of_the_world(), 2);
    if (bends.map_rad > 0 || bends.sag_m > 0) {
      world.bent = cabinet::bent_model(configuration.drawing, bends, random);
    }
    world.play_rad = bends.play_rad;
    power_up();
  }

  void power_up() {
    cabinet.reset();
    cabinet = std::make_unique<cabinet::VirtualCabinet>(configuration, test::puma_bus(), world,
                                                        memory, consoles, nullptr, &calibration);
  }

  // Drives to random poses, as many as that, and looks where the tool truly is: RMS of the way from
  // where `record` puts it.
  [[nodiscard]] double miss_m(const SignatureRecord& of, int poses = 200) {
    const SignatureRecord record = of;
    const auto chain = kinematics::chain_of<double>(record.signature);
    const calibration::ServoReadings joints(record.deflections, configuration.drawing,
                                            record.signature.configuration);
    const Vector3 p_L = record.signature.X_SL.back().inverse() * record.signature.targets[0].p_S;
    simulated::Random random(99);
    double squares = 0;
    for (int k = 0; k < poses; ++k) {
      std::string request = "move";
      for (std::size_t i = 0; i < 6; ++i) {
        const auto [lower, upper] = configuration.drawing.limits[i];
        const double centre = configuration.sweeps.configuration[i];
        const double reach = configuration.sweeps.validation_reach;
        const double q = centre + reach * (random.uniform(lower, upper) - centre);
        request += " q" + std::to_string(i + 1) + "_deg=" + std::to_string(degrees(q));
      }
      EXPECT_EQ(ask(request), "ok");
      EXPECT_TRUE(run_until(Mode::kServoing, 1) && run_until(Mode::kHolding, 60));
      run(0.3);
      const Vector3 truth = cabinet->sensor().target(cabinet->clock().now());
      squares += (kinematics::link_pose(chain, *joints.turned(now().positions), 6) * p_L - truth)
                     .squaredNorm();
    }
    return std::sqrt(squares / poses);
  }

  // Asks, and runs until the arm holds again; the record of the candidate, if there is one.
  const SignatureRecord* identified(const std::string& request, double longest_s = 3600) {
    EXPECT_TRUE(enable());
    EXPECT_EQ(ask(request), "ok");
    run_until(Mode::kSweeping, 1);
    EXPECT_TRUE(run_until(Mode::kHolding, longest_s));
    const auto& sequence = cabinet->state().identification();
    return sequence.has_verdict() ? &*sequence.candidate() : nullptr;
  }

  [[nodiscard]] std::string heard(std::string_view words) const {
    const auto found = std::find_if(console.told.rbegin(), console.told.rend(),
                                    [&](const std::string& line) { return line.contains(words); });
    return found == console.told.rend() ? "" : *found;
  }

  static Configuration arc_of_90_degrees() {
    Configuration configuration = test::puma_controller();
    configuration.sweeps.arc_rad = radians(90);
    return configuration;
  }

  Configuration configuration;
  cabinet::World world;
  std::unique_ptr<SelfCalibrationMemory<700, 6>> room =
      std::make_unique<SelfCalibrationMemory<700, 6>>();
  SelfCalibration calibration;
};

inline double value_after(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(" " + key + "=");
  return at == std::string::npos ? std::nan("")
                                 : std::strtod(line.c_str() + at + key.size() + 2, nullptr);
}

// Runs until it has refined for so long.
inline void refine_for(BentPuma& puma, double seconds) {
  const auto& sequence = puma.cabinet->state().identification();
  for (int i = 0; i < 1'000'000 && sequence.stage() != IdentificationSequence::Stage::kRefining;
       ++i) {
    puma.cabinet->step();
  }
  puma.run(seconds);
  ASSERT_EQ(sequence.stage(), IdentificationSequence::Stage::kRefining);
}

}  // namespace armsig::controller
