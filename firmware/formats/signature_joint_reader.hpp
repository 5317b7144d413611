// SPDX-License-Identifier: MIT
// One entry of the `joints` list of a signature file.
#pragma once

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/formats/yaml_tree.hpp"

namespace armsig::tool {

// Appends the joint in `node` to the signature and to the nominal arm; appends to
// signature.features only where the joint has a sweep.
[[nodiscard]] Read<void> read_signature_joint(const YamlNode& node, SignatureRecord& record);

}  // namespace armsig::tool
