// SPDX-License-Identifier: MIT
// Rows that a fit throws out are evidence as well: a sensor's blunders are few and scattered.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "firmware/host_tool/diagnosis/gate.hpp"

namespace armsig::tool {

struct RejectedRows {
  std::size_t free_poses = 0;  // rows with sweep 0
  std::size_t free_rejected = 0;
  // The longest run of rejected rows that follow each other in the file.
  std::size_t run = 0;
  std::size_t first_line = 0;
  std::size_t last_line = 0;
};
// `lines`: those rejected, in rising order.
[[nodiscard]] RejectedRows rejected_rows(const Evidence& evidence,
                                         const std::vector<std::size_t>& lines);

// "25 of the 60 free poses (42 %) would be thrown out as outliers", where that is a tenth of them
// or more, or where five rows follow each other. Nothing of ranges: a receiver may be to blame.
[[nodiscard]] std::optional<Doubt> doubt_of_rejected(const Evidence& evidence,
                                                     const std::vector<std::size_t>& lines);

}  // namespace armsig::tool
