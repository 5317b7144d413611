// SPDX-License-Identifier: MIT
// Two slots for signatures in non-volatile memory, of which a power loss at any moment spoils at
// most the one that is not active.
//
// A slot is a whole number of sectors: the record, page by page, then one page that revokes it.
// Active is the valid, unrevoked record with the largest sequence number. A new one goes to the
// other slot: erased, programmed, read back. Rolling back programs the revoking page of the active
// slot, and the other becomes active: nothing is erased, and a page cut short revokes nothing.
#pragma once

#include <optional>

#include "firmware/controller/signature_record.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

// How far the writing of a record is.
struct RecordWriting {
  RecordImage image{};
  std::size_t slot = 0;
  std::size_t erased = 0;  // sectors
  std::size_t pages = 0;   // programmed
};

class SignatureStore {
 public:
  static constexpr std::size_t kLargestPage = 512;

  explicit SignatureStore(hal::NonvolatileMemory& memory) : memory_(memory) {}

  // Whether the memory has room for two slots, and pages that suit.
  [[nodiscard]] bool fits() const;

  // Looks at both slots and loads the active record.
  // Errors: kNoSignature (none is valid), kRecordCorrupt (none is valid, but something is stored),
  // kRecordUnsuitable, kStorageFault, kAddressOutOfRange (the memory does not fit).
  [[nodiscard]] Result<void> load(const Arm& drawing, SignatureRecord& record);

  // Begins to store `record` after the active one, with its number plus one. Precondition: load()
  // was called, fits(), not is_writing().
  void begin_write(const SignatureRecord& record);
  [[nodiscard]] bool is_writing() const { return writing_.has_value(); }
  // One erase or one page; true when all is stored and verified. On an error the write has ended
  // and the active record is as before. Errors: kStorageFull, kStorageFault, kNotErased,
  // kRecordCorrupt (what was read back differs). Precondition: is_writing().
  [[nodiscard]] Result<bool> step_write();

  // Revokes the active record. Errors: kNoSignature (none is active), kStorageFull, kStorageFault,
  // kNotErased.
  [[nodiscard]] Result<void> revoke();

 private:
  [[nodiscard]] std::size_t record_pages() const;
  [[nodiscard]] std::size_t sectors_per_slot() const;
  [[nodiscard]] std::size_t address(std::size_t slot) const;
  [[nodiscard]] Result<RecordImage> read_image(std::size_t slot);
  [[nodiscard]] Result<bool> is_revoked(std::size_t slot, const RecordImage& image);
  [[nodiscard]] Result<void> program(std::size_t address, std::span<const std::uint8_t> bytes);

  hal::NonvolatileMemory& memory_;
  std::optional<std::size_t> active_;  // slot
  std::uint32_t newest_ = 0;           // sequence number, of all valid records
  std::optional<RecordWriting> writing_;
};

}  // namespace armsig::controller
