// SPDX-License-Identifier: MIT
// Rows in which a column stood still while the arm moved on: a sensor that repeats its last
// position, an encoder that is no longer read.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/host_tool/diagnosis/hypothesis.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestPositions = 3;
constexpr std::size_t kFewestReadings = 6;
// A joint moves where its reading changes by that, radians or metres.
constexpr double kMoves = 0.02;
// Of the other rows, those that repeat the reading of the row before: more, and the joint rests
// often.
constexpr double kRestsOften = 0.2;
// Of all rows: a column that stood still in more of them is not read at all.
constexpr double kMostOfRows = 0.5;

struct Run {
  std::size_t first = 0;
  std::size_t count = 0;
};

bool moves(const EvidenceRow& row, const EvidenceRow& before, std::size_t but) {
  for (std::size_t j = 0; j < row.q.size(); ++j) {
    if (j != but && std::abs(row.q[j] - before.q[j]) > kMoves) return true;
  }
  return false;
}

// The longest run of rows of which `repeats` says that it repeats the row before; `all` counts
// those that do.
template <typename Repeats>
Run longest_run(const std::vector<EvidenceRow>& rows, Repeats repeats, std::size_t& all) {
  Run longest;
  Run run{0, 1};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (repeats(rows[k], rows[k - 1])) {
      ++all;
      ++run.count;
    } else {
      run = {k, 1};
    }
    if (run.count > longest.count) longest = run;
  }
  return longest;
}

void add_run(const Evidence& evidence, const Run& run, const std::string& cause,
             const std::string& mend, std::vector<Hypothesis>& all) {
  const std::size_t first_line = evidence.rows[run.first].line;
  const std::size_t last_line = evidence.rows[run.first + run.count - 1].line;
  all.push_back({.cause = fmt::format("lines {} to {} have one {}", first_line, last_line, cause),
                 .undoing = "without those rows",
                 .mend = mend,
                 .surprise = 0.2,
                 .undo = [first_line, last_line](Evidence& e) {
                   std::erase_if(e.rows, [&](const EvidenceRow& row) {
                     return row.line >= first_line && row.line <= last_line;
                   });
                 }});
}

}  // namespace

std::vector<Hypothesis> hypotheses_of_frozen_rows(const Evidence& evidence) {
  std::vector<Hypothesis> all;
  const auto& rows = evidence.rows;
  const auto most = static_cast<std::size_t>(kMostOfRows * static_cast<double>(rows.size()));
  const std::size_t n = evidence.arm.joints.size();
  std::size_t repeated = 0;
  const Run still = longest_run(
      rows,
      [&](const EvidenceRow& row, const EvidenceRow& before) {
        return row.p_S == before.p_S && moves(row, before, n);
      },
      repeated);
  if (still.count >= kFewestPositions && still.count < most) {
    add_run(evidence, still, "position to the last digit while the joints move",
            "leave out those rows; look at what repeats the sensor's last position", all);
  }
  for (std::size_t j = 0; j < n; ++j) {
    repeated = 0;
    const Run run = longest_run(
        rows,
        [&](const EvidenceRow& row, const EvidenceRow& before) {
          return row.q[j] == before.q[j] && moves(row, before, j);
        },
        repeated);
    const auto others = static_cast<double>(rows.size() - run.count);
    const auto elsewhere = static_cast<double>(repeated + 1 - std::max<std::size_t>(1, run.count));
    if (run.count < kFewestReadings || run.count >= most || elsewhere > kRestsOften * others) {
      continue;
    }
    add_run(evidence, run,
            fmt::format("reading of joint {} to the last digit while other joints move", j + 1),
            fmt::format("leave out those rows; look at what repeats the last reading of joint {}",
                        j + 1),
            all);
  }
  return all;
}

}  // namespace armsig::tool
