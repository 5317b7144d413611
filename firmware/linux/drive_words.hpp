// SPDX-License-Identifier: MIT
// What the objects of a drive are, what a drive costs that lacks one, and what the set-up would
// make of what was read of it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/drive_scan.hpp"
#include "hal/cia402/setup_run.hpp"

namespace armsig::daemon {

struct ObjectWords {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::string_view what;
  std::string_view cost;  // of a drive that lacks it, or has it otherwise than wanted; may be empty
};

[[nodiscard]] std::span<const ObjectWords> object_words();

// The set-up of a drive, with every write taken to be accepted: the rules are the set-up's own.
struct Rehearsal {
  std::optional<cia402::SetupRefusal> refusal;
  cia402::SetupReport report;
  std::map<ObjectKey, std::uint32_t> writes;
};
[[nodiscard]] Rehearsal rehearse(const NodeReading& reading,
                                 const canopen::CheckedConfiguration& configuration);

// Whether every joint has one drive that would be set up.
[[nodiscard]] bool all_would_be_set_up(const std::vector<NodeReading>& nodes,
                                       const canopen::CheckedConfiguration& configuration);

// For a terminal of 100 columns.
[[nodiscard]] std::string drives_in_words(const DriveScan& scan,
                                          const canopen::CheckedConfiguration& configuration);
// For programs, of all buses.
[[nodiscard]] std::string drives_as_json(std::span<const DriveScan> scans,
                                         const canopen::CheckedConfiguration& configuration);
[[nodiscard]] inline std::string drives_as_json(
    const DriveScan& scan, const canopen::CheckedConfiguration& configuration) {
  return drives_as_json({&scan, 1}, configuration);
}

}  // namespace armsig::daemon
