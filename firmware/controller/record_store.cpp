// SPDX-License-Identifier: MIT
#include "firmware/controller/record_store.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace armsig::controller {
namespace {

// The record, and who answers for it.
constexpr std::size_t kStoredBytes = kRecordBytes + kPersonsBytes;

}  // namespace

std::size_t RecordStore::record_pages() const {
  return (kStoredBytes + memory_.layout().page_bytes - 1) / memory_.layout().page_bytes;
}

std::size_t RecordStore::sectors_per_bank() const {
  const std::size_t pages = memory_.layout().pages_per_sector;
  return 1 + (record_pages() + pages - 1) / pages;
}

std::size_t RecordStore::ledger_sector(std::size_t bank) const { return bank * sectors_per_bank(); }

std::size_t RecordStore::record_address(std::size_t bank) const {
  return (ledger_sector(bank) + 1) * memory_.layout().sector_bytes();
}

bool RecordStore::fits() const {
  const hal::MemoryLayout layout = memory_.layout();
  constexpr std::size_t kEntriesOfAChange = 2;
  return layout.page_bytes >= kLedgerEntryBytes && layout.page_bytes <= kLargestPage &&
         layout.pages_per_sector >= 2 * kEntriesOfAChange && layout.sectors >= sectors();
}

// Another one for every change: it is neither of the two that are in use, nor that of the entry.
std::uint8_t RecordStore::free_bank() const {
  for (std::uint8_t bank = 0; bank < kStoreBanks; ++bank) {
    const bool used = (entry_.active && entry_.active->bank == bank) ||
                      (entry_.former && entry_.former->bank == bank) ||
                      (formatted_ && at_bank_ == bank);
    if (!used) return bank;
  }
  ARMSIG_CHECK(false);
  return 0;
}

Result<void> RecordStore::read(const StoredRecord& record) {
  if (auto done = read_patiently(memory_, record_address(record.bank), image_); !done) {
    return done;
  }
  if (!is_whole(image_) || crc_of(image_) != record.crc) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  return {};
}

// True if there never was a record: the memory is as it was made, or the first use of it was cut
// short, which begins in the first bank and leaves one page of its ledger torn, or all of it
// unreadable. Precondition: no ledger holds an entry.
bool RecordStore::was_never_used(const std::array<BankLedger, kStoreBanks>& ledgers) {
  for (std::size_t bank = 0; bank < kStoreBanks; ++bank) {
    if (ledgers[bank].strange > 1) return false;
    const bool read = read_patiently(memory_, record_address(bank), image_).has_value();
    if (!read && bank > 0) return false;
    if (read && !is_erased(image_)) return false;
  }
  return true;
}

Result<void> RecordStore::open() {
  if (!fits()) return std::unexpected(Error::kAddressOutOfRange);
  change_.reset();
  trouble_.reset();
  entry_ = {};
  formatted_ = false;
  std::array<BankLedger, kStoreBanks> ledgers;
  for (std::uint8_t bank = 0; bank < kStoreBanks; ++bank) {
    ledgers[bank] = read_ledger(memory_, ledger_sector(bank));
    const auto& found = ledgers[bank].entry;
    if (!found || (formatted_ && found->number <= entry_.number)) continue;
    formatted_ = true;
    entry_ = *found;
    at_bank_ = bank;
  }
  if (!formatted_) {
    if (was_never_used(ledgers)) return {};
    const bool unread = std::ranges::any_of(ledgers, &BankLedger::unreadable);
    return std::unexpected(unread ? Error::kStorageFault : Error::kRecordCorrupt);
  }
  if (auto done = settle(ledgers); !done) trouble_ = done.error();
  return fall_back();
}

Result<void> RecordStore::settle(const std::array<BankLedger, kStoreBanks>& ledgers) {
  const BankLedger& last = ledgers[at_bank_];
  if (!last.settled) {
    if (last.next_page + 2 > memory_.layout().pages_per_sector) {
      return std::unexpected(Error::kStorageFull);
    }
    if (auto done = enter(entry_, last.next_page); !done) return done;
  }
  const std::uint8_t bank = free_bank();
  if (ledgers[bank].intact) return {};
  return make_void(bank);
}

// Where the active record is lost the one before it is used, which was accepted as well.
Result<void> RecordStore::fall_back() {
  if (!entry_.active) return {};
  const auto active = read(*entry_.active);
  if (active) return {};
  trouble_ = active.error();
  entry_.active.reset();
  if (entry_.former && read(*entry_.former)) entry_.active = entry_.former;
  entry_.former.reset();
  if (!entry_.active) return std::unexpected(active.error());
  return {};
}

// The first entry, which says that nothing is stored: what comes after it can be told from it.
Result<void> RecordStore::format() {
  entry_ = {};
  entry_.number = 1;
  at_bank_ = 0;
  if (auto done = memory_.erase_sector(ledger_sector(0)); !done) return done;
  if (auto done = enter(entry_, 0); !done) return done;
  formatted_ = true;
  return make_void(free_bank());
}

// Nothing is under way in `bank`.
Result<void> RecordStore::make_void(std::uint8_t bank) {
  if (auto done = memory_.erase_sector(ledger_sector(bank)); !done) return done;
  return write_entry(memory_, ledger_sector(bank), 0, {});
}

// `entry` at the first of two pages, and that it is settled.
Result<void> RecordStore::enter(LedgerEntry entry, std::size_t page) {
  entry.kind = LedgerKind::kEntered;
  if (auto done = write_entry(memory_, ledger_sector(at_bank_), page, entry); !done) return done;
  entry.kind = LedgerKind::kSettled;
  return write_entry(memory_, ledger_sector(at_bank_), page + 1, entry);
}

RecordImage& RecordStore::begin_write() {
  ARMSIG_CHECK(fits() && !change_);
  change_.emplace();
  change_->writes = true;
  change_->stage = formatted_ ? Stage::kEraseLedger : Stage::kFormat;
#ifndef ARMSIG_SMALL_IMAGE
  persons_.fill(hal::kErasedByte);
#endif
  return image_;
}

Result<void> RecordStore::begin_rollback() {
  ARMSIG_CHECK(fits() && !change_);
  if (!entry_.active) return std::unexpected(Error::kNoSignature);
  if (entry_.former) {
    if (const auto former = read(*entry_.former); !former) return std::unexpected(former.error());
  }
  change_.emplace();
  return {};
}

// What the ledger says when the change is done.
LedgerEntry RecordStore::changed() const {
  LedgerEntry next = entry_;
  ++next.number;
  if (change_->writes) {
    ++next.newest;
    next.former = entry_.active;
    next.active = StoredRecord{.bank = free_bank(), .crc = crc_of(image_)};
  } else {
    next.active = entry_.former;
    next.former.reset();
  }
  return next;
}

Result<bool> RecordStore::step() {
  ARMSIG_CHECK(change_.has_value());
  const auto done = advance(*change_);
  const bool whole = done && change_->stage == Stage::kDone;
  if (whole) {
    at_bank_ = free_bank();
    entry_ = change_->entry;
  }
  if (!done || whole) change_.reset();
  if (!done) return std::unexpected(done.error());
  return whole;
}

Result<void> RecordStore::advance(Change& change) {
  const std::uint8_t bank = formatted_ ? free_bank() : std::uint8_t{0};
  const Stage stage = change.stage;
  switch (stage) {
    case Stage::kFormat:
      change.stage = Stage::kEraseLedger;
      return format();
    case Stage::kEraseLedger:
      change.stage = change.writes ? Stage::kEraseRecord : Stage::kEnter;
      return memory_.erase_sector(ledger_sector(bank));
    case Stage::kEraseRecord:
      if (change.erased + 2 == sectors_per_bank()) change.stage = Stage::kProgram;
      return memory_.erase_sector(ledger_sector(bank) + 1 + change.erased++);
    case Stage::kProgram:
      if (change.programmed + 1 == record_pages()) change.stage = Stage::kVerify;
      return program_page(bank, change.programmed++);
    case Stage::kVerify:
      if (change.verified + 1 == record_pages()) change.stage = Stage::kEnter;
      return verify(bank, change.verified++);
    case Stage::kEnter:
      change.entry = changed();
      change.entry.kind = LedgerKind::kEntered;
      change.stage = Stage::kSettle;
      return write_entry(memory_, ledger_sector(bank), 0, change.entry);
    case Stage::kSettle:
      change.entry.kind = LedgerKind::kSettled;
      change.stage = Stage::kDone;
      return write_entry(memory_, ledger_sector(bank), 1, change.entry);
    case Stage::kDone:
      break;
  }
  return {};
}

// What page `page` of the record holds.
std::span<const std::uint8_t> RecordStore::page_of_image(std::size_t page) {
  const std::size_t bytes = memory_.layout().page_bytes;
  const std::size_t first = page * bytes;
  const std::size_t count = std::min(bytes, kStoredBytes - first);
#ifdef ARMSIG_SMALL_IMAGE
  return std::span(image_).subspan(first, count);
#else
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = first + i;
    page_[i] = at < kRecordBytes ? image_[at] : persons_[at - kRecordBytes];
  }
  return std::span(page_).first(count);
#endif
}

#ifndef ARMSIG_SMALL_IMAGE
Persons RecordStore::read_persons() {
  const StoredRecord& record = *entry_.active;
  const std::size_t address = record_address(record.bank) + kRecordBytes;
  if (!read_patiently(memory_, address, persons_)) {
    return {.sender = {}, .confirmer = {}, .unreadable = true};
  }
  return decode_persons(persons_, record.crc);
}
#endif

Result<void> RecordStore::program_page(std::uint8_t bank, std::size_t page) {
  return program_padded(memory_, record_address(bank) + page * memory_.layout().page_bytes,
                        page_of_image(page));
}

Result<void> RecordStore::verify(std::uint8_t bank, std::size_t page) {
  const auto expected = page_of_image(page);
  std::array<std::uint8_t, kLargestPage> room;
  const auto stored = std::span(room).first(expected.size());
  const std::size_t address = record_address(bank) + page * memory_.layout().page_bytes;
  if (auto done = read_patiently(memory_, address, stored); !done) return done;
  if (!std::ranges::equal(stored, expected)) return std::unexpected(Error::kRecordCorrupt);
  return {};
}

}  // namespace armsig::controller
