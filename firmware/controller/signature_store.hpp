// SPDX-License-Identifier: MIT
// The signatures of one arm in non-volatile memory: the active one, and the one before it.
// How they survive a loss of power is in record_store.hpp.
#pragma once

#include "firmware/controller/record_store.hpp"
#include "firmware/controller/signature_record.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

class SignatureStore {
 public:
  explicit SignatureStore(hal::NonvolatileMemory& memory) : records_(memory) {}

  // Whether the memory has room for the store, and pages that suit.
  [[nodiscard]] bool fits() const { return records_.fits(); }
  [[nodiscard]] std::size_t sectors() const { return records_.sectors(); }

  // Settles what a power loss left in doubt, and loads the active record; after an error `record`
  // is of no use.
  // Errors: kNoSignature (none is stored, or the last one was rolled back), kRecordCorrupt,
  // kStorageFault (something is stored that cannot be read), kRecordUnsuitable (it is of an arm
  // with other joints), kAddressOutOfRange (the memory does not fit).
  [[nodiscard]] Result<void> load(const Arm& drawing, SignatureRecord& record);
  // CRC-32 at the end of the active record. Precondition: load() has found one.
  [[nodiscard]] std::uint32_t active_crc() const { return records_.active()->crc; }
  // What load() met although it found a record: as RecordStore::trouble().
  [[nodiscard]] std::optional<Error> trouble() const { return records_.trouble(); }

  // Begins to store `record` after the active one, with the next number. Precondition: load() was
  // called, fits(), not is_writing().
  void begin_write(const SignatureRecord& record) {
    const std::uint32_t sequence = records_.next_sequence();
    RecordImage& image = records_.begin_write();
    encode(record, sequence, image);
#ifndef ARMSIG_SMALL_IMAGE
    records_.persons() = encode(record.persons, crc_of(image));
#endif
  }
  // Begins to go back to the record before the active one, or to none. Errors: kNoSignature (none
  // is active), kStorageFault, kRecordCorrupt (the one before cannot be read). Precondition: as
  // above.
  [[nodiscard]] Result<void> begin_rollback() { return records_.begin_rollback(); }
  [[nodiscard]] bool is_writing() const { return records_.is_writing(); }
  // One erase or one page; true when all is stored and verified. On an error the write has ended,
  // and load() tells what is active. Errors: kStorageFull, kStorageFault, kStorageReplaced,
  // kNotErased, kRecordCorrupt (what was read back differs). Precondition: is_writing().
  [[nodiscard]] Result<bool> step() { return records_.step(); }

 private:
  RecordStore records_;
};

}  // namespace armsig::controller
