// SPDX-License-Identifier: MIT
#include "firmware/controller/position_keeper.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/crc32.hpp"
#include "firmware/controller/little_endian.hpp"
#include "firmware/controller/store_ledger.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kPositionMagic{'A', 'P', 'O', 'S'};
constexpr std::uint16_t kPositionVersion = 2;
constexpr std::size_t kPositionBytes = 116;
constexpr std::size_t kPositionCrcOffset = kPositionBytes - 4;
using PositionImage = std::array<std::uint8_t, kPositionBytes>;

// Rad or m: what moves less is the arm settling on its brakes.
constexpr double kSamePlace = 1e-6;

std::uint32_t position_crc(const PositionImage& image) {
  return crc32(std::as_bytes(std::span(image).first(kPositionCrcOffset)));
}

PositionImage image_of(const RestRecord& rest, std::uint32_t number) {
  const JointVector& positions = rest.positions;
  PositionImage image{};
  LittleEndianWriter out(image);
  for (const std::uint8_t byte : kPositionMagic) out.integer(byte, 1);
  out.integer(kPositionVersion, 2);
  out.integer(positions.size(), 2);
  out.integer(number, 4);
  for (std::size_t i = 0; i < kMaxJoints; ++i) out.real(i < positions.size() ? positions[i] : 0);
  out.integer(rest.unreferenced, 1);
  out.integer(rest.by_drive, 1);
  out.integer(0, 2);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    out.integer(i < rest.drives.size() ? rest.drives[i] : 0, 4);
  }
  out.integer(position_crc(image), 4);
  return image;
}

struct Kept {
  std::uint32_t number = 0;
  RestRecord rest;
};

// As a page holds them: as many of the eight as there are joints.
template <typename Vector>
void read_some(std::size_t joints, Vector& into, auto read) {
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const auto value = read();
    if (i < joints) into.push_back(value);
  }
}

std::optional<Kept> kept_in(const PositionImage& image) {
  if (!std::ranges::equal(std::span(image).first(4), kPositionMagic)) return std::nullopt;
  if (LittleEndianReader(image, kPositionCrcOffset).integer(4) != position_crc(image)) {
    return std::nullopt;
  }
  LittleEndianReader in(image, 4);
  const std::uint64_t version = in.integer(2);
  const auto joints = static_cast<std::size_t>(in.integer(2));
  if (version != kPositionVersion || joints > kMaxJoints) return std::nullopt;
  Kept kept;
  kept.number = static_cast<std::uint32_t>(in.integer(4));
  read_some(joints, kept.rest.positions, [&] { return in.real(); });
  kept.rest.unreferenced = static_cast<std::uint8_t>(in.integer(1));
  kept.rest.by_drive = static_cast<std::uint8_t>(in.integer(1));
  (void)in.integer(2);
  read_some(joints, kept.rest.drives, [&] { return static_cast<std::uint32_t>(in.integer(4)); });
  if (!in.all_finite()) return std::nullopt;
  return kept;
}

}  // namespace

bool PositionKeeper::fits() const {
  const hal::MemoryLayout layout = memory_.layout();
  return sector_ < layout.sectors && layout.page_bytes >= kPositionBytes &&
         layout.page_bytes <= kLargestPage;
}

std::optional<RestRecord> PositionKeeper::load(std::size_t joints) {
  kept_.reset();
  number_ = 0;
  next_page_ = 0;
  if (!fits()) return std::nullopt;
  const hal::MemoryLayout layout = memory_.layout();
  for (std::size_t page = 0; page < layout.pages_per_sector; ++page) {
    PositionImage image{};
    const std::size_t at = sector_ * layout.sector_bytes() + page * layout.page_bytes;
    const bool read = memory_.read(at, image).has_value();
    if (read && is_erased(image)) continue;
    next_page_ = page + 1;
    const auto kept = read ? kept_in(image) : std::nullopt;
    if (!kept || kept->number < number_) continue;
    number_ = kept->number;
    kept_ = kept->rest;
  }
  if (kept_ && kept_->positions.size() != joints) kept_.reset();
  return kept_;
}

void PositionKeeper::begin(const RestRecord& rest) {
  const auto same = [](double a, double b) { return std::abs(a - b) <= kSamePlace; };
  const bool kept = kept_ && kept_->unreferenced == rest.unreferenced &&
                    kept_->by_drive == rest.by_drive &&
                    std::ranges::equal(kept_->drives, rest.drives) &&
                    std::ranges::equal(kept_->positions, rest.positions, same);
  if (fits() && !kept) writing_ = rest;
}

void PositionKeeper::step() {
  ARMSIG_CHECK(writing_.has_value());
  const hal::MemoryLayout layout = memory_.layout();
  if (next_page_ == layout.pages_per_sector) {
    next_page_ = 0;
    if (!memory_.erase_sector(sector_)) writing_.reset();
    return;
  }
  const std::size_t at = sector_ * layout.sector_bytes() + next_page_++ * layout.page_bytes;
  if (program_padded(memory_, at, image_of(*writing_, ++number_))) kept_ = writing_;
  writing_.reset();
}

}  // namespace armsig::controller
