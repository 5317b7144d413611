// SPDX-License-Identifier: MIT
// armsig connect CONSOLE send FILE: a signature file to the controller, as a candidate.
#pragma once

#include "firmware/controller/signature_record.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/commands/fetch.hpp"

namespace armsig::tool {

// The controller's record of what a file holds. `drawing` is the controller's own, as it tells it.
// Refuses a signature of another arm or drawing, one without a target on the hand, and one with
// what the record has no room for: corrections of the readings, maps, gravity.
[[nodiscard]] Read<controller::SignatureRecord> controller_record(const SignatureRecord& file,
                                                                  const Arm& drawing,
                                                                  const std::string& path);

// Sends the file; its exit status. `--what`, `--name` and `--serial` are of no meaning.
[[nodiscard]] int send(ConsoleClient& console, const FetchOptions& options);

}  // namespace armsig::tool
