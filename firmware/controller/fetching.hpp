// SPDX-License-Identifier: MIT
// `fetch what=signature|candidate|nominal part=N`: a record of the controller in parts that fit a
// line, for `armsig connect ... fetch`.
#pragma once

#include "core/base/arm.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/text.hpp"

namespace armsig::controller {

inline constexpr std::size_t kPartBytes = 192;  // of the image; twice as many characters

// The image of a drawing: joints n (u32), zero (u32); per joint, of kMaxJoints, type (0 revolute, 1
// prismatic), theta, d, a, alpha, lower and upper limit as doubles in SI, those of unused joints
// zero; the direction against gravity in frame 0; CRC-32 (u32) of all before. Couplings are not in
// it: every reading that the controller tells is that of the joint.
inline constexpr std::size_t kDrawingBytes = 8 + (kMaxJoints * 7 + 3) * 8 + 4;
using DrawingImage = std::array<std::uint8_t, kDrawingBytes>;

[[nodiscard]] DrawingImage encode_drawing(const Arm& drawing);
// Errors: kRecordCorrupt.
[[nodiscard]] Result<Arm> decode_drawing(const DrawingImage& image);

// What may be fetched; null: there is none.
struct Fetchable {
  const SignatureRecord* signature = nullptr;
  const SignatureRecord* candidate = nullptr;
  const Arm* drawing = nullptr;
};

// Adds ` bytes=B parts=P hex=...` to `out`. Errors: kUnknownRequest (other keys than what and part,
// or another thing), kOutOfRange (no such part, from 1), kNoSignature, kNoCandidate, kUnsupported
// (a signature with maps of readings, of an arm whose joints are coupled).
[[nodiscard]] Result<void> tell_part(const Request& request, const Fetchable& fetchable, Line& out);

}  // namespace armsig::controller
