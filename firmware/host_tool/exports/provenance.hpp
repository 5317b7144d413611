// SPDX-License-Identifier: MIT
// What every export says about itself, and what several formats can't hold.
#pragma once

#include <string>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// Two lines of text: arm, serial number, method, time, version; what is not printable escaped.
[[nodiscard]] std::string provenance(const SignatureRecord& record);

// "x_m=...,y_m=...,z_m=...,qw=...,qx=...,qy=...,qz=..."
[[nodiscard]] std::string pose_words(const Pose& X);

// A comment of XML, <!-- ... -->: two hyphens in a row, which it may not hold, become one.
[[nodiscard]] std::string xml_comment(std::string text);

// One line a coupling: "effective reading of joint 3 = reading 3 + 1 * reading 2".
[[nodiscard]] std::string coupling_lines(const Arm& arm);

// The same problem, named after the format.
[[nodiscard]] std::unexpected<Problem> cannot_hold(std::string_view format, std::string what,
                                                   std::string expected);

// Refuses an arm without exactly six revolute joints.
[[nodiscard]] Read<void> need_six_revolute(std::string_view format, const Signature& signature);

}  // namespace armsig::tool
