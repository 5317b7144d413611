// SPDX-License-Identifier: MIT
// The core on a Cortex-M7, in double precision.
#include "firmware/selftest/checks.hpp"

extern "C" int armsig_main() {
  armsig::selftest::Report report;
  armsig::selftest::start_counter();
  armsig::selftest::check_pipeline(report);
  armsig::selftest::check_kinematics(report);
  armsig::selftest::count_double(report);
  report.stack();
  return report.passed() ? 0 : 1;
}
