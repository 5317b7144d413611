// SPDX-License-Identifier: MIT
// The figures of one signature with the number of that signature. They are made from its record
// alone and printed here alone, so that no reply has figures of another signature than it names.
#pragma once

#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/text.hpp"

namespace armsig::controller {

class SignatureFigures {
 public:
  SignatureFigures() = default;  // of no signature
  explicit SignatureFigures(const SignatureRecord& record)
      : number_(record.sequence), air_celsius_(record.air_celsius), accuracy_(record.accuracy) {}

  // ` signature=3`, or ` signature=candidate` before the store has given a number, and what is
  // known of ` predicted_tool_error_mm= predicted_region= validation_rms_mm= validation_poses=`;
  // and ` air_c=`, the air in which it was identified.
  void tell(Line& line) const;

 private:
  std::uint32_t number_ = 0;  // 0: a candidate
  double air_celsius_ = 0;
  ToolAccuracy accuracy_;
};

// ` predicted_tool_error_mm= predicted_region=`, each key with `prefix` before it.
void tell_predicted(Line& line, const ToolAccuracy::Predicted& predicted,
                    std::string_view prefix = {});

}  // namespace armsig::controller
