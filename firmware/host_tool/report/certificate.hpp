// SPDX-License-Identifier: MIT
// The calibration certificate of a report, by clause 7.8 of ISO/IEC 17025 (docs/certificate.md):
// who measured what with what and where, before and after adjustment, how uncertain the tool is by
// which source, and what was not measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host_tool/report/pose_residuals.hpp"
#include "firmware/host_tool/report/sweep_picture.hpp"
#include "firmware/host_tool/report/tool_error_map.hpp"

namespace armsig::tool {

// What the files do not carry; empty: left for the pen.
struct CertificateNames {
  std::string serial;  // of the arm, where the signature has none
  std::string number;  // of the certificate; empty: made from the signature's CRC-32
  std::string laboratory;
  std::string customer;
  std::string place;
  std::string measured_on;
  std::string conditions;
  std::string operator_name;
  std::string instrument;
  std::string instrument_serial;
  std::string instrument_certificate;  // number and date of the instrument's own

  // Nothing is stated of who measured, where, and with what.
  [[nodiscard]] bool empty() const {
    return (number + laboratory + customer + place + measured_on + conditions + operator_name +
            instrument + instrument_serial + instrument_certificate)
        .empty();
  }
};

// The tool's error with one set of parameters.
struct AdjustmentLine {
  std::string parameters;
  std::string basis;             // which poses, how known
  std::optional<double> mean_m;  // of the lengths, where known
  double rms_m = 0;
  std::optional<double> largest_m;  // where known
};
// As found, with the nominal parameters, and adjusted, with those of the signature; either only
// where it is known.
[[nodiscard]] std::vector<AdjustmentLine> before_and_after(
    const SignatureRecord& record, const std::optional<ToolErrorMap>& map,
    const std::optional<PoseResiduals>& poses);

// The combined standard uncertainty of the tool's position, expanded to a stated probability.
struct ExpandedUncertainty {
  double length_m = 0;  // no longer is the error, with `probability`, over the same poses
  double probability = 0;
  double factor = 0;            // of the standard uncertainty of the length
  double factor_per_axis = 0;   // of that of one axis, were all three alike
  double probability_at_2 = 0;  // what twice the standard uncertainty of one axis would have
  double freedom = 0;           // degrees that the noise was found with; 0: it was stated
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
  std::optional<ExpandedUncertainty> expanded;
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
