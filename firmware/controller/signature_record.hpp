// SPDX-License-Identifier: MIT
// The binary image of a signature in non-volatile memory: fixed layout, little-endian.
//
//   offset  bytes
//        0      4  magic "ASIG"
//        4      2  version, 4
//        6      1  joints, n
//        7      1  method of the identification, number of kMethods
//        8      4  length of the whole record, CRC included
//       12      4  sequence number: the record with the larger one is the later
//       16      8  per joint: 0 revolute, 1 prismatic; unused ones zero
//       24     64  signature configuration, 8 doubles
//       88    864  link frames X_SL 0 ... 8: R by rows, then p; 12 doubles each
//      952      8  number of the target on the hand, u32; u32: 1 if there is one
//      960     24  its position in the sensor frame at the signature configuration
//      984      8  air temperature, degrees C
//      992      8  RMS error on the validation poses, m; 0: not validated
//     1000      8  when it was identified, seconds since 1970-01-01 UTC; 0: no clock knew
//     1008      8  predicted RMS error of the tool, 1 sigma, m; 0: not predicted
//     1016      4  CRC-32 of the drawing
//     1020      2  region of the predicted error, number of kPredictedRegions
//     1022      2  validation poses
//     1024    384  the machine: per joint, 48 bytes, those of unused joints zero:
//                    vendor, product, revision and serial number of the drive, u32 each; 0: untold
//                    encoder counts a revolution, gear ratio, lead in m; doubles
//                    counts at the zero of the joint, i32; u32: 1 where the sense is reversed
//     1408      4  1 where there are joint error maps and gravity; 0: all from here is zero
//     1412      4  gravity terms
//     1416   2176  per joint, 272 bytes, those of unused joints zero:
//                    reading of knot 0, knots per rad or m, step in rad or m, zero of the drawing;
//                    doubles
//                    the map at 120 knots, in steps, i16
//     3592    336  28 gravity terms: joint from 0, origin, u8 each; zero, u16; rad or m per m,
//                    double
//     3928     24  the direction against gravity in frame 0 of the drawing
//     3952      4  CRC-32 of all before
// The S-Model and pseudo-DH parameters are derived from the link frames when it is read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/tool_accuracy.hpp"
#include "core/calibration/packed_deflections.hpp"
#include "core/signature.hpp"
#include "firmware/controller/machine.hpp"
#include "firmware/controller/persons.hpp"

namespace armsig::controller {

// How the parameters were identified.
enum class Method : std::uint8_t { kEncoder, kPaper, kRefined, kExact };
inline constexpr std::array<std::string_view, 4> kMethods{"encoder", "paper", "refined", "exact"};

struct SignatureRecord {
  Signature signature;  // without features
  Method method = Method::kEncoder;
  std::uint32_t sequence = 0;
  double air_celsius = 0;
  std::int64_t identified_at_s = 0;  // since 1970-01-01 UTC; 0: no clock knew
  ToolAccuracy accuracy;
  Machine machine;                             // that it was identified on
  calibration::PackedDeflections deflections;  // none: its geometry says everything
#ifndef ARMSIG_SMALL_IMAGE
  Persons persons;  // stored behind it
#endif
};

// On the validation poses; 0: not validated.
[[nodiscard]] inline double validation_rms_m(const SignatureRecord& record) {
  return record.accuracy.validated ? record.accuracy.validated->rms_m : 0;
}

inline constexpr std::size_t kRecordBytes = 3956;
using RecordImage = std::array<std::uint8_t, kRecordBytes>;

[[nodiscard]] RecordImage encode(const SignatureRecord& record);
void encode(const SignatureRecord& record, std::uint32_t sequence, RecordImage& image);
// The image from byte `begin` on, as much of it as `part` has room for.
void encode_part(const SignatureRecord& record, std::size_t begin, std::span<std::uint8_t> part);

// A record ends with the CRC-32 of what comes before it. Of an image that is of no record's length:
// 0, and it is not whole.
[[nodiscard]] std::uint32_t crc_of(const RecordImage& image);
[[nodiscard]] bool is_whole(const RecordImage& image);

// Errors: kRecordCorrupt (magic, version, length, CRC, content, a map or gravity by which a reading
// could jump: calibration::check()), kRecordUnsuitable (joints other than those of the drawing).
[[nodiscard]] Result<void> decode(const RecordImage& image, const Arm& drawing,
                                  SignatureRecord& record);

}  // namespace armsig::controller
