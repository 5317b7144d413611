// SPDX-License-Identifier: MIT
// Expedited SDO transfers (CiA 301, 7.2.4.3): up to four bytes, one request at a time per device.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "hal/can_bus.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/cia402/object.hpp"

namespace armsig::canopen {

using SdoRequest = cia402::ObjectRequest;
using SdoFailure = cia402::ObjectFailure;
using SdoOutcome = cia402::ObjectOutcome;

// A short English phrase for an SDO abort code.
[[nodiscard]] std::string_view describe_sdo_abort(std::uint32_t code);

// The request frame to `node`.
[[nodiscard]] hal::CanFrame encode_sdo(NodeId node, const SdoRequest& request);

// What `frame` answers to `request`; empty if it answers something else, which is then none of this
// request's business. A segmented upload is refused as kSdoAborted: no object of the set-up needs
// more than four bytes.
[[nodiscard]] std::optional<SdoOutcome> decode_sdo(const hal::CanFrame& frame,
                                                   const SdoRequest& request);

// One transfer with bounded retries.
class SdoTransfer {
 public:
  SdoTransfer(NodeId node, const SdoRequest& request, hal::Duration timeout, unsigned attempts)
      : node_(node), request_(request), timeout_(timeout), attempts_left_(attempts) {}

  // Takes a frame with the identifier of this node's SDO responses.
  void take(const hal::CanFrame& frame);

  // The frame to send now, at the start and whenever the time for an answer is over.
  [[nodiscard]] std::optional<hal::CanFrame> poll(hal::Instant now);

  // A request was sent already, so that the next one repeats it.
  [[nodiscard]] bool was_sent() const { return sent_at_.has_value(); }

  // Empty while the transfer goes on. Errors: kSdoTimeout, kSdoAborted.
  [[nodiscard]] const std::optional<SdoOutcome>& outcome() const { return outcome_; }

 private:
  NodeId node_;
  SdoRequest request_;
  hal::Duration timeout_;
  unsigned attempts_left_;
  std::optional<hal::Instant> sent_at_;
  std::optional<SdoOutcome> outcome_;
};

}  // namespace armsig::canopen
