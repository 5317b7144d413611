// SPDX-License-Identifier: MIT
// docs/messages.md has a row for every error, and no other.
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace armsig {
namespace {

std::vector<std::string> cells(const std::string& row) {
  std::vector<std::string> cells;
  for (std::size_t start = 2; start < row.size();) {
    const std::size_t stop = std::min(row.find(" |", start), row.size());
    cells.push_back(row.substr(start, stop - start));
    start = stop + 3;
  }
  return cells;
}

std::vector<std::vector<std::string>> rows_of_the_tables() {
  std::ifstream file(ARMSIG_DOCS "/messages.md");
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| ") && !line.starts_with("| message |")) rows.push_back(cells(line));
  }
  return rows;
}

// Every value of the enumeration: describe() knows no other.
std::set<std::string> phrases() {
  std::set<std::string> phrases;
  for (int value = 0; value < 256; ++value) {
    const std::string phrase(describe(static_cast<Error>(value)));
    if (phrase != "unknown error") phrases.insert(phrase);
  }
  return phrases;
}

TEST(Messages, of_every_error_are_in_the_table_with_a_meaning_and_a_remedy) {
  std::set<std::string> documented;
  for (const auto& row : rows_of_the_tables()) {
    ASSERT_EQ(row.size(), 3U) << row.front();
    EXPECT_FALSE(row[1].empty()) << row.front();
    EXPECT_FALSE(row[2].empty()) << row.front();
    EXPECT_TRUE(documented.insert(row[0]).second) << "twice: " << row[0];
  }
  EXPECT_EQ(documented, phrases());
}

}  // namespace
}  // namespace armsig
