// SPDX-License-Identifier: MIT
// Expedited SDO transfers (CiA 301, 7.2.4.3): up to four bytes, one request at a time per device.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "hal/can_bus.hpp"
#include "hal/canopen/protocol.hpp"

namespace armsig::canopen {

struct SdoRequest {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 0;  // written: 1, 2 or 4; 0 reads the object
  std::uint32_t value = 0;
};

struct SdoFailure {
  Error error = Error::kSdoTimeout;  // or kSdoAborted
  std::uint32_t abort_code = 0;      // as the device sent it

  friend bool operator==(const SdoFailure&, const SdoFailure&) = default;
};

// The value read (little-endian, zero-extended), or the value written.
using SdoOutcome = std::expected<std::uint32_t, SdoFailure>;

// Abort codes of CiA 301, 7.2.4.3.17, that callers tell apart.
inline constexpr std::uint32_t kAbortNoObject = 0x06020000;
inline constexpr std::uint32_t kAbortNoSubindex = 0x06090011;

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
