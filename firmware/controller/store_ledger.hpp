// SPDX-License-Identifier: MIT
// The ledger of the store: which record is active, and which one was before it.
//
// Each bank of the store begins with a ledger sector. Its entries are pages of the first 32 bytes,
// little-endian; of all that are valid, the one with the largest number says what is stored:
//
//   offset  bytes
//        0      4  magic "ALED"
//        4      2  version, 2
//        6      1  kind: 0 void (says nothing), 1 entered, 2 settled
//        7      1  zero
//        8      4  number of the entry
//       12      4  sequence number of the last record that was ever stored
//       16      1  bank of the active record; FFh: none
//       17      1  bank of the one before it; FFh: none
//       18      2  zero
//       20      4  CRC-32 at the end of the active record
//       24      4  CRC-32 at the end of the one before it
//       28      4  CRC-32 of all before
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/error.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

inline constexpr std::uint8_t kStoreBanks = 3;

// A record in a bank, bound by its own CRC.
struct StoredRecord {
  std::uint8_t bank = 0;
  std::uint32_t crc = 0;

  friend bool operator==(const StoredRecord&, const StoredRecord&) = default;
};

enum class LedgerKind : std::uint8_t {
  kVoid,     // nothing is under way in this bank
  kEntered,  // what it says is so, once it can be read
  kSettled,  // the same; written only when one that was entered stands whole on the device
};

struct LedgerEntry {
  LedgerKind kind = LedgerKind::kVoid;
  std::uint32_t number = 0;
  std::uint32_t newest = 0;  // sequence number of the last record
  std::optional<StoredRecord> active;
  std::optional<StoredRecord> former;

  friend bool operator==(const LedgerEntry&, const LedgerEntry&) = default;
};

inline constexpr std::size_t kLedgerEntryBytes = 32;
using LedgerImage = std::array<std::uint8_t, kLedgerEntryBytes>;

[[nodiscard]] LedgerImage encode(const LedgerEntry& entry);
// Empty: no valid entry.
[[nodiscard]] std::optional<LedgerEntry> decode(const LedgerImage& image);

// What the ledger sector of one bank holds.
struct BankLedger {
  std::optional<LedgerEntry> entry;  // the one with the largest number, that is not void
  bool settled = false;              // an entry with that number is settled
  bool intact = false;               // it holds any valid entry
  bool unreadable = false;           // a page cannot be read
  std::size_t strange = 0;           // pages that can be read, and are neither erased nor valid
  std::size_t next_page = 0;         // after the last one that is not erased
};

[[nodiscard]] bool is_erased(std::span<const std::uint8_t> bytes);
[[nodiscard]] BankLedger read_ledger(hal::NonvolatileMemory& memory, std::size_t sector);

// Programs the entry and reads it back. Errors: those of program_page(), kRecordCorrupt (it reads
// otherwise).
[[nodiscard]] Result<void> write_entry(hal::NonvolatileMemory& memory, std::size_t sector,
                                       std::size_t page, const LedgerEntry& entry);

// Reads again where a read fails, a few times. Errors: those of read().
[[nodiscard]] Result<void> read_patiently(hal::NonvolatileMemory& memory, std::size_t address,
                                          std::span<std::uint8_t> into);

// The page at `address`: `bytes`, and the rest erased. Precondition: no more than a page of at most
// kLargestPage. Errors: those of program_page().
inline constexpr std::size_t kLargestPage = 512;
[[nodiscard]] Result<void> program_padded(hal::NonvolatileMemory& memory, std::size_t address,
                                          std::span<const std::uint8_t> bytes);

}  // namespace armsig::controller
