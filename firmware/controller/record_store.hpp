// SPDX-License-Identifier: MIT
// Records in non-volatile memory, of which one is active and the one before it is kept: whatever is
// done to them is done whole or not at all, wherever the power goes.
//
// Three banks, each a ledger sector and then whole sectors for one record. Every change is made in
// the one bank that holds neither the active record, nor the former, nor the ledger's last entry,
// so that a device that spoils all of a bank at once loses nothing that counts:
//
//   erase the bank's ledger, erase its record, program the record, read it back page by page;
//   entry n + 1 ("entered") says what is active from now on; the same again ("settled").
//
// A roll back is the entries alone: the record that was rolled back stays where it is and nothing
// says any more that it is active. An entry that power cut short may read well once and not the
// next time. So nothing is told of the store before what is in doubt has been settled: an entry
// that reads well and is not settled is entered again behind it, and settled; a bank whose ledger
// holds no valid entry is one in which something had begun, and its ledger is erased and gets a
// void entry. What is settled was whole before, so that it does not matter how "settled" itself
// reads.
#pragma once

#include <optional>

#include "firmware/controller/signature_record.hpp"
#include "firmware/controller/store_ledger.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

class RecordStore {
 public:
  explicit RecordStore(hal::NonvolatileMemory& memory) : memory_(memory) {}

  // Whether the memory has room, and pages that suit.
  [[nodiscard]] bool fits() const;
  // Sectors that the store takes, from the first on.
  [[nodiscard]] std::size_t sectors() const { return kStoreBanks * sectors_per_bank(); }

  // Finds out what is stored and settles what a power loss left in doubt: some erases and pages.
  // Afterwards last_read() is the active record; nothing may be stored: no active() and no error.
  // Errors: kAddressOutOfRange (the memory does not fit), kStorageFault (nothing can be read that
  // says what is stored), kRecordCorrupt (something is stored, and nothing says what).
  [[nodiscard]] Result<void> open();

  [[nodiscard]] const std::optional<StoredRecord>& active() const { return entry_.active; }
  [[nodiscard]] const std::optional<StoredRecord>& former() const { return entry_.former; }
  // The sequence number that the next record is to have.
  [[nodiscard]] std::uint32_t next_sequence() const { return entry_.newest + 1; }
  // What open() could not mend, though it knows what is stored; or that the active record was lost,
  // and the former is in its place.
  [[nodiscard]] std::optional<Error> trouble() const { return trouble_; }

  // Reads a record, for last_read() to have it. Errors: kStorageFault, kRecordCorrupt.
  // Precondition: not is_writing().
  [[nodiscard]] Result<void> read(const StoredRecord& record);
  // The one image that there is: of the record that was read, or that is being written.
  [[nodiscard]] const RecordImage& last_read() const { return image_; }

#ifndef ARMSIG_SMALL_IMAGE
  // Who answers for the active record. Precondition: active().
  [[nodiscard]] Persons read_persons();
  // What is stored behind the record that is being written, by default nobody; to be changed at
  // once, like the record.
  [[nodiscard]] PersonsImage& persons() { return persons_; }
#endif

  // Begins to store what the caller then makes of the image that is returned, at once: a record
  // whose sequence number is next_sequence(), which becomes the active one. Precondition: open()
  // was called, fits(), not is_writing().
  [[nodiscard]] RecordImage& begin_write();
  // Begins to make the former record active; none: nothing is. Errors: kNoSignature (nothing is
  // active), kStorageFault, kRecordCorrupt (the former cannot be read). Precondition: as above.
  [[nodiscard]] Result<void> begin_rollback();
  [[nodiscard]] bool is_writing() const { return change_.has_value(); }
  // One erase or one page, written or read back; true when all is stored and verified. After an
  // error what is stored may be the old or the new: open() tells. Errors: kStorageFull,
  // kStorageFault, kNotErased, kRecordCorrupt (what was read back differs). Precondition:
  // is_writing().
  [[nodiscard]] Result<bool> step();

 private:
  enum class Stage : std::uint8_t {
    kFormat,
    kEraseLedger,
    kEraseRecord,
    kProgram,
    kVerify,
    kEnter,
    kSettle,
    kDone
  };
  // What is being changed, and how far it is.
  struct Change {
    // Said, as clang can't know of the defaults below before the class around them ends.
    Change() {}           // NOLINT(modernize-use-equals-default)
    bool writes = false;  // else a roll back
    LedgerEntry entry;    // from kEnter on
    Stage stage = Stage::kEraseLedger;
    std::size_t erased = 0;      // sectors of the record
    std::size_t programmed = 0;  // its pages
    std::size_t verified = 0;
  };

  [[nodiscard]] std::size_t record_pages() const;
  [[nodiscard]] std::size_t sectors_per_bank() const;
  [[nodiscard]] std::size_t ledger_sector(std::size_t bank) const;
  [[nodiscard]] std::size_t record_address(std::size_t bank) const;
  [[nodiscard]] bool was_never_used(const std::array<BankLedger, kStoreBanks>& ledgers);
  [[nodiscard]] std::uint8_t free_bank() const;
  [[nodiscard]] Result<void> format();
  [[nodiscard]] Result<void> settle(const std::array<BankLedger, kStoreBanks>& ledgers);
  [[nodiscard]] Result<void> fall_back();
  [[nodiscard]] Result<void> make_void(std::uint8_t bank);
  [[nodiscard]] Result<void> enter(LedgerEntry entry, std::size_t page);
  [[nodiscard]] LedgerEntry changed() const;
  [[nodiscard]] Result<void> advance(Change& change);
  [[nodiscard]] std::span<const std::uint8_t> page_of_image(std::size_t page);
  [[nodiscard]] Result<void> program_page(std::uint8_t bank, std::size_t page);
  [[nodiscard]] Result<void> verify(std::uint8_t bank, std::size_t page);

  hal::NonvolatileMemory& memory_;
  LedgerEntry entry_;         // the last one
  std::uint8_t at_bank_ = 0;  // where it is
  bool formatted_ = false;
  std::optional<Error> trouble_;
  std::optional<Change> change_;
  RecordImage image_{};
#ifndef ARMSIG_SMALL_IMAGE
  PersonsImage persons_{};
  std::array<std::uint8_t, kLargestPage> page_{};  // which may be of both
#endif
};

}  // namespace armsig::controller
