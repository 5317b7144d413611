// SPDX-License-Identifier: MIT
// Resets the processor when the program stops asking it not to.
#pragma once

namespace armsig::hal {

class Watchdog {
 public:
  // To be called in every tick. No errors.
  void kick() { do_kick(); }

  // Whether the last reset was the watchdog's. No errors.
  [[nodiscard]] bool caused_reset() const { return do_caused_reset(); }

 protected:
  ~Watchdog() = default;

 private:
  virtual void do_kick() = 0;
  [[nodiscard]] virtual bool do_caused_reset() const = 0;
};

}  // namespace armsig::hal
