// SPDX-License-Identifier: MIT
// The binary image of a signature in non-volatile memory: fixed layout, little-endian.
//
//   offset  bytes
//        0      4  magic "ASIG"
//        4      2  version, 1
//        6      1  joints, n
//        7      1  zero
//        8      4  length of the whole record, CRC included
//       12      4  sequence number: the record with the larger one is the later
//       16      8  per joint: 0 revolute, 1 prismatic; unused ones zero
//       24     64  signature configuration, 8 doubles
//       88    864  link frames X_SL 0 ... 8: R by rows, then p; 12 doubles each
//      952      8  number of the target on the hand, u32; u32: 1 if there is one
//      960     24  its position in the sensor frame at the signature configuration
//      984      8  air temperature, degrees C
//      992      8  RMS error on the held-out poses, m
//     1000      4  CRC-32 of all before
// The S-Model and pseudo-DH parameters are derived from the link frames when it is read.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/error.hpp"
#include "core/signature.hpp"

namespace armsig::controller {

struct SignatureRecord {
  Signature signature;  // without features
  std::uint32_t sequence = 0;
  double air_celsius = 0;
  double held_out_rms_m = 0;
};

inline constexpr std::size_t kRecordBytes = 1004;
using RecordImage = std::array<std::uint8_t, kRecordBytes>;

[[nodiscard]] RecordImage encode(const SignatureRecord& record, std::uint32_t sequence);
[[nodiscard]] inline RecordImage encode(const SignatureRecord& record) {
  return encode(record, record.sequence);
}

// Errors: kRecordCorrupt (magic, version, length, CRC, content), kRecordUnsuitable (joints other
// than those of the drawing).
[[nodiscard]] Result<void> decode(std::span<const std::uint8_t> image, const Arm& drawing,
                                  SignatureRecord& record);

}  // namespace armsig::controller
