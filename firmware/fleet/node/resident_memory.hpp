// SPDX-License-Identifier: MIT
// What the process holds of the machine's memory.
#pragma once

namespace armsig::fleet {

// Gives back what only the start and a handshake of TLS needed: free heap, and pages of code, which
// come back from their files where they are needed again. Data and their addresses stay.
void let_go_of_start();

}  // namespace armsig::fleet
