// SPDX-License-Identifier: MIT
// Cells of a line and numbers of a table: every byte is understood, or the line is refused.
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/formats/table_cells.hpp"
#include "firmware/formats/table_numbers.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

using Texts = std::vector<std::string>;

Texts split(std::string_view line, char separator, Quotes quotes = Quotes::kEnclose) {
  Texts texts;
  for (Cells cells(line, separator, quotes); cells.next();) texts.emplace_back(cells.text());
  return texts;
}

bool is_well_quoted(std::string_view line) {
  Cells cells(line, ',');
  while (cells.next()) {
  }
  return cells.well_quoted();
}

TEST(Cells, are_what_stands_between_separators) {
  EXPECT_EQ(split("a, b\t,c", ','), (Texts{"a", "b", "c"}));
  EXPECT_EQ(split(",a,", ','), (Texts{"", "a", ""}));
  EXPECT_EQ(split("", ','), (Texts{""}));
  EXPECT_EQ(split(" a\t b \t", '\t'), (Texts{"a", "b", ""}));
  EXPECT_EQ(split(" a  b\tc ", kBlanks), (Texts{"a", "b", "c"}));
  EXPECT_EQ(split("  ", kBlanks), Texts{});
}

TEST(Cells, in_quotes_hold_separators_and_quotes) {
  EXPECT_EQ(split(R"("a,b", "c ""d""" ,e)", ','), (Texts{"a,b", "c \"d\"", "e"}));
  EXPECT_EQ(split(R"(A "Sweep 1" P1)", kBlanks), (Texts{"A", "Sweep 1", "P1"}));
  EXPECT_EQ(split(R"("a,b")", ',', Quotes::kAreText), (Texts{"\"a", "b\""}));
  // An inch is no quote.
  EXPECT_EQ(split(R"(1.5" nest,2)", ','), (Texts{"1.5\" nest", "2"}));
  EXPECT_TRUE(is_well_quoted(R"("a","b")"));
  for (const char* wrong : {R"("a,b)", R"("a"b,c)", R"("a" "b")", R"("""a)"}) {
    EXPECT_FALSE(is_well_quoted(wrong)) << wrong;
  }
}

TEST(Cells, have_the_positions_of_their_first_bytes) {
  for (const char separator : {',', kBlanks}) {
    Cells cells(separator == ',' ? " ab,  c" : " ab   c", separator);
    ASSERT_TRUE(cells.next());
    EXPECT_EQ(cells.position(), 1U);
    ASSERT_TRUE(cells.next());
    EXPECT_EQ(cells.position(), 6U);
    EXPECT_FALSE(cells.next());
  }
}

// Of any line without quotes the cells stand where they say, and what stands between them is one
// separator and blanks.
TEST(Cells, leave_no_byte_of_a_line_over) {
  std::mt19937 random(1);
  const std::string letters = "a1.,; \t-";
  for (const char separator : {',', ';', '\t', kBlanks}) {
    for (int run = 0; run < 2000; ++run) {
      std::string line;
      for (auto length = random() % 12; length > 0; --length) {
        line += letters[random() % letters.size()];
      }
      std::string rest = line;  // of which the cells are taken
      std::size_t count = 0;
      for (Cells cells(line, separator); cells.next(); ++count) {
        ASSERT_EQ(line.substr(cells.position(), cells.text().size()), cells.text()) << line;
        rest.replace(cells.position(), cells.text().size(), cells.text().size(), '_');
      }
      std::size_t separators = 0;
      for (const char c : rest) {
        separators += c == separator && separator != kBlanks ? 1 : 0;
        ASSERT_TRUE(c == separator || c == '_' || c == ' ' || c == '\t') << line;
      }
      if (separator != kBlanks) {
        ASSERT_EQ(count, separators + 1) << line;
      }
    }
  }
}

std::string plain(TableNumbers& numbers, const char* text) {
  const auto spelt = numbers.plain(text, "X", 3);
  return spelt ? *spelt : render(spelt.error());
}

TEST(TableNumbers, have_decimal_points_or_commas) {
  TableNumbers commas(';');
  EXPECT_EQ(plain(commas, "-12,5"), "-12.5");
  EXPECT_EQ(plain(commas, "7"), "7");
  EXPECT_NE(plain(commas, "7.5").find("has another decimal separator than the lines before"),
            std::string::npos);
  TableNumbers points(';');
  EXPECT_EQ(plain(points, "7.5"), "7.5");
  EXPECT_NE(plain(points, "7,5").find("has another decimal separator"), std::string::npos);
  TableNumbers between(',');
  EXPECT_NE(plain(between, "7,5").find("may have a decimal comma or a thousands separator"),
            std::string::npos);
  for (const char* thousands : {"1.234,5", "1,234.5", "1,234,567"}) {
    TableNumbers numbers(';');
    EXPECT_NE(plain(numbers, thousands).find("has more than a decimal separator"),
              std::string::npos)
        << thousands;
  }
}

// 1,234 and 812 in one column are a thousand and hundreds; 1,234 and 812,000 need not be.
TEST(TableNumbers, with_three_decimals_in_some_rows_only_may_have_thousands) {
  for (const char sign : {',', '.'}) {
    const std::string big = std::string("1") + sign + "234";
    TableNumbers thousands(';');
    EXPECT_EQ(plain(thousands, big.c_str()), "1.234");
    EXPECT_EQ(plain(thousands, "812"), "812");
    const Problem refused = test::failure_of(thousands.finish());
    EXPECT_NE(render(refused).find("X: \"" + big + "\" may have a thousands separator"),
              std::string::npos);
    EXPECT_EQ(refused.line, 3);
    TableNumbers all(';');
    EXPECT_EQ(plain(all, big.c_str()), "1.234");
    EXPECT_EQ(plain(all, (std::string("812") + sign + "000").c_str()), "812.000");
    EXPECT_TRUE(all.finish());
    // A fourth decimal, or a leading zero, tells what the sign is.
    for (const std::string& telling :
         {std::string("1") + sign + "2345", std::string("0") + sign + "234"}) {
      TableNumbers told(';');
      EXPECT_NE(plain(told, big.c_str()), "");
      EXPECT_NE(plain(told, telling.c_str()), "");
      EXPECT_NE(plain(told, "812"), "");
      EXPECT_TRUE(told.finish()) << telling;
    }
  }
}

}  // namespace
}  // namespace armsig::tool
