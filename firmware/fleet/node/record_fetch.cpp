// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/record_fetch.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <optional>
#include <span>

#include "core/base/crc32.hpp"
#include "core/calibration/packed_deflections.hpp"
#include "firmware/fleet/wire/signature_document.hpp"

namespace armsig::fleet {
namespace {

constexpr std::string_view kReply = "ok bytes=";

// Takes a whole number and `after` from the front of `text`.
std::optional<std::size_t> take_size(std::string_view& text, std::string_view after) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.starts_with(after)) return std::nullopt;
  text.remove_prefix(after.size());
  return value;
}

// A record with everything: version 4.
class Record {
 public:
  explicit Record(std::span<const std::uint8_t> image) : image_(image) {}

  [[nodiscard]] bool is_whole() const {
    const std::size_t crc_at = image_.size() - 4;
    return std::ranges::equal(image_.first(4), kMagic) && integer(4, 2) == kVersion &&
           integer(crc_at, 4) == crc32(std::as_bytes(image_.first(crc_at))) && joints() >= 1 &&
           joints() <= kMaxJoints;
  }
  [[nodiscard]] std::uint64_t number() const { return integer(12, 4); }
  [[nodiscard]] std::size_t joints() const { return integer(6, 1); }
  [[nodiscard]] JointType type(std::size_t i) const {
    return integer(16 + i, 1) == 0 ? JointType::kRevolute : JointType::kPrismatic;
  }
  [[nodiscard]] double reading(std::size_t i) const { return real(kConfigurationAt + 8 * i); }
  // None where the record has none; kRecordCorrupt: what no arm has.
  [[nodiscard]] Result<calibration::PackedDeflections> deflections() const {
    calibration::PackedDeflections read;
    if (integer(kBendsAt, 4) == 0) return read;
    const std::size_t terms = integer(kBendsAt + 4, 4);
    if (terms > calibration::kMaxGravityTerms) return std::unexpected(Error::kRecordCorrupt);
    for (std::size_t i = 0; i < joints(); ++i) {
      const std::size_t at = kMapsAt + i * kMapBytes;
      read.maps.push_back(
          {.domain = {.origin = real(at), .per_length = real(at + 8)}, .step = real(at + 16)});
      read.drawn_zero[i] = real(at + 24);
      for (std::size_t k = 0; k < calibration::kKnots; ++k) {
        read.maps[i].steps[k] = static_cast<std::int16_t>(integer(at + 32 + 2 * k, 2));
      }
    }
    for (std::size_t i = 0; i < terms; ++i) {
      const std::size_t at = kGravityAt + i * kTermBytes;
      read.gravity.push_back({.joint = static_cast<std::uint8_t>(integer(at, 1)),
                              .origin = static_cast<std::uint8_t>(integer(at + 1, 1)),
                              .coefficient = real(at + 4)});
    }
    read.up_0 = Vector3(real(kUpAt), real(kUpAt + 8), real(kUpAt + 16));
    if (!calibration::check(read, of_unknown_lengths(joints())))
      return std::unexpected(Error::kRecordCorrupt);
    return read;
  }

 private:
  static constexpr std::array<std::uint8_t, 4> kMagic{'A', 'S', 'I', 'G'};
  static constexpr std::uint64_t kVersion = 4;
  static constexpr std::size_t kConfigurationAt = 24;
  static constexpr std::size_t kBendsAt = 1408;
  static constexpr std::size_t kMapsAt = 1416;
  static constexpr std::size_t kMapBytes = 272;
  static constexpr std::size_t kGravityAt = 3592;
  static constexpr std::size_t kTermBytes = 12;
  static constexpr std::size_t kUpAt = kGravityAt + calibration::kMaxGravityTerms * kTermBytes;

  [[nodiscard]] std::uint64_t integer(std::size_t at, std::size_t bytes) const {
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8U | image_[at + i];
    return value;
  }
  [[nodiscard]] double real(std::size_t at) const { return std::bit_cast<double>(integer(at, 8)); }

  std::span<const std::uint8_t> image_;
};

}  // namespace

void RecordFetch::begin(std::string_view rows, std::uint64_t number) {
  number_ = number;
  state_ = State::kAsks;
  part_ = 1;
  document_ = rows;
}

bool RecordFetch::take(std::string_view line) {
  if (state_ != State::kAsks) return false;
  if (line.starts_with(kReply)) {
    if (!add(line.substr(kReply.size()))) {
      state_ = State::kWhole;
    } else if ((part_ - 1) * kPartBytes >= image_.size()) {
      finish();
    }
    return true;
  }
  if (!line.starts_with("error ")) return false;
  state_ = State::kWhole;
  return true;
}

bool RecordFetch::add(std::string_view line) {
  const auto bytes = take_size(line, " parts=");
  const auto parts = bytes ? take_size(line, " hex=") : std::nullopt;
  const std::size_t begin = (part_ - 1) * kPartBytes;
  const std::size_t size = std::min(kPartBytes, image_.size() - begin);
  if (!parts || *bytes != image_.size() || line.size() != 2 * size) return false;
  for (std::size_t i = 0; i < size; ++i) {
    const char* digits = line.data() + 2 * i;
    const auto [end, error] = std::from_chars(digits, digits + 2, image_[begin + i], 16);
    if (error != std::errc{} || end != digits + 2) return false;
  }
  ++part_;
  return true;
}

void RecordFetch::finish() {
  state_ = State::kWhole;
  const Record record(image_);
  if (!record.is_whole()) return;
  if (record.number() != number_) {
    state_ = State::kOther;
    return;
  }
  FixedVector<JointType, kMaxJoints> types;
  JointVector configuration;
  for (std::size_t i = 0; i < record.joints(); ++i) {
    types.push_back(record.type(i));
    configuration.push_back(record.reading(i));
  }
  const auto deflections = record.deflections();
  if (deflections) document_ = signature_document(document_, types, *deflections, configuration);
}

}  // namespace armsig::fleet
