// SPDX-License-Identifier: MIT
// The last seconds before a fault, every tick, kept in memory and written to a file that a person
// can plot.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/controller/latest_value.hpp"
#include "firmware/controller/link.hpp"
#include "firmware/linux/journal.hpp"

namespace armsig::daemon {

struct BlackBoxConfiguration {
  std::string folder;  // made when it is needed; the newest kMostFiles of ours stay in it
  std::string name;    // of the controller
  JointTypes joints;
  hal::Duration period{};
  hal::Duration before = std::chrono::seconds(10);  // the fault
  hal::Duration after = std::chrono::milliseconds(500);
};

// take() is of the servo thread and never waits; write_if_due() is of a thread that may. Two
// recordings take turns: one is filled while the other is written.
class BlackBox final : public controller::TickObserver {
 public:
  static constexpr std::size_t kMostFiles = 16;

  // Allocates here and never again but to write a file.
  BlackBox(const BlackBoxConfiguration& configuration, Journal& journal);

  // Writes a recording that is complete, and logs the name of the file or why there is none.
  void write_if_due();

  // The file written last; empty: none. By one thread, the same always.
  [[nodiscard]] std::string_view last_file() const {
    const Path& path = last_file_.read();
    return {path.data(), path.size()};
  }

 private:
  using Path = FixedVector<char, 256>;

  struct Row {
    hal::Instant at;
    hal::Duration lateness{};
    controller::Mode mode = controller::Mode::kStarting;
    std::uint8_t limits_active = 0;
    std::uint8_t known = 0;
    std::array<double, kMaxJoints> actual{};
    std::array<double, kMaxJoints> commanded{};
    std::array<std::uint16_t, kMaxJoints> status_words{};
  };
  struct Recording {
    std::vector<Row> rows;  // a ring
    std::size_t next = 0;
    std::size_t count = 0;
    controller::Fault fault;
    hal::Instant fault_at;
  };

  void do_take(const controller::Snapshot& snapshot, hal::Duration lateness) override;
  void add(Recording& recording, const controller::Snapshot& snapshot,
           hal::Duration lateness) const;
  // Zero, or errno where there is no such file then.
  [[nodiscard]] int write(const Recording& recording, const std::string& path) const;
  // Throws what fmt throws.
  void print(const Recording& recording, std::FILE* file) const;
  void remove_old_files() const;

  BlackBoxConfiguration configuration_;
  Journal& journal_;
  std::array<Recording, 2> recordings_;
  std::size_t filling_ = 0;          // of the servo thread
  std::size_t left_ = 0;             // ticks until the recording is complete; 0: no fault yet
  bool was_faulted_ = false;         // in the tick before
  std::atomic<int> complete_{-1};    // the recording to be written; -1: none
  std::atomic<unsigned> missed_{0};  // faults while a recording was still being written
  unsigned told_missed_ = 0;
  mutable controller::LatestValue<Path> last_file_;
};

}  // namespace armsig::daemon
