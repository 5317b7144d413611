// SPDX-License-Identifier: MIT
#include "firmware/host_tool/estimate.hpp"

namespace armsig::tool {

Read<std::unique_ptr<refinement::Refined>> estimate_of(const SignatureRecord& record,
                                                       const std::string& file) {
  if (!record.covariance) {
    return std::unexpected(Problem{file, 0, 0, "the signature has no covariance",
                                   "one identified with --method refined"});
  }
  auto estimate = estimate_from(record.signature, record.nominal, *record.covariance);
  if (!estimate) {
    return std::unexpected(
        Problem{file, 0, 0, "the covariance is not that of the axes and targets of the signature",
                "one identified with --method refined"});
  }
  estimate->quality.sigma_m = record.sigma_m.value_or(0);
  return estimate;
}

}  // namespace armsig::tool
