// SPDX-License-Identifier: MIT
// Joint readings near which a solution is wanted, of a file that a user names.
#pragma once

#include <string>
#include <vector>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/commands/command.hpp"

namespace armsig::tool {

// Those of `path`; none where it is empty. Errors: those of read_joint_poses(); readings that no
// joint of the arm has, with their row.
[[nodiscard]] Attempt<std::vector<JointVector>> read_seeds(const std::string& path,
                                                           const SignatureRecord& record);

}  // namespace armsig::tool
