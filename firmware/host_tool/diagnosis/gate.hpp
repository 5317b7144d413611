// SPDX-License-Identifier: MIT
// Is this the arm of the drawing, and do its measurements agree with each other? One judgement for
// every method of identification, and for measurements that none of them takes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

// What a method of identification has found.
struct FoundArm {
  // Where it puts the target of a row, in the sensor frame; nothing for a target that it lacks.
  std::function<std::optional<Vector3>(const EvidenceRow&)> predicted_S;
  double predicted_error_m = 0;  // RMS that it states, 0 where it states none
  bool rejects_many = false;     // rows, so that their misfit asks for a cause
};

struct Doubt {
  std::string what;  // "no arm near its nominal model explains the rows: the nearest misses by ..."
  std::string cause;  // "the positions are in metres: times 1000 they fit within 0.1 mm"; or none
  std::string expected;  // what to change
  bool refuses = true;   // or is only worth saying
  // How likely it is so, and then how far the tool is off at work_configuration()s 1 to
  // kJudgedConfigurations; or, where it is one factor on all lengths that were seen, by which:
  // nobody knows whether the sensor errs by it or the drawing.
  double probability = 0;
  std::vector<Vector3> tool_off_m = {};
  double lengths_factor = 1;
};

// Nothing where the arm is believable. With `found` absent (identification was refused) a cause is
// looked for in any case, and what is returned may hold none.
[[nodiscard]] std::optional<Doubt> doubt(const Evidence& evidence, const ArmLimits& limits,
                                         const std::optional<FoundArm>& found);

}  // namespace armsig::tool
