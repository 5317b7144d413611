// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/seeds.hpp"

#include <fmt/core.h>

#include "firmware/formats/poses.hpp"
#include "firmware/host_tool/reading/beyond_limits.hpp"

namespace armsig::tool {

Attempt<std::vector<JointVector>> read_seeds(const std::string& path,
                                             const SignatureRecord& record) {
  if (path.empty()) return {};
  ARMSIG_TRY(seeds, read_joint_poses(path, record.signature.types));
  const auto beyond = beyond_limits(record.nominal, seeds);
  if (beyond && beyond->out_of_question) {
    return no_answer({path, 0, 0, fmt::format("row {}: {}", beyond->worst + 1, beyond->words),
                      "readings in the unit that the column's name says"});
  }
  return seeds;
}

}  // namespace armsig::tool
