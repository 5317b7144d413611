// SPDX-License-Identifier: MIT
// Flash as unkind as the real one: power goes in the middle of any operation and leaves pages torn,
// sectors wear out, pages rot.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::simulated {

// What an operation leaves when the power goes after some of its bytes. Pages of the last four are
// torn until their sector is erased whole, also where they read well by chance.
enum class Tearing : std::uint8_t {
  kForward,      // the first bytes are done
  kBackward,     // the last bytes are done
  kAnyOrder,     // some bytes are done, in no order
  kPartialBits,  // the first bytes are done, and some bits of all others
  kUnreadable,   // pages that are not done answer read errors
  kUnstable,     // they read as before or as after, in turn from one power-up to the next
  kFlickering,   // they read as a mixture of before and after, another at each read
  kWholeBlock,   // every sector of the erase block of the card below answers read errors
};
inline constexpr std::size_t kTearings = 8;

struct FlashConfiguration {
  hal::MemoryLayout layout{.page_bytes = 256, .pages_per_sector = 8, .sectors = 10};
  std::size_t block_sectors = 3;      // that a card erases together, whatever it is told
  std::uint32_t endurance = 100'000;  // erases of a sector; the next one fails and changes nothing
  Tearing tearing = Tearing::kForward;
  std::uint64_t seed = 1;
};

class Flash final : public hal::NonvolatileMemory {
 public:
  static constexpr std::size_t kCapacity = std::size_t{20} * 1024;
  static constexpr std::size_t kMostPages = 128;
  static constexpr std::size_t kLargestPage = 512;

  // Erased. Preconditions: at most kCapacity bytes, kMostPages pages of at most
  // kLargestPage.
  explicit Flash(const FlashConfiguration& configuration = {});

  // The power goes when so many more bytes have been changed; every call fails from then on.
  void cut_power_after(std::size_t bytes, Tearing tearing);
  // Power is back. Preconditions: none; also without a cut, as a restart.
  void power_up();
  [[nodiscard]] bool has_power() const { return powered_; }
  // Bytes changed since the beginning.
  [[nodiscard]] std::size_t changed() const { return changed_; }
  [[nodiscard]] std::size_t erases(std::size_t sector) const { return erases_[sector]; }

  // The erase or program after `count` more answers kStorageFault, power staying on, and leaves
  // what a tear after `bytes` would.
  void fail_after(std::size_t count, std::size_t bytes) {
    fails_ = {.count = count, .bytes = bytes};
  }
  // A page that has lost its charge: read errors until its sector is erased.
  void rot(std::size_t address) { states_[address / configuration_.layout.page_bytes] = kLost; }

 private:
  enum PageState : std::uint8_t { kWhole, kLost, kInTurn, kAtRandom };
  struct Failure {
    std::size_t count = 0;
    std::size_t bytes = 0;
  };

  [[nodiscard]] hal::MemoryLayout do_layout() const override { return configuration_.layout; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override;
  Result<void> do_erase_sector(std::size_t sector) override;
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override;

  // Changes [address, address + count) to `to`, or to kErasedByte where that is null.
  Result<void> change(std::size_t address, std::size_t count, const std::uint8_t* to);
  void tear(std::size_t address, std::size_t count, const std::uint8_t* to, std::size_t done);
  void tear_bytes(std::size_t address, std::size_t count, const std::uint8_t* to, std::size_t done);
  void tear_pages(std::size_t address, std::size_t count, const std::uint8_t* to, std::size_t done,
                  PageState state);
  [[nodiscard]] std::uint32_t random();

  FlashConfiguration configuration_;
  std::array<std::uint8_t, kCapacity> bytes_{};
  std::array<std::uint8_t, kCapacity> before_{};  // of torn pages
  std::array<PageState, kMostPages> states_{};
  std::array<std::uint32_t, kMostPages> erases_{};
  std::optional<std::size_t> left_;
  std::optional<Failure> fails_;
  std::size_t changed_ = 0;
  std::uint32_t power_ups_ = 0;
  std::uint64_t random_;
  bool powered_ = true;
};

}  // namespace armsig::simulated
