// SPDX-License-Identifier: MIT
// A file of which one part is sound and the other is not: from some row on the readings or
// positions are in another unit, out of step, of another zero. Found by an arm that is fitted to
// one end.
#pragma once

#include <optional>
#include <string>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

struct BrokenRows {
  std::size_t first_line = 0;
  std::size_t last_line = 0;
  std::string cause;    // "the reading of joint 3 is off by +90.0°"
  std::string undoing;  // "with -90.0° on q3"
  std::string mend;
  double surprise = 0;
  Evidence undone;
};

// What makes the rows of the other end agree with the arm of the sound one. Nothing where neither
// end has an arm near its drawing, where the others agree with it as they are, or where nothing
// that is known makes them.
[[nodiscard]] std::optional<BrokenRows> find_broken_rows(const Evidence& evidence,
                                                         const ArmLimits& limits);

}  // namespace armsig::tool
