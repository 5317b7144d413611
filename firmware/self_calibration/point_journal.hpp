// SPDX-License-Identifier: MIT
// What a self-calibration has measured, kept across halts, faults and restarts in a non-volatile
// memory of its own: a run that is asked for again goes the same way, and where it has been before
// it need not go.
//
// A page a point, behind a page that says of which machine and configuration they are. Each tells
// the CRC of the page before it, so that nothing of another run is taken for this one's, and has a
// CRC of its own. A sector is erased when the first of its pages is written. A page that does not
// hold (torn, worn, or of a way that is not gone again) leaves the rest of its sector unused.
#pragma once

#include <array>
#include <optional>

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/refinement.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {

class PointJournal {
 public:
  static constexpr std::size_t kPageBytes = 256;
  // 2,047 points.
  static constexpr hal::MemoryLayout kLayout{
      .page_bytes = kPageBytes, .pages_per_sector = 16, .sectors = 128};

  // Of pages of kPageBytes; outlives it.
  explicit PointJournal(hal::NonvolatileMemory& memory);

  // A run begins on `machine`. The number of points that an earlier one has left for it, 0: none,
  // or they are not wanted (`anew`). Errors, after which it begins without any: kRecordCorrupt,
  // kRecordOtherMachine, kRecordUnsuitable (another configuration), and those of
  // NonvolatileMemory. Reads all pages at most, writes a sector and a page.
  [[nodiscard]] Result<std::size_t> begin(const Configuration& configuration,
                                          const Machine& machine, bool anew);

  // What the earlier run has from `wanted` in `sweep`, where it went there next; empty from the
  // first pose on of which it has nothing. Precondition: begin().
  [[nodiscard]] std::optional<KeptPoint> next(std::size_t sweep, const JointVector& wanted);

  // The next one, of this run. Precondition: next() has been empty. Errors: kStorageFull (of the
  // device, or of these pages), those of NonvolatileMemory; nothing is kept any more from then on.
  [[nodiscard]] Result<void> keep(const KeptPoint& kept);

  // The run has come to its end. Precondition: begin(). Errors: those of NonvolatileMemory.
  [[nodiscard]] Result<void> forget();

 private:
  using Page = std::array<std::uint8_t, kPageBytes>;

  [[nodiscard]] std::size_t pages() const {
    return memory_.layout().sectors * memory_.layout().pages_per_sector;
  }
  [[nodiscard]] bool begins_sector() const { return at_ % memory_.layout().pages_per_sector == 0; }
  void to_next_sector() {
    at_ += memory_.layout().pages_per_sector - at_ % memory_.layout().pages_per_sector;
  }
  [[nodiscard]] Result<Page> read(std::size_t page) const;
  [[nodiscard]] Result<void> write(Page& page, std::size_t crc_at);
  [[nodiscard]] Result<bool> look_at_header(const Page& header);
  [[nodiscard]] Result<void> write_header(bool of_a_run);
  // The point of that page, if it follows the page before.
  [[nodiscard]] std::optional<KeptPoint> point_in(const Page& page);
  // The next point that holds, wherever it was measured; at_ is its page then, else where the next
  // one is to be written.
  [[nodiscard]] std::optional<KeptPoint> find();

  hal::NonvolatileMemory& memory_;
  std::uint32_t machine_ = 0;  // CRC
  std::uint32_t set_up_ = 0;   // CRC
  std::uint32_t number_ = 0;   // of the run, so that no two headers are alike
  std::size_t joints_ = 0;
  std::size_t at_ = 0;        // page
  std::uint32_t before_ = 0;  // CRC of the page before it
  std::uint32_t found_ = 0;   // CRC of the page at it, where find() has found one
  bool keeps_ = false;
};

}  // namespace armsig::controller
