// SPDX-License-Identifier: MIT
#include "hal/canopen/sdo_client.hpp"

#include <array>

namespace armsig::canopen {
namespace {

// Command specifiers, upper three bits of byte 0.
constexpr std::uint8_t kDownloadRequest = 0x20;
constexpr std::uint8_t kUploadRequest = 0x40;
constexpr std::uint8_t kUploadResponse = 0x40;
constexpr std::uint8_t kDownloadResponse = 0x60;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kSpecifierMask = 0xE0;
// Byte 0 of an expedited transfer: e = 1, s = 1, n = bytes that carry no data.
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeGiven = 0x01;

struct AbortWords {
  std::uint32_t code;
  const char* words;
};

// CiA 301, 7.2.4.3.17.
constexpr std::array<AbortWords, 28> kAborts{
    {{0x05030000, "toggle bit not alternated"},
     {0x05040000, "SDO protocol timed out"},
     {0x05040001, "command specifier not valid or unknown"},
     {0x05040005, "out of memory"},
     {0x06010000, "unsupported access to an object"},
     {0x06010001, "attempt to read a write-only object"},
     {0x06010002, "attempt to write a read-only object"},
     {cia402::kAbortNoObject, "object does not exist"},
     {0x06040041, "object cannot be mapped to the PDO"},
     {0x06040042, "mapped objects exceed the PDO length"},
     {0x06040043, "general parameter incompatibility"},
     {0x06040047, "general internal incompatibility in the device"},
     {0x06060000, "access failed due to a hardware error"},
     {0x06070010, "data type or length does not match"},
     {0x06070012, "data type does not match, length too high"},
     {0x06070013, "data type does not match, length too low"},
     {cia402::kAbortNoSubindex, "sub-index does not exist"},
     {0x06090030, "invalid value for the parameter"},
     {0x06090031, "value written too high"},
     {0x06090032, "value written too low"},
     {0x06090036, "maximum value is less than minimum value"},
     {0x060A0023, "resource not available"},
     {0x08000000, "general error"},
     {0x08000020, "data cannot be transferred or stored"},
     {0x08000021, "data cannot be transferred because of local control"},
     {0x08000022, "data cannot be transferred in the present device state"},
     {0x08000023, "object dictionary not present"},
     {0x08000024, "no data available"}}};

}  // namespace

hal::CanFrame encode_sdo(NodeId node, const SdoRequest& request) {
  hal::CanFrame frame{.id = kSdoRequestId + node, .length = 8};
  if (request.bytes == 0) {
    frame.data[0] = kUploadRequest;
  } else {
    ARMSIG_CHECK(request.bytes <= 4);
    frame.data[0] = static_cast<std::uint8_t>(kDownloadRequest | kExpedited | kSizeGiven |
                                              ((4U - request.bytes) << 2));
  }
  store(frame, 1, request.index);
  store(frame, 3, request.subindex);
  store(frame, 4, request.value);
  return frame;
}

std::optional<SdoOutcome> decode_sdo(const hal::CanFrame& frame, const SdoRequest& request) {
  if (frame.length != 8) return std::nullopt;
  if (load<std::uint16_t>(frame, 1) != request.index || frame.data[3] != request.subindex) {
    return std::nullopt;
  }
  const auto value = load<std::uint32_t>(frame, 4);
  switch (frame.data[0] & kSpecifierMask) {
    case kAbort:
      return std::unexpected(SdoFailure{Error::kSdoAborted, value});
    case kDownloadResponse:
      if (request.bytes == 0) return std::nullopt;
      return request.value;
    case kUploadResponse: {
      if (request.bytes != 0) return std::nullopt;
      if ((frame.data[0] & kExpedited) == 0) {
        return std::unexpected(SdoFailure{Error::kSdoAborted, 0});
      }
      const unsigned unused = (frame.data[0] & kSizeGiven) != 0 ? (frame.data[0] >> 2) & 3U : 0U;
      return value & (0xFFFFFFFFU >> (8 * unused));
    }
    default:
      return std::nullopt;
  }
}

void SdoTransfer::take(const hal::CanFrame& frame) {
  if (!sent_at_ || outcome_) return;
  outcome_ = decode_sdo(frame, request_);
}

std::optional<hal::CanFrame> SdoTransfer::poll(hal::Instant now) {
  if (outcome_ || (sent_at_ && now - *sent_at_ < timeout_)) return std::nullopt;
  if (attempts_left_ == 0) {
    outcome_ = std::unexpected(SdoFailure{Error::kSdoTimeout, 0});
    return std::nullopt;
  }
  --attempts_left_;
  sent_at_ = now;
  return encode_sdo(node_, request_);
}

std::string_view describe_sdo_abort(std::uint32_t code) {
  for (const AbortWords& abort : kAborts) {
    if (abort.code == code) return abort.words;
  }
  return "unknown abort code";
}

}  // namespace armsig::canopen
