// SPDX-License-Identifier: MIT
#include "firmware/controller/signature_store.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kSlots = 2;
constexpr std::array<std::uint8_t, 4> kRevokedMagic{'A', 'R', 'E', 'V'};
constexpr std::size_t kRevocationBytes = 8;
using Revocation = std::array<std::uint8_t, kRevocationBytes>;

// Bound to its record by the record's own CRC, so that a page cut short can't pass for it.
Revocation revocation_of(const RecordImage& image) {
  Revocation revocation{};
  std::ranges::copy(kRevokedMagic, revocation.begin());
  std::copy(image.end() - 4, image.end(), revocation.begin() + 4);
  return revocation;
}

}  // namespace

std::size_t SignatureStore::record_pages() const {
  return (kRecordBytes + memory_.layout().page_bytes - 1) / memory_.layout().page_bytes;
}

std::size_t SignatureStore::sectors_per_slot() const {
  const std::size_t pages = record_pages() + 1;
  return (pages + memory_.layout().pages_per_sector - 1) / memory_.layout().pages_per_sector;
}

std::size_t SignatureStore::address(std::size_t slot) const {
  return slot * sectors_per_slot() * memory_.layout().sector_bytes();
}

bool SignatureStore::fits() const {
  const hal::MemoryLayout layout = memory_.layout();
  return layout.page_bytes >= kRevocationBytes && layout.page_bytes <= kLargestPage &&
         layout.pages_per_sector > 0 && layout.sectors >= kSlots * sectors_per_slot();
}

Result<RecordImage> SignatureStore::read_image(std::size_t slot) {
  RecordImage image{};
  if (auto read = memory_.read(address(slot), image); !read) {
    return std::unexpected(read.error());
  }
  return image;
}

Result<bool> SignatureStore::is_revoked(std::size_t slot, const RecordImage& image) {
  Revocation found{};
  const std::size_t at = address(slot) + record_pages() * memory_.layout().page_bytes;
  if (auto read = memory_.read(at, found); !read) return std::unexpected(read.error());
  return found == revocation_of(image);
}

Result<void> SignatureStore::load(const Arm& drawing, SignatureRecord& record) {
  if (!fits()) return std::unexpected(Error::kAddressOutOfRange);
  active_.reset();
  newest_ = 0;
  Error why = Error::kNoSignature;
  std::uint32_t best = 0;
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    ARMSIG_TRY(image, read_image(slot));
    if (std::ranges::all_of(image, [](std::uint8_t byte) { return byte == hal::kErasedByte; })) {
      continue;
    }
    if (const auto decoded = decode(image, drawing, record); !decoded) {
      why = decoded.error();
      continue;
    }
    newest_ = std::max(newest_, record.sequence);
    ARMSIG_TRY(revoked, is_revoked(slot, image));
    if (revoked || (active_ && record.sequence <= best)) continue;
    active_ = slot;
    best = record.sequence;
  }
  if (!active_) return std::unexpected(why);
  ARMSIG_TRY(image, read_image(*active_));
  return decode(image, drawing, record);
}

void SignatureStore::begin_write(const SignatureRecord& record) {
  ARMSIG_CHECK(fits() && !writing_);
  writing_.emplace();
  writing_->image = encode(record, newest_ + 1);
  writing_->slot = active_ ? 1 - *active_ : 0;
}

Result<void> SignatureStore::program(std::size_t at, std::span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, kLargestPage> page;
  page.fill(hal::kErasedByte);
  std::ranges::copy(bytes, page.begin());
  return memory_.program_page(at, std::span(page).first(memory_.layout().page_bytes));
}

Result<bool> SignatureStore::step_write() {
  ARMSIG_CHECK(writing_.has_value());
  RecordWriting& w = *writing_;
  const std::size_t page = memory_.layout().page_bytes;
  Result<void> done;
  if (w.erased < sectors_per_slot()) {
    done = memory_.erase_sector(w.slot * sectors_per_slot() + w.erased);
    ++w.erased;
  } else if (w.pages < record_pages()) {
    const std::size_t first = w.pages * page;
    done = program(address(w.slot) + first,
                   std::span(w.image).subspan(first, std::min(page, kRecordBytes - first)));
    ++w.pages;
  } else {
    const auto stored = read_image(w.slot);
    const bool same = stored && *stored == w.image;
    if (same) {
      active_ = w.slot;
      ++newest_;
    }
    writing_.reset();
    if (!stored) return std::unexpected(stored.error());
    if (!same) return std::unexpected(Error::kRecordCorrupt);
    return true;
  }
  if (!done) {
    writing_.reset();
    return std::unexpected(done.error());
  }
  return false;
}

Result<void> SignatureStore::revoke() {
  if (!active_) return std::unexpected(Error::kNoSignature);
  ARMSIG_TRY(image, read_image(*active_));
  return program(address(*active_) + record_pages() * memory_.layout().page_bytes,
                 revocation_of(image));
}

}  // namespace armsig::controller
