// SPDX-License-Identifier: MIT
// The controller of one arm: a servo tick, and a background that never holds it up.
//
//   for (hal::Instant next = clock.now();; next += period) {   // a thread of high priority
//     controller.tick(clock.wait_until(next));
//   }
//   for (;;) {                                                  // another, or after each tick
//     while (controller.background() && some of the period is left);
//   }
//
// The two share nothing but the mailboxes between them, so that they may run in two threads or one
// after the other. Starts with the drives disabled; only an operator's `enable` changes that.
#pragma once

#include <span>

#include "firmware/controller/background.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/coupled_drives.hpp"
#include "firmware/controller/link.hpp"
#include "firmware/controller/servo.hpp"
#include "hal/clock.hpp"
#include "hal/console.hpp"
#include "hal/joint_drives.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

class Controller {
 public:
  // Everything referred to must outlive the controller; `consoles` are at most kMaxConsoles.
  // `refinement`, where there is memory for one, is of the same configuration; `checks`, where
  // there is a place for it, keeps what checks have shown.
  // Preconditions: check(configuration); as many drives as joints. Large: keep it out of stacks.
  Controller(const Configuration& configuration, hal::JointDrives& drives, Instrument instrument,
             hal::Clock& clock, hal::NonvolatileMemory& memory,
             std::span<hal::Console* const> consoles, Refinement* refinement = nullptr,
             CheckMemory* checks = nullptr)
      : configuration_(configuration),
        drives_(configuration_.drawing.couplings, drives),
        servo_(configuration_, drives_, clock, link_),
        background_(configuration_, instrument, clock, memory, consoles, link_, refinement,
                    checks) {}
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  // Shows every tick to `observer`, which outlives the controller; to be called before the first.
  void observe(TickObserver& observer) { link_.observer = &observer; }

  // One tick: read drives, supervise, mode step, command drives, publish. `lateness` is what
  // Clock::wait_until() returned. Never blocks.
  void tick(hal::Duration lateness) { servo_.tick(lateness); }

  // One bounded step of everything else: sensor, console, sequences, store. True if the next one
  // has something to compute, false if it would but look for something new.
  bool background() { return background_.step(); }

  // After the last tick, where there is one: keeps where the arm is, if no drive has torque.
  void finish() { background_.finish(drives_); }

  // For the thread of the background.
  [[nodiscard]] const Background& state() const { return background_; }

 private:
  Configuration configuration_;
  Link link_;
  CoupledDrives drives_;
  Servo servo_;
  Background background_;
};

}  // namespace armsig::controller
