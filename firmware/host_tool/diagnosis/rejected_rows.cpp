// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/rejected_rows.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

// Of 103 sound sets none came near to either.
constexpr double kRejectedTooOften = 0.1;
constexpr std::size_t kFewestRejected = 3;
constexpr std::size_t kLongestRun = 5;

// Of the rows that were rejected, so many are those that it leaves out.
constexpr double kAreThose = 0.8;

// What the columns show of those rows without any fit.
void say_what_is_frozen(const Evidence& evidence, const std::vector<std::size_t>& lines,
                        Doubt& doubt) {
  for (const Hypothesis& frozen : hypotheses_of_frozen_rows(evidence)) {
    Evidence others = evidence;
    frozen.undo(others);
    const auto left = std::ranges::count_if(others.rows, [&](const EvidenceRow& row) {
      return std::ranges::binary_search(lines, row.line);
    });
    if (static_cast<double>(left) > (1 - kAreThose) * static_cast<double>(lines.size())) continue;
    doubt.cause = frozen.cause;
    doubt.expected = frozen.mend;
    return;
  }
}

}  // namespace

RejectedRows rejected_rows(const Evidence& evidence, const std::vector<std::size_t>& lines) {
  RejectedRows found;
  std::size_t run = 0;
  std::size_t first_line = 0;
  for (const EvidenceRow& row : evidence.rows) {
    const bool rejected = std::ranges::binary_search(lines, row.line);
    found.free_poses += row.sweep == 0;
    found.free_rejected += row.sweep == 0 && rejected;
    if (!rejected) run = 0;
    if (!rejected) continue;
    if (run++ == 0) first_line = row.line;
    if (run <= found.run) continue;
    found.run = run;
    found.first_line = first_line;
    found.last_line = row.line;
  }
  return found;
}

std::optional<Doubt> doubt_of_rejected(const Evidence& evidence,
                                       const std::vector<std::size_t>& lines) {
  if (evidence.located) return std::nullopt;
  const RejectedRows rejected = rejected_rows(evidence, lines);
  const double share = rejected.free_poses == 0 ? 0
                                                : static_cast<double>(rejected.free_rejected) /
                                                      static_cast<double>(rejected.free_poses);
  Doubt doubt;
  if (rejected.free_rejected >= kFewestRejected && share >= kRejectedTooOften) {
    doubt.what = fmt::format("{} of the {} free poses ({:.0f} %) would be thrown out as outliers",
                             rejected.free_rejected, rejected.free_poses, 100 * share);
  } else if (rejected.run >= kLongestRun) {
    doubt.what = fmt::format(
        "{} rows that follow each other (lines {} to {}) would be thrown out "
        "as outliers",
        rejected.run, rejected.first_line, rejected.last_line);
  } else {
    return std::nullopt;
  }
  doubt.expected =
      "few outliers, and scattered: look at what those poses have in common, and leave out only "
      "what was measured wrongly; or --accept-different-arm";
  say_what_is_frozen(evidence, lines, doubt);
  return doubt;
}

}  // namespace armsig::tool
