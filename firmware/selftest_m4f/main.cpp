// SPDX-License-Identifier: MIT
// The core on a Cortex-M4F, whose FPU has single precision: what runs once (the pipeline) in
// software doubles, what runs in the tick in floats.
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/known_answers.hpp"

extern "C" int armsig_main() {
  armsig::selftest::Report report;
  report.arms(armsig::selftest::kArms.size(), armsig::selftest::kOriginOfArms);
  armsig::selftest::start_counter();
  armsig::selftest::check_pipeline(report);
  armsig::selftest::check_kinematics(report);
  armsig::selftest::check_single_precision(report);
  armsig::selftest::count_single(report);
  report.stack();
  return report.passed() ? 0 : 1;
}
