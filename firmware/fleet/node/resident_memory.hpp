// SPDX-License-Identifier: MIT
// What the process holds of the machine's memory.
#pragma once

namespace armsig::fleet {

// Gives back what only the steps of the start needed: free heap, and the pages of code and
// constants that came from files, which come back from there where they are needed again. Between
// two steps it keeps the second from standing on what the first has read: the linking of the
// libraries, the configuration, OpenSSL, a handshake.
void let_go_of_start();

}  // namespace armsig::fleet
