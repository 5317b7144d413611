// SPDX-License-Identifier: MIT
// The page of a report that a person signs: who measured what with what, how uncertain the tool is
// by which source, and what was not measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/report/sweep_picture.hpp"
#include "firmware/host_tool/report/tool_error_map.hpp"

namespace armsig::tool {

// What the files do not carry; empty: left for the pen.
struct CertificateNames {
  std::string serial;  // of the arm, where the signature has none
  std::string operator_name;
  std::string instrument;
  std::string instrument_serial;

  // Nobody is named who measured, and nothing that it was measured with.
  [[nodiscard]] bool empty() const {
    return operator_name.empty() && instrument.empty() && instrument_serial.empty();
  }
};

// One line of the budget: a standard uncertainty of the tool's position (GUM, JCGM 100:2008, 4.2:
// type A, found from the scatter), all three directions together, root mean square over the poses.
struct UncertaintySource {
  std::string source;
  std::string basis;              // how it is known
  std::optional<double> sigma_m;  // nothing: it was not measured
};

struct UncertaintyBudget {
  std::vector<UncertaintySource> sources;
  std::optional<double> combined_m;  // root of the sum of squares of those that are known
};

[[nodiscard]] UncertaintyBudget uncertainty_budget(const SignatureRecord& record,
                                                   const std::optional<ToolErrorMap>& map);

// In the words of ISO 9283, as far as the data support them.
[[nodiscard]] std::vector<std::string> accuracy_in_words(const SignatureRecord& record);
// `mixed_reach`: of every joint's reading over poses outside the sweeps, empty without such.
[[nodiscard]] std::vector<std::string> not_measured(
    const SignatureRecord& record, const std::vector<SweepPicture>& sweeps,
    const FixedVector<JointLimits, kMaxJoints>& mixed_reach);

}  // namespace armsig::tool
