// SPDX-License-Identifier: MIT
// What goes wrong in a session without a tracker, planted: it is found and named.
#include <algorithm>
#include <cstdlib>
#include <set>

#include <gtest/gtest.h>

#include "host_tests/places/task_of_session.hpp"
#include "host_tests/places/unknown_places.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

using touching::Session;
using touching::Vector3d;

// As many sessions as are asked for in the environment, or a sample.
unsigned sessions(unsigned sample) {
  const char* asked = std::getenv("ARMSIG_MISTAKES");
  return asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : sample;
}

bool is_warned(const PlaceCalibration& found, const std::string& words) {
  return std::ranges::any_of(found.warnings, [&](const std::string& warning) {
    return warning.find(words) != std::string::npos;
  });
}

struct Tally {
  std::size_t planted = 0;
  std::size_t rejected = 0;  // of those
  std::size_t false_ones = 0;
};

void count(const PlaceCalibration& found, const std::set<std::size_t>& lines, Tally& tally) {
  tally.planted += lines.size();
  for (const RejectedTouch& touch : found.rejected) {
    ++(lines.contains(touch.line) ? tally.rejected : tally.false_ones);
  }
}

// Every tenth touch of 100 with another socket's name.
std::set<std::size_t> rename_touches(Session& session) {
  std::vector<std::string> names;
  for (const auto& [name, centre] : session.sockets()) names.push_back(name);
  std::set<std::size_t> lines;
  for (std::size_t k = 3; k < session.readings().size(); k += 10) {
    std::string& place = session.readings()[k].place;
    const auto at = static_cast<std::size_t>(std::ranges::find(names, place) - names.begin());
    place = names[(at + 1 + k % 7) % names.size()];
    lines.insert(k + 2);
  }
  return lines;
}

// Ten more that slipped by 1 to 5 mm.
std::set<std::size_t> add_slips(Session& session) {
  std::set<std::size_t> lines;
  const auto sockets = session.sockets();
  std::uniform_real_distribution<double> off_m(1e-3, 5e-3);
  while (lines.size() < 10) {
    for (const auto& [name, centre] : sockets) {
      const Vector3d slipped =
          centre + off_m(session.random()) * touching::any_stem(session.random());
      if (lines.size() == 10 || !session.touch(name, slipped)) continue;
      lines.insert(session.readings().size() + 1);
    }
  }
  return lines;
}

template <typename Plant>
Tally tally_of(Plant plant) {
  Tally tally;
  for (unsigned seed = 1; seed <= sessions(2); ++seed) {
    Session session(seed % 2 == 0 ? touching::ur5() : touching::iiwa(), seed);
    session.add_bars(4, 0.3, 0.02e-3);
    session.touch_sockets(100);
    const std::set<std::size_t> lines = plant(session);
    const auto found = calibrated(session);
    EXPECT_TRUE(found) << "seed " << seed;
    if (found) count(*found, lines, tally);
  }
  testing::Test::RecordProperty("planted", static_cast<int>(tally.planted));
  return tally;
}

TEST(PlaceMistakes, wrong_sockets_are_all_found) {
  const Tally tally = tally_of(rename_touches);
  EXPECT_EQ(tally.rejected, tally.planted);
  EXPECT_LE(45 * tally.false_ones, tally.planted);
}

TEST(PlaceMistakes, slips_beyond_1_mm_are_found) {
  const Tally tally = tally_of(add_slips);
  EXPECT_GE(static_cast<double>(tally.rejected), 0.98 * static_cast<double>(tally.planted));
  EXPECT_LE(45 * tally.false_ones, tally.planted);
}

TEST(PlaceMistakes, a_wire_off_its_pulley_is_found_by_its_lines) {
  Session session(touching::ur5(), 3);
  session.add_bars(1, 0.3, 0.02e-3);
  session.touch_sockets(20);
  touching::read_three_wires(session, 50);
  std::set<std::size_t> lines;
  for (std::size_t k = 25; k < session.readings().size(); k += 10) {
    *session.readings()[k].length_m -= 3e-3 + 1e-4 * static_cast<double>(k % 40);
    lines.insert(k + 2);
  }
  const auto found = calibrated(session);
  ASSERT_TRUE(found) << render(found.error());
  Tally tally;
  count(*found, lines, tally);
  EXPECT_EQ(tally.rejected, tally.planted);
  EXPECT_EQ(tally.false_ones, 0U);
}

TEST(PlaceMistakes, a_gain_that_contradicts_the_bars_is_named) {
  for (const double gain : {0.0, 2e-2}) {
    Session session(touching::ur5(), 4);
    session.add_bars(3, 0.3, 0.02e-3);
    session.touch_sockets(60);
    session.read_wire("W1", {1.2, 0, 0.1}, gain, 5e-3, 60);
    const auto found = calibrated(session);
    ASSERT_TRUE(found) << render(found.error());
    EXPECT_EQ(is_warned(*found, "encoder: a gain of 2.0"), gain != 0);
    EXPECT_EQ(is_warned(*found, "encoder"), gain != 0);
  }
}

// All touches after the push have the arm elsewhere: seen from it, the sockets moved.
TEST(PlaceMistakes, a_base_that_was_pushed_is_named_with_its_line) {
  for (const int before : {50, 80}) {
    Session session(touching::ur5(), 5);
    session.add_bars(4, 0.3, 0.02e-3);
    session.touch_sockets(before);
    for (auto& [name, centre] : session.sockets()) centre += Vector3d(0.8e-3, -0.6e-3, 0);
    session.touch_sockets(100 - before);
    const auto found = calibrated(session);
    if (!found) continue;
    EXPECT_TRUE(is_warned(*found, "line " + std::to_string(before + 2) + " ")) << before;
    EXPECT_TRUE(is_warned(*found, "pushed")) << before;
  }
}

TEST(PlaceMistakes, that_nobody_made_are_not_named) {
  for (unsigned seed = 1; seed <= sessions(2); ++seed) {
    Session session(touching::ur5(), seed);
    session.add_bars(2, 0.3, 0.02e-3);
    session.touch_sockets(50);
    touching::read_three_wires(session, 20);
    const auto found = calibrated(session);
    ASSERT_TRUE(found) << render(found.error());
    EXPECT_TRUE(found->warnings.empty()) << found->warnings.front();
  }
}

TEST(PlaceMistakes, exchanged_bars_among_four_are_refused) {
  Session session(touching::ur5(), 6);
  session.add_bars(4, 0.3, 0.02e-3);
  session.touch_sockets(80);
  session.lengths()[1].length_m = 0.2;
  session.lengths()[3].length_m = 0.4;
  const auto found = calibrated(session);
  ASSERT_FALSE(found);
  EXPECT_NE(test::failure_of(found).what.find("contradict each other"), std::string::npos);
}

}  // namespace
}  // namespace armsig::tool
