// SPDX-License-Identifier: MIT
// Gravity and the joint error maps in a signature file.
#pragma once

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {

// The section `deflections`; empty where the record has none.
[[nodiscard]] std::string deflections_text(const SignatureRecord& record);

// Reads it, where it is there, once the joints of the record are known. A map or a lever by which a
// reading could jump is refused.
[[nodiscard]] Read<void> read_deflections(const YamlMap& root, SignatureRecord& record);

}  // namespace armsig::tool
