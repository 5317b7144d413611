// SPDX-License-Identifier: MIT
// `send part=N bytes=B hex=...`: a record that comes to the controller in the parts that `fetch`
// tells one in, for `armsig connect ... send`. What is received is a candidate and no more: it has
// to beat the active model on held-out poses before it is accepted.
//
// The image is that of signature_record.hpp with its CRC-32. Of its machine only the drawing
// counts, told as drawing_crc() of what `fetch what=drawing` tells, which has no couplings.
#pragma once

#include "firmware/controller/fetching.hpp"
#include "firmware/controller/machine.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/text.hpp"

namespace armsig::controller {

// drawing_crc() of a drawing as `fetch` tells it: without couplings.
[[nodiscard]] std::uint32_t told_drawing_crc(const Arm& drawing);

class Receiving {
 public:
  // The next part; true if the image is whole then. Part 1 begins anew at any time.
  // Errors: kUnknownRequest (other keys, hex that is none, a value that is no number: to `out`),
  // kCapacityExceeded (a record that is longer than this controller's), kRecordCorrupt (shorter, or
  // a part of another length), kOutOfRange (not the part that comes next).
  [[nodiscard]] Result<bool> take(const Request& request, Line& out);
  // What the image holds; `drawing` is the controller's own. Errors: those of decode();
  // kRecordUnsuitable (without a target on the hand), kRecordOtherMachine (another drawing).
  // Precondition: take() has returned true.
  [[nodiscard]] Result<void> open(const Arm& drawing, SignatureRecord& record) const;

 private:
  RecordImage image_{};
  std::size_t received_ = 0;  // bytes
};

}  // namespace armsig::controller
