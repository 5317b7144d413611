// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/program_picture.hpp"

#include <regex>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

Arrival arrival(int line, const Vector3& target_m, const Vector3& miss_m) {
  Arrival arrival{line, "p" + std::to_string(line), {}, {}};
  arrival.X_CT.p = target_m;
  arrival.X_CA.p = target_m + miss_m;
  return arrival;
}

const Arrivals kBefore{
    {arrival(3, {0.4, 0, 0.2}, {3e-3, 0, 4e-3}), arrival(4, {0.4, 0.3, 0.2}, {0, 1e-3, 0}),
     arrival(7, {0.6, 0.3, 0.1}, {0, 0, 3e-3})},
    {}};
const Arrivals kAfter{
    {arrival(3, {0.4, 0, 0.2}, {0, 0, 0}), arrival(7, {0.6, 0.3, 0.1}, {0, 0, 0})}, {}};

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
  return found;
}

TEST(ProgramPicture, says_by_how_much_the_tool_misses_before_and_after) {
  const std::string svg = program_picture({kBefore, &kAfter}, "part");
  EXPECT_NE(svg.find("As it is: missed by 3.000 mm in the mean, 5.000 mm at most"), svg.npos);
  EXPECT_NE(svg.find("Corrected: missed by 0.000 mm in the mean, 0.000 mm at most"), svg.npos);
}

// Once in each view and once as a bar, and beside the words what the colour means.
TEST(ProgramPicture, draws_every_target_that_a_program_reaches) {
  const std::string svg = program_picture({kBefore, &kAfter}, "part");
  EXPECT_EQ(count(svg, "<path class=\"before\""), 3 * 3 + 1U);
  EXPECT_EQ(count(svg, "<path class=\"after\""), 3 * 2 + 1U);
  EXPECT_EQ(count(program_picture({kBefore}, "part"), "<path class=\"after\""), 0U);
}

// 45 units of the largest miss, of a round factor below.
TEST(ProgramPicture, magnifies_misses_by_the_factor_that_it_states) {
  const std::string svg = program_picture({kBefore}, "part");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(svg, found, std::regex("From above[^<]*misses ([0-9]+) times")));
  const double factor = std::stod(found[1]);
  ASSERT_TRUE(std::regex_search(
      svg, found,
      std::regex("before\" d=\"M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)\"/>\n<circle")));
  const double drawn = std::stod(found[3]) - std::stod(found[1]);
  ASSERT_TRUE(std::regex_search(svg, found,
                                std::regex("M40.0 [0-9.]+L([0-9.]+) [0-9.]+\"/>\n"
                                           "<text[^>]*>([0-9]+) mm")));
  const double units_a_mm = (std::stod(found[1]) - 40) / std::stod(found[2]);
  EXPECT_NEAR(drawn / units_a_mm / factor, 3, 0.05);
}

TEST(ProgramPicture, takes_any_name_and_a_program_of_one_place) {
  const Arrivals one{{arrival(1, {0.5, 0, 0}, {0, 0, 0})}, {}};
  const std::string svg = program_picture({one}, "<script>alert(\"x\")&\x01\xff");
  EXPECT_EQ(svg.find("<script"), svg.npos);
  EXPECT_EQ(svg.find("nan"), svg.npos);
  EXPECT_EQ(svg.find("inf"), svg.npos);
  EXPECT_EQ(svg.find('\x01'), svg.npos);
  EXPECT_EQ(svg.find('\xff'), svg.npos);
}

}  // namespace
}  // namespace armsig::tool
