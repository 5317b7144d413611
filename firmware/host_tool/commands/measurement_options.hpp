// SPDX-License-Identifier: MIT
// The options of every command that takes measurements.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "firmware/host_tool/reading/read_rows.hpp"

namespace armsig::tool {

// --measurements, --columns and --sensor. `of`: what the measurements are, for --help. Returns
// --measurements, which the other two need.
CLI::Option* add_measurement_options(CLI::App& command, RowSource& source, const std::string& of);

}  // namespace armsig::tool
