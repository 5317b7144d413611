// SPDX-License-Identifier: MIT
#include "firmware/controller/store_ledger.hpp"

#include <algorithm>

#include "core/base/check.hpp"
#include "core/base/crc32.hpp"
#include "firmware/controller/little_endian.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kLedgerMagic{'A', 'L', 'E', 'D'};
constexpr std::uint16_t kLedgerVersion = 2;
constexpr std::uint8_t kNoBank = 0xFF;
constexpr std::size_t kLedgerCrcOffset = kLedgerEntryBytes - 4;
constexpr int kReadAttempts = 3;

std::uint32_t ledger_crc(const LedgerImage& image) {
  return crc32(std::as_bytes(std::span(image).first(kLedgerCrcOffset)));
}

void take(BankLedger& ledger, const LedgerEntry& entry) {
  ledger.intact = true;
  if (entry.kind == LedgerKind::kVoid) return;
  if (ledger.entry && entry.number < ledger.entry->number) return;
  const bool settles = entry.kind == LedgerKind::kSettled;
  const bool same = ledger.entry && entry.number == ledger.entry->number;
  ledger.settled = settles || (same && ledger.settled);
  ledger.entry = entry;
}

}  // namespace

bool is_erased(std::span<const std::uint8_t> bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte == hal::kErasedByte; });
}

LedgerImage encode(const LedgerEntry& entry) {
  LedgerImage image{};
  LittleEndianWriter out(image);
  for (const std::uint8_t byte : kLedgerMagic) out.integer(byte, 1);
  out.integer(kLedgerVersion, 2);
  out.integer(static_cast<std::uint8_t>(entry.kind), 2);
  out.integer(entry.number, 4);
  out.integer(entry.newest, 4);
  out.integer(entry.active ? entry.active->bank : kNoBank, 1);
  out.integer(entry.former ? entry.former->bank : kNoBank, 1);
  out.integer(0, 2);
  out.integer(entry.active ? entry.active->crc : 0, 4);
  out.integer(entry.former ? entry.former->crc : 0, 4);
  out.integer(ledger_crc(image), 4);
  return image;
}

std::optional<LedgerEntry> decode(const LedgerImage& image) {
  if (!std::ranges::equal(std::span(image).first(4), kLedgerMagic)) return std::nullopt;
  if (LittleEndianReader(image, kLedgerCrcOffset).integer(4) != ledger_crc(image)) {
    return std::nullopt;
  }
  LittleEndianReader in(image, 4);
  const std::uint64_t version = in.integer(2);
  const std::uint64_t kind = in.integer(2);
  if (version != kLedgerVersion || kind > static_cast<std::uint8_t>(LedgerKind::kSettled)) {
    return std::nullopt;
  }
  LedgerEntry entry;
  entry.kind = static_cast<LedgerKind>(kind);
  entry.number = static_cast<std::uint32_t>(in.integer(4));
  entry.newest = static_cast<std::uint32_t>(in.integer(4));
  StoredRecord active;
  StoredRecord former;
  active.bank = static_cast<std::uint8_t>(in.integer(1));
  former.bank = static_cast<std::uint8_t>(in.integer(1));
  (void)in.integer(2);
  active.crc = static_cast<std::uint32_t>(in.integer(4));
  former.crc = static_cast<std::uint32_t>(in.integer(4));
  const auto exists = [](const StoredRecord& record) {
    return record.bank < kStoreBanks || record.bank == kNoBank;
  };
  if (!exists(active) || !exists(former)) return std::nullopt;
  if (active.bank != kNoBank) entry.active = active;
  if (former.bank != kNoBank) entry.former = former;
  return entry;
}

Result<void> read_patiently(hal::NonvolatileMemory& memory, std::size_t address,
                            std::span<std::uint8_t> into) {
  Result<void> read;
  for (int attempt = 0; attempt < kReadAttempts; ++attempt) {
    read = memory.read(address, into);
    if (read) break;
  }
  return read;
}

BankLedger read_ledger(hal::NonvolatileMemory& memory, std::size_t sector) {
  const hal::MemoryLayout layout = memory.layout();
  BankLedger ledger;
  for (std::size_t page = 0; page < layout.pages_per_sector; ++page) {
    LedgerImage image{};
    const std::size_t at = sector * layout.sector_bytes() + page * layout.page_bytes;
    const bool read = read_patiently(memory, at, image).has_value();
    if (read && is_erased(image)) continue;
    ledger.next_page = page + 1;
    ledger.unreadable = ledger.unreadable || !read;
    if (!read) continue;
    const auto entry = decode(image);
    if (entry) take(ledger, *entry);
    if (!entry) ++ledger.strange;
  }
  return ledger;
}

Result<void> program_padded(hal::NonvolatileMemory& memory, std::size_t address,
                            std::span<const std::uint8_t> bytes) {
  const std::size_t page_bytes = memory.layout().page_bytes;
  ARMSIG_CHECK(bytes.size() <= page_bytes && page_bytes <= kLargestPage);
  std::array<std::uint8_t, kLargestPage> page;
  page.fill(hal::kErasedByte);
  std::ranges::copy(bytes, page.begin());
  return memory.program_page(address, std::span(page).first(page_bytes));
}

Result<void> write_entry(hal::NonvolatileMemory& memory, std::size_t sector, std::size_t page,
                         const LedgerEntry& entry) {
  const hal::MemoryLayout layout = memory.layout();
  const std::size_t at = sector * layout.sector_bytes() + page * layout.page_bytes;
  const LedgerImage image = encode(entry);
  if (auto done = program_padded(memory, at, image); !done) return done;
  LedgerImage stored{};
  if (auto read = read_patiently(memory, at, stored); !read) return read;
  if (stored != image) return std::unexpected(Error::kRecordCorrupt);
  return {};
}

}  // namespace armsig::controller
