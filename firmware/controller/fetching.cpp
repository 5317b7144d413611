// SPDX-License-Identifier: MIT
#include "firmware/controller/fetching.hpp"

#include <algorithm>

#include "core/base/crc32.hpp"
#include "firmware/controller/little_endian.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kDrawingCrc = kDrawingBytes - 4;

std::uint32_t content_crc_of(const DrawingImage& image) {
  return crc32(std::as_bytes(std::span(image).first(kDrawingCrc)));
}

struct Asked {
  std::string_view what;
  double part = 1;
};

Result<Asked> asked_for(const Request& request, Line& out) {
  Asked asked;
  for (const auto& [key, value] : request.arguments) {
    if (key == "what") {
      asked.what = value;
    } else if (key == "part") {
      ARMSIG_TRY(number, needed_number(key, value, out));
      asked.part = number;
    } else {
      return std::unexpected(Error::kUnknownRequest);
    }
  }
  return asked;
}

// Of an image of `size` bytes: fill(begin, bytes) fills in a part of it, as there is no room for
// all of it on the stack of a small controller.
template <typename Fill>
Result<void> tell(std::size_t size, const Fill& fill, double asked_part, Line& out) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const std::size_t parts = (size + kPartBytes - 1) / kPartBytes;
  if (!(asked_part >= 1 && asked_part <= static_cast<double>(parts))) {
    return std::unexpected(Error::kOutOfRange);
  }
  const std::size_t begin = (static_cast<std::size_t>(asked_part) - 1) * kPartBytes;
  std::array<std::uint8_t, kPartBytes> room{};
  const auto part = std::span(room).first(std::min(kPartBytes, size - begin));
  fill(begin, part);
  out.text(" bytes=").integer(size).text(" parts=").integer(parts).text(" hex=");
  for (const std::uint8_t byte : part) {
    const std::array<char, 2> digits{kDigits[byte >> 4U], kDigits[byte & 0xFU]};
    out.text({digits.data(), digits.size()});
  }
  return {};
}

Result<void> tell_drawing(const Arm& drawing, double asked_part, Line& out) {
  const DrawingImage image = encode_drawing(drawing);
  const auto fill = [&](std::size_t begin, std::span<std::uint8_t> part) {
    std::ranges::copy(std::span(image).subspan(begin, part.size()), part.begin());
  };
  return tell(image.size(), fill, asked_part, out);
}

Result<void> tell_record(const SignatureRecord& record, double asked_part, Line& out) {
  const auto fill = [&](std::size_t begin, std::span<std::uint8_t> part) {
    encode_part(record, begin, part);
  };
  return tell(kRecordBytes, fill, asked_part, out);
}

}  // namespace

DrawingImage encode_drawing(const Arm& drawing) {
  DrawingImage image{};
  LittleEndianWriter out(image);
  const std::size_t n = drawing.joints.size();
  out.integer(n, 8);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const DhJoint joint = i < n ? drawing.joints[i] : DhJoint{};
    const JointLimits limits = i < n ? drawing.limits[i] : JointLimits{};
    const double type = joint.type == JointType::kPrismatic ? 1 : 0;
    for (const double value : {type, joint.theta_rad, joint.d_m, joint.a_m, joint.alpha_rad,
                               limits.lower, limits.upper}) {
      out.real(value);
    }
  }
  for (const double part : drawing.up_0) out.real(part);
  out.integer(content_crc_of(image), 4);
  return image;
}

Result<Arm> decode_drawing(const DrawingImage& image) {
  LittleEndianReader in(image);
  const auto n = in.integer(8);
  Arm drawing;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    DhJoint joint;
    JointLimits limits;
    joint.type = in.real() == 0 ? JointType::kRevolute : JointType::kPrismatic;
    for (double* value : {&joint.theta_rad, &joint.d_m, &joint.a_m, &joint.alpha_rad, &limits.lower,
                          &limits.upper}) {
      *value = in.real();
    }
    if (i >= n) continue;
    drawing.joints.push_back(joint);
    drawing.limits.push_back(limits);
  }
  for (double& part : drawing.up_0) part = in.real();
  const bool whole = in.integer(4) == content_crc_of(image);
  if (!whole || n == 0 || n > kMaxJoints || !in.all_finite()) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  return drawing;
}

Result<void> tell_part(const Request& request, const Fetchable& fetchable, Line& out) {
  const auto asked = asked_for(request, out);
  if (!asked) return std::unexpected(asked.error());
  if (asked->what == "nominal") return tell_drawing(*fetchable.drawing, asked->part, out);
  const bool signature = asked->what == "signature";
  if (!signature && asked->what != "candidate") return std::unexpected(Error::kUnknownRequest);
  const SignatureRecord* record = signature ? fetchable.signature : fetchable.candidate;
  if (record == nullptr) {
    return std::unexpected(signature ? Error::kNoSignature : Error::kNoCandidate);
  }
  // Maps are of encoders' readings, and all else that is told of joints'.
  if (!record->deflections.empty() && !fetchable.drawing->couplings.empty()) {
    return std::unexpected(Error::kUnsupported);
  }
  return tell_record(*record, asked->part, out);
}

}  // namespace armsig::controller
