// SPDX-License-Identifier: MIT
// A signature in the formats of other software. Each function gives the text of the file, or why
// the format can't hold this arm.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/exports/carried.hpp"

namespace armsig::tool {

// The largest distance from `armsig predict` that an export may have anywhere in the work volume.
inline constexpr double kExportTolerance_m = 1e-9;

// Robot description of ROS, from the axes: root link `sensor`, then `base_link`, a link a
// joint, `last_link` (the frame that predict answers for) and a link a target. A coupled joint gets
// a mimic joint about the same axis before it.
[[nodiscard]] Read<std::string> urdf_text(const SignatureRecord& record);

// Calibrated kinematics of the Universal Robots drivers, from the axes. Refuses an arm whose axes
// are not those of a known arm of theirs, within 30 mm and 0.05 rad.
[[nodiscard]] Read<std::string> ur_yaml_text(const SignatureRecord& record);

// Pseudo Denavit-Hartenberg rows, standard (distal) or modified (Craig).
[[nodiscard]] Read<std::string> dh_csv_text(const SignatureRecord& record);
[[nodiscard]] Read<std::string> mdh_csv_text(const SignatureRecord& record);

// HAL settings of LinuxCNC's genserkins: modified rows, mm; the joint offsets, which genserkins
// lacks, as `offset` components. Six revolute joints; couplings by `unrotate` where they are whole
// numbers from the joint before.
[[nodiscard]] Read<std::string> linuxcnc_text(const SignatureRecord& record);

// The model that armsigkins, the kinematics module for LinuxCNC (firmware/linuxcnc), reads: any
// arm, with gravity and maps.
[[nodiscard]] Read<std::string> linuxcnc_kins_text(const SignatureRecord& record);

// A further file of an export, beside the one that was asked for.
struct Companion {
  std::string suffix;  // of its name, after that of the file asked for
  std::string text;
};

// The joint error maps as LinuxCNC's compensation tables, one a joint: lines of nominal,
// forward and reverse position in degrees of the joint of genserkins (COMP_FILE_TYPE 0). None of a
// record without maps. Precondition: linuxcnc_text() holds this arm.
[[nodiscard]] std::vector<Companion> linuxcnc_tables(const SignatureRecord& record);

// Source for the Robotics Toolbox for Python: a DHRobot called `robot`.
[[nodiscard]] Read<std::string> rtb_text(const SignatureRecord& record);

// Everything as JSON: axes, rows, base, last link, joint frames, targets, gravity, maps.
[[nodiscard]] Read<std::string> json_text(const SignatureRecord& record);

// Gravity and the joint error maps as a table.
[[nodiscard]] Read<std::string> maps_csv_text(const SignatureRecord& record);

// Names of the formats, in the order of the documentation.
[[nodiscard]] std::vector<std::string> export_formats();

struct Exported {
  std::string text;
  std::vector<Companion> companions;
  // What gravity and maps that the format cannot carry are worth at the tool, RMS and at most over
  // the readings measured; 0: nothing is lost.
  double lost_rms_m = 0;
  double lost_largest_m = 0;
};

// What an export to `format` starts from: the record with its geometry fitted anew where the format
// carries no more. Refuses corrections of the readings, which no format holds.
[[nodiscard]] Read<Carried> exportable(std::string_view format, Carries carries,
                                       const SignatureRecord& record);

// The signature in the format of that name, its geometry fitted anew where the format cannot carry
// gravity and maps. Refuses what exportable() refuses.
// Precondition: one of export_formats().
[[nodiscard]] Read<Exported> export_text(const std::string& format, const SignatureRecord& record);

}  // namespace armsig::tool
