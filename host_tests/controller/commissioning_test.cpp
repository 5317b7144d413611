// SPDX-License-Identifier: MIT
// docs/commissioning.md, followed by a person who sees joints to half a degree and types its lines:
// a sense, a ratio and a zero that are wrong are found, each by its step, at a tenth of the speed.
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/lying_drives.hpp"

namespace armsig::controller {
namespace {

// The lines of the guide that move the first joint.
std::vector<std::string> moves_of_the_guide() {
  std::ifstream guide(ARMSIG_SOURCE "/docs/commissioning.md");
  std::vector<std::string> moves;
  for (std::string line; std::getline(guide, line);) {
    if (line.starts_with("    move ")) moves.push_back(line.substr(4));
  }
  return moves;
}

std::string of_joint(std::string line, std::size_t joint) {
  line.replace(line.find("q1"), 2, "q" + std::to_string(joint + 1));
  return line;
}

struct Person {
  test::LyingPlant plant;
  double fastest = 0;

  [[nodiscard]] double sees_deg(std::size_t joint) const {
    return std::round(2 * degrees(plant.drives.joints[joint])) / 2;
  }
  // By how much the joint has turned.
  double moves(const std::string& line, std::size_t joint) {
    const double before = sees_deg(joint);
    EXPECT_EQ(plant.ask(of_joint(line, joint)), "ok") << line;
    for (int i = 0; i < 60'000; ++i) {
      const double at = plant.drives.readings[joint];
      plant.step();
      const double speed =
          std::abs(plant.drives.readings[joint] - at) / hal::seconds(plant.configuration.period);
      fastest = std::max(fastest, speed / plant.configuration.limits.speed[joint]);
      if (i > 3 && plant.controller->state().snapshot().mode == Mode::kHolding) break;
    }
    return sees_deg(joint) - before;
  }
};

TEST(Commissioning, finds_a_wrong_sense_ratio_and_zero_before_anything_moves_fast) {
  const std::vector<std::string> lines = moves_of_the_guide();
  ASSERT_EQ(lines.size(), 3U) << "a degree, ten degrees, back to the mark";
  Person person;
  person.plant.drives.scale[1] = -1;
  person.plant.drives.scale[3] = 2;
  person.plant.drives.lost[4] = radians(7);
  person.plant.drives.stand_at_readings();
  person.plant.power_up();
  ASSERT_EQ(person.plant.ask("enable"), "ok");
  person.plant.run(3);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_EQ(person.moves(lines[0], joint) < 0, joint == 1) << joint;
    const double turned = std::abs(person.moves(lines[1], joint));
    EXPECT_EQ(std::abs(turned - 10) > 1, joint == 3) << joint;
    (void)person.moves(lines[2], joint);
    EXPECT_EQ(std::abs(person.sees_deg(joint)) > 1, joint == 4) << joint;
  }
  EXPECT_GT(person.fastest, 0.05);
  EXPECT_LT(person.fastest, 0.1001);
}

}  // namespace
}  // namespace armsig::controller
