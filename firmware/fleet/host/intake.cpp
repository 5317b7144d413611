// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/intake.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kAcknowledgeEvery_ms = 1'000;
constexpr std::uint64_t kRebirthEvery_ms = 5'000;
constexpr std::size_t kMostArms = 20'000;     // names that are believed
constexpr std::size_t kMostJournals = 64;     // of one arm
constexpr std::size_t kMostWaiting = 20'000;  // rows; what comes then is sent again
// What the record can hold: a clock may be wrong, and its row is stored all the same.
constexpr std::uint64_t kLatest_ms = 253'402'300'799'000;  // the end of the year 9999
// No quantity of an arm is larger, and smaller ones are zero: what a database multiplies of them
// neither overflows nor underflows.
constexpr double kLargestReal = 1e15;
constexpr double kSmallestReal = 1e-12;
constexpr std::uint64_t kLargest = ~std::uint64_t{0} >> 1U;

// A number that is none, or none of an arm, has no value.
Readings bounded(const Readings& told) {
  Readings readings;
  for (Reading reading : told) {
    if (auto* const real = std::get_if<double>(&reading.value)) {
      const double size = std::abs(*real);
      if (size < kSmallestReal) *real = 0;
      if (!(size <= kLargestReal)) reading.value = {};
    }
    readings.push_back(reading);
  }
  return readings;
}

}  // namespace

void Intake::begin(const std::vector<Journal>& journals) {
  end();
  ready_ = true;
  for (const Journal& known : journals) {
    arm_of(known.node).chains[known.journal] = {.taken = known.contiguous,
                                                .committed = known.contiguous};
  }
}

// Births are asked for again: what an arm told before may not have been stored.
void Intake::end() {
  ready_ = false;
  batch_ = {};
  for (auto& [node, arm] : arms_) {
    arm.born = false;
    arm.rebirth_due = true;
    arm.chains.clear();
  }
}

Intake::Arm& Intake::arm_of(std::string_view node) {
  const auto found = arms_.find(node);
  return found != arms_.end() ? found->second : arms_[std::string(node)];
}

void Intake::birth(std::string_view node, std::span<const std::byte> payload) {
  if (!ready_ || (arms_.size() >= kMostArms && !arms_.contains(node))) return;
  const auto report = decode_report(payload);
  if (!report || !report->bd_seq || report->seq != 0U) {
    ++counts_.malformed;
    return;
  }
  Arm& arm = arm_of(node);
  arm.born = true;
  arm.rebirth_due = false;
  arm.bd_seq = *report->bd_seq;
  arm.next_seq = 1;
  batch_.states.push_back({std::string(node), true, bounded(report->readings)});
}

// A late one, of a session that is over, says nothing.
void Intake::death(std::string_view node, std::span<const std::byte> payload) {
  const auto found = arms_.find(node);
  const auto report = decode_report(payload);
  if (found == arms_.end() || !found->second.born || !report ||
      report->bd_seq != found->second.bd_seq) {
    return;
  }
  found->second.born = false;
  batch_.states.push_back({std::string(node), false, {}});
}

void Intake::data(std::string_view node, std::span<const std::byte> payload) {
  if (!ready_ || (arms_.size() >= kMostArms && !arms_.contains(node))) return;
  Arm& arm = arm_of(node);
  const auto report = decode_report(payload);
  if (!report || !report->seq) {
    ++counts_.malformed;
    return;
  }
  if (!arm.born || report->seq != arm.next_seq) {
    arm.born = false;
    arm.rebirth_due = true;
    return;
  }
  arm.next_seq = (arm.next_seq + 1) % 256;
  take_row(node, arm, *report);
}

void Intake::take_row(std::string_view node, Arm& arm, const Report& report) {
  const auto journal = report.integer(Item::kJournal);
  const auto number = report.integer(Item::kNumber);
  const auto previous = report.integer(Item::kPrevious);
  if (!journal || !number || !previous || *number == 0 || *previous >= *number ||
      (*number >> 63U) != 0 ||
      (arm.chains.size() >= kMostJournals && !arm.chains.contains(*journal))) {
    ++counts_.malformed;
    return;
  }
  Chain& chain = arm.chains[*journal];
  chain.due = true;  // also where it is no news: the cabinet has to know how far we are
  if (*number <= chain.taken) {
    ++counts_.repeated;
  } else if (*previous > chain.taken || batch_.rows.size() >= kMostWaiting) {
    ++counts_.early;
  } else {
    ++counts_.rows;
    chain.taken = *number;
    StoredRow row{.node = std::string(node),
                  .journal = *journal,
                  .number = *number,
                  .dropped = std::min(report.integer(Item::kDropped).value_or(0), kLargest),
                  .time_ms = std::min(report.time_ms, kLatest_ms),
                  .historical = report.historical,
                  .readings = {}};
    for (const Reading& reading : bounded(report.readings)) {
      if (reading.item > Item::kDropped) row.readings.push_back(reading);
    }
    batch_.rows.push_back(std::move(row));
  }
}

Batch Intake::take_batch() { return std::exchange(batch_, {}); }

void Intake::stored(const Batch& batch) {
  for (const StoredRow& row : batch.rows) {
    Chain& chain = arm_of(row.node).chains[row.journal];
    chain.committed = std::max(chain.committed, row.number);
  }
}

std::vector<Intake::Acknowledgement> Intake::acknowledgements(std::uint64_t steady_ms) {
  std::vector<Acknowledgement> due;
  for (auto& [node, arm] : arms_) {
    if (!arm.born) continue;
    for (auto& [journal, chain] : arm.chains) {
      if (!chain.due || steady_ms - chain.told_ms < kAcknowledgeEvery_ms) continue;
      // Rows that are on their way into the record are told of when they are there.
      chain.due = chain.committed < chain.taken;
      chain.told_ms = steady_ms;
      due.push_back({node, journal, chain.committed});
    }
  }
  return due;
}

std::vector<std::string> Intake::rebirths(std::uint64_t steady_ms) {
  std::vector<std::string> due;
  if (!ready_) return due;
  for (auto& [node, arm] : arms_) {
    if (!arm.rebirth_due || arm.born || steady_ms - arm.rebirth_ms < kRebirthEvery_ms) continue;
    arm.rebirth_ms = steady_ms;
    ++counts_.rebirths;
    due.push_back(node);
  }
  return due;
}

std::size_t Intake::online() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(arms_, [](const auto& named) { return named.second.born; }));
}

}  // namespace armsig::fleet
