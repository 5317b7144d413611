// SPDX-License-Identifier: MIT
// Who a drive is: the identity object 1018h of CiA 301, read while the drive is set up.
#pragma once

#include "hal/canopen/configuration.hpp"
#include "hal/cia402/setup.hpp"
#include "hal/drive_identity.hpp"

namespace armsig::canopen {

// Adds the requests for vendor, product, revision and serial number; a drive may lack all but the
// first, and says then nothing of them.
void append_identity_requests(cia402::Setup& setup);

// How the axis counts, by its configuration; its drive has not told anything yet.
[[nodiscard]] hal::DriveIdentity identity_of(const AxisConfiguration& axis);

// Takes what `outcome` of `request` says of the drive, if it is one of those requests.
void take_identity(const cia402::ObjectRequest& request, const cia402::ObjectOutcome& outcome,
                   hal::DriveIdentity& identity);

}  // namespace armsig::canopen
