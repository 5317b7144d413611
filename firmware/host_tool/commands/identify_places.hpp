// SPDX-License-Identifier: MIT
// armsig identify --instrument: touches of sockets and planes and readings of wires to a signature.
#pragma once

#include "firmware/host_tool/commands/identify.hpp"

namespace armsig::tool {

// Reads, identifies, writes the signature and says what was found.
[[nodiscard]] Attempt<ExitStatus> identify_by_places(const IdentifyOptions& options);

}  // namespace armsig::tool
