// SPDX-License-Identifier: MIT
// A console that answers `emulate` itself: faults of the emulated world, for those who rehearse.
// Everything else is the controller's, which knows nothing of it.
#pragma once

#include "firmware/controller/text.hpp"
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"
#include "hal/console.hpp"

namespace armsig::cabinet {

// Does what an `emulate` asks for, all of it or nothing; what is refused goes to `out` as `
// why="..."`:
//   emulate joint=2 fault=blocked        a fault of its drive: the names of
//   simulated::drive_fault() emulate joint=2 fault=emergency code=9040 emulate joint=2 push_deg=3
//   somebody leans on it (push_mm of a slide) emulate sensor=silent                or stale, crc,
//   unit, exception, short, unplugged; none emulate air_c=31.5 dropout=0.3 multipath=0.1
//   sigma_mm=0.4 emulate can=down                     or up, or off: bus-off;
//   can2 of a second bus
// Errors: kUnknownRequest, kOutOfRange.
//   emulate place=A1                     leads the arm without torque into that socket; with
//   slip_mm=3, beside its seat. It is done when VirtualCabinet::hand() no longer leads.
// Errors of that besides: kWrongMode (the arm has torque, or is being led), kOutOfReach.
Result<void> emulate(VirtualCabinet& cabinet, const controller::Request& request,
                     controller::Line& out);

class EmulationConsole final : public hal::Console {
 public:
  // `inner` must outlive it.
  explicit EmulationConsole(hal::Console& inner) : inner_(&inner) {}

  // From now on; before, and without it, `emulate` is refused. `cabinet` must outlive the console,
  // and be stepped by the thread that reads it.
  void attend(VirtualCabinet& cabinet) { cabinet_ = &cabinet; }

 private:
  std::optional<hal::ConsoleLine> do_read_line() override;
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override;
  void do_broadcast(std::string_view text) override { inner_->broadcast(text); }

  void help(hal::ConsoleClient client);
  void answer(hal::ConsoleClient client, const controller::Request& request);
  void reply(hal::ConsoleClient client, const Result<void>& done, const controller::Line& details);

  hal::Console* inner_;
  void watch_hand();

  VirtualCabinet* cabinet_ = nullptr;
  std::optional<hal::ConsoleClient> led_for_;  // who is answered when the ball sits
};

}  // namespace armsig::cabinet
