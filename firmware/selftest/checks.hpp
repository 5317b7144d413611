// SPDX-License-Identifier: MIT
// The self-tests that a target runs.
#pragma once

#include "firmware/selftest/report.hpp"

namespace armsig::selftest {

// Sweeps -> features -> signature -> predicted positions of poses it was not fitted to.
void check_pipeline(Report& report);
// Forward and inverse kinematics in double precision, on every arm.
void check_kinematics(Report& report);
// Positions by the S-Model chain in single precision, on every arm: against the known answers, and
// against the chain in double precision.
void check_single_precision(Report& report);

// RLS update, forward, with Jacobian, warm inverse; in double precision.
void count_double(Report& report);
// RLS update and forward in single precision.
void count_single(Report& report);

}  // namespace armsig::selftest
