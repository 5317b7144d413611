// SPDX-License-Identifier: MIT
// The file of a KinsModel: a line a thing, words apart by spaces, `#` begins a comment line.
//
//   armsig linuxcnc-kins/1
//   joint revolute THETA_RAD D_M A_M ALPHA_RAD LOWER UPPER         1 to 8, base to tip; none
//   instead
//                                                                  of both: it turns without end
//   coupling JOINT FROM RATIO                                      joints counted from 1
//   tip X_M Y_M Z_M QW QX QY QZ
//   tool NUMBER X_M Y_M Z_M
//   drawn THETA_RAD D_M A_M ALPHA_RAD                              with maps: one a joint
//   configuration Q...                                             with maps
//   map JOINT ORIGIN KNOTS_PER_LENGTH STEP K1 ... K120             with maps: one a joint
//   gravity JOINT ORIGIN COEFFICIENT
//   crc32 0xHHHHHHHH                                               of all bytes before this line
//
// Read where there is neither heap nor exception; whatever the bytes are, it is refused or safe.
#pragma once

#include <cstddef>
#include <expected>
#include <string_view>

#include "firmware/linuxcnc/kins_model.hpp"

namespace armsig::linuxcnc {

inline constexpr std::string_view kKinsTag = "linuxcnc-kins/1";
inline constexpr std::size_t kLargestKinsFile = std::size_t{64} * 1024;

struct KinsRefusal {
  std::size_t line = 0;  // 0: the file as a whole
  std::string_view what;
};

// The model, which meets every precondition of kinematics::make_chain() and
// calibration::ServoReadings; or the first line that is not as it must be.
[[nodiscard]] std::expected<KinsModel, KinsRefusal> parse_kins(std::string_view text);

// The same of a file. Refused where it cannot be read or is larger than kLargestKinsFile.
[[nodiscard]] std::expected<KinsModel, KinsRefusal> read_kins(const char* path);

}  // namespace armsig::linuxcnc
