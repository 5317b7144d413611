// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/table.hpp"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

Table measurements() {
  Table table({"Joint", "Found by the fit mm", "Stated sigma mm"});
  table.add_row({"shoulder of the arm", "1.25", "0.10"});
  table.add_row({"wrist", "-0.5", "12.125"});
  return table;
}

std::size_t widest(const std::string& text) {
  std::istringstream lines(text);
  std::size_t most = 0;
  for (std::string line; std::getline(lines, line);) {
    most = std::max(most, static_cast<std::size_t>(std::ranges::count_if(line, [](char c) {
                      return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
                    })));
  }
  return most;
}

TEST(TableOfText, stands_as_it_is_where_there_is_room) {
  EXPECT_EQ(measurements().render(2, 80),
            "  Joint                 Found by the fit mm   Stated sigma mm\n"
            "  ───────────────────   ───────────────────   ───────────────\n"
            "  shoulder of the arm                  1.25              0.10\n"
            "  wrist                                -0.5            12.125\n");
}

TEST(TableOfText, breaks_headings_before_words_and_never_a_number) {
  EXPECT_EQ(measurements().render(0, 43),
            "                      Found by\n"
            "                       the fit       Stated\n"
            "Joint                       mm     sigma mm\n"
            "───────────────────  ─────────  ───────────\n"
            "shoulder of the arm       1.25         0.10\n"
            "wrist                     -0.5       12.125\n");
}

TEST(TableOfText, has_no_sign_before_nought) {
  Table table({"Joint", "d mm", "α °"});
  table.add_row({"wrist", "-0.00*", "-0.000 ± 0.002"});
  table.add_row({"elbow", "-0.01", "-10.00"});
  EXPECT_EQ(table.render(0, 80),
            "Joint    d mm             α °\n"
            "─────   ─────   ─────────────\n"
            "wrist   0.00*   0.000 ± 0.002\n"
            "elbow   -0.01          -10.00\n");
}

TEST(TableOfText, fits_every_width_down_to_its_words_and_numbers) {
  const std::string narrowest = measurements().render(2, 1);
  EXPECT_EQ(widest(narrowest), 2U + 8 + 1 + 5 + 1 + 6);
  for (std::size_t width = widest(narrowest); width < 70; ++width) {
    const std::string text = measurements().render(2, width);
    EXPECT_LE(widest(text), width) << text;
    for (const char* number : {"1.25", "0.10", "-0.5", "12.125", "shoulder"}) {
      EXPECT_NE(text.find(number), std::string::npos) << text;
    }
  }
}

}  // namespace
}  // namespace armsig::tool
