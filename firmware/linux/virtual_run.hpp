// SPDX-License-Identifier: MIT
// armsigd --virtual: the same controller about an emulated arm, at a desk.
#pragma once

#include <csignal>
#include <cstdint>
#include <optional>

#include "core/base/arm.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/virtual_cabinet/bent_arm.hpp"

namespace armsig::daemon {

struct VirtualOptions {
  std::optional<Arm> truth;  // the arm as it was built; none: drawn from the usual tolerances
  std::uint64_t seed = 1;    // of those, and of the sensor's noise
  double speed = 1;          // times real time; 0: as fast as it goes
  cabinet::Bends bends;      // what the arm has beside its geometry, drawn by the seed
  double warm_kelvin = 0;    // by which it warms up after power-up, as steel
  bool ideal = false;        // drives without gravity, coasting, play and delays
  // By the threads of a real cabinet, whose ticks come as late as this computer lets them;
  // otherwise in virtual time, the same on every run.
  bool real_time = false;
};

// Runs the virtual cabinet of `configuration` until `stop` is set; the arm stands under its
// sensor as the configuration says, else by its reach (simulated::base_pose()). Console and store
// are real. Returns the exit status of the process.
[[nodiscard]] int run_virtual(const DaemonConfiguration& configuration,
                              const VirtualOptions& options,
                              const volatile std::sig_atomic_t& stop);

}  // namespace armsig::daemon
