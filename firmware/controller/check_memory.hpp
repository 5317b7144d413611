// SPDX-License-Identifier: MIT
// What a program may give its controller, where there is a place for it: keeps what the checks have
// shown, so that a restart does not make them learn anew (check_keeper.hpp).
#pragma once

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/check_history.hpp"
#include "firmware/controller/configuration.hpp"

namespace armsig::controller {

class CheckMemory {
 public:
  // What the checks are of, and who is told.
  struct Context {
    const Configuration& configuration;
    const Announcer& announcer;
    std::uint32_t record_crc;  // of the active signature, as it is stored
  };
  // Fills `state`, which is of the active signature and new, with what was kept of it.
  void recall(const Context& context, CheckState& state) { do_recall(context, state); }
  // A check was taken.
  void keep(const Context& context, const CheckState& state) { do_keep(context, state); }

 protected:
  ~CheckMemory() = default;

 private:
  virtual void do_recall(const Context& context, CheckState& state) = 0;
  virtual void do_keep(const Context& context, const CheckState& state) = 0;
};

}  // namespace armsig::controller
