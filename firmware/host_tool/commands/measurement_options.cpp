// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/measurement_options.hpp"

namespace armsig::tool {

CLI::Option* add_measurement_options(CLI::App& command, RowSource& source, const std::string& of) {
  CLI::Option* measurements = command.add_option("--measurements", source.measurements, of);
  command
      .add_option("--columns", source.columns,
                  "measurements of other software: auto, or x_mm=THEIR NAME,target=#1,... "
                  "(semicolons, decimal commas and lines before the header are understood)")
      ->needs(measurements);
  command
      .add_option("--sensor", source.sensor,
                  "sensor description (YAML), where the rows are ranges to receivers")
      ->needs(measurements);
  return measurements;
}

}  // namespace armsig::tool
