// SPDX-License-Identifier: MIT
// What the host makes of the messages of all cabinets: which rows are new and in their order, what
// is to be stored, acknowledged, asked for again. Nothing of MQTT, of the database or of time but
// what it is told.
//
// A row is taken where the one before it is there: a cabinet sends in order, and again from the
// last acknowledged row, so that nothing out of order needs to be kept.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/fleet/wire/payload.hpp"

namespace armsig::fleet {

struct StoredRow {
  std::string node;
  std::uint64_t journal = 0;
  std::uint64_t number = 0;
  std::uint64_t dropped = 0;
  std::uint64_t time_ms = 0;
  bool historical = false;
  Readings readings;
};

// An arm came, went, or told everything anew.
struct StoredState {
  std::string node;
  bool online = false;
  Readings current;
};

struct Batch {
  std::vector<StoredState> states;
  std::vector<StoredRow> rows;
  [[nodiscard]] bool empty() const { return states.empty() && rows.empty(); }
};

class Intake {
 public:
  struct Counts {
    std::uint64_t rows = 0;      // taken
    std::uint64_t repeated = 0;  // came once more
    std::uint64_t early = 0;     // without the one before
    std::uint64_t malformed = 0;
    std::uint64_t rebirths = 0;  // asked for
  };
  struct Journal {
    std::string node;
    std::uint64_t journal = 0;
    std::uint64_t contiguous = 0;
  };
  struct Acknowledgement {
    std::string node;
    std::uint64_t journal = 0;
    std::uint64_t number = 0;
  };

  // The record is there, and holds these; until then nothing is taken.
  void begin(const std::vector<Journal>& journals);
  // The record is gone, and what was not confirmed with it.
  void end();

  void birth(std::string_view node, std::span<const std::byte> payload);
  void data(std::string_view node, std::span<const std::byte> payload);
  void death(std::string_view node, std::span<const std::byte> payload);

  // What is to be stored in one transaction; then stored(), or end().
  [[nodiscard]] Batch take_batch();
  void stored(const Batch& batch);
  [[nodiscard]] const Batch& waiting() const { return batch_; }

  // Rows that are committed, each journal at most once a second.
  [[nodiscard]] std::vector<Acknowledgement> acknowledgements(std::uint64_t steady_ms);
  // Cabinets that must tell everything anew, each at most once in five seconds.
  [[nodiscard]] std::vector<std::string> rebirths(std::uint64_t steady_ms);

  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] std::size_t online() const;

 private:
  struct Chain {
    std::uint64_t taken = 0;  // up to here stored or in the batch
    std::uint64_t committed = 0;
    bool due = false;
    std::uint64_t told_ms = 0;
  };
  struct Arm {
    bool born = false;
    bool rebirth_due = false;
    std::uint64_t rebirth_ms = 0;
    std::uint64_t bd_seq = 0;
    std::uint64_t next_seq = 0;
    std::map<std::uint64_t, Chain> chains;  // by journal; a few over an arm's life
  };

  Arm& arm_of(std::string_view node);
  void take_row(std::string_view node, Arm& arm, const Report& report);

  bool ready_ = false;
  std::map<std::string, Arm, std::less<>> arms_;
  Batch batch_;
  Counts counts_;
};

}  // namespace armsig::fleet
