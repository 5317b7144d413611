// SPDX-License-Identifier: MIT
// The binary image of what checks have shown: fixed layout, little-endian.
//
//   offset  bytes
//        0      4  magic "ACHK"
//        4      2  version, 1
//        6      2  length of the whole image, CRC included
//        8      4  CRC-32 at the end of the signature's record
//       12      4  CRC-32 of the readings of all poses of the plan
//       16      4  sequence number of the record
//       20      8  when the signature was identified, seconds since 1970-01-01 UTC
//       28      4  checks that the reference is made of
//       32     24  Crosier's sum, 3 doubles, in sigma of a check
//       56      4  checks summed
//       60      4  of them, since the sum was last zero
//       64      4  1 where it was above the threshold
//       68    256  reference: per pose of 16, the sum of its residuals in m, 3 floats; their count,
//                  u16; zero, u16
//      324    256  since the sum was last zero: the same, less the reference
//      580      4  means that follow
//      584    240  means of the last checks in m, 20 of 3 floats; unused ones zero
//      824      4  CRC-32 of all before
#pragma once

#include <array>

#include "firmware/controller/check_keeper.hpp"

namespace armsig::controller {

inline constexpr std::size_t kCheckImageBytes = 828;
using CheckImage = std::array<std::uint8_t, kCheckImageBytes>;

[[nodiscard]] CheckImage encode(const CheckSubject& subject, const CheckState& state);

// As CheckKeeper::read(), of an image. Errors: kRecordCorrupt.
[[nodiscard]] Result<Recalled> decode(const CheckImage& image, const CheckSubject& subject,
                                      CheckState& state);

}  // namespace armsig::controller
