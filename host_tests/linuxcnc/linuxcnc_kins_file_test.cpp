// SPDX-License-Identifier: MIT
// The file that the kinematics module of LinuxCNC reads: whole, or refused by the line.
#include <span>

#include "core/base/crc32.hpp"
#include "core/base/joint_range.hpp"
#include "firmware/linuxcnc/kins_file.hpp"
#include "host_tests/exports/exported_arm.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::cli {
namespace {

std::string sealed(const std::string& body) {
  std::array<char, 32> seal{};
  std::snprintf(seal.data(), seal.size(), "crc32 0x%08X\n",
                crc32(std::as_bytes(std::span(body.data(), body.size()))));
  return body + seal.data();
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return text;
}

const std::string kSmall =
    "armsig linuxcnc-kins/1\n# two joints\n"
    "joint revolute 0 0.1 0.3 1.5 -2 2\njoint prismatic 0 0 0.25 0 -1 1\n"
    "coupling 2 1 0.5\ntip 0 0 0 1 0 0 0\ntool 7 0.1 0 0\n";

TEST(LinuxCncKinsFile, is_read_as_it_says) {
  const std::string text = sealed(kSmall);
  const auto model = linuxcnc::parse_kins(text);
  ASSERT_TRUE(model) << model.error().what;
  EXPECT_EQ(model->arm.joints.size(), 2U);
  EXPECT_EQ(model->arm.joints[1].type, JointType::kPrismatic);
  EXPECT_EQ(model->arm.limits[1].upper, 1);
  EXPECT_EQ(model->arm.couplings[0].ratio, 0.5);
  EXPECT_EQ(model->tools[0].number, 7);
  EXPECT_EQ(linuxcnc::parse_kins(sealed(with(kSmall, "\n# two", "\r\n# two")))->arm.joints.size(),
            2U);
}

TEST(LinuxCncKinsFile, has_joints_that_turn_without_end) {
  const std::string text = sealed(with(kSmall, "-2 2", "none"));
  const auto model = linuxcnc::parse_kins(text);
  ASSERT_TRUE(model) << model.error().what;
  EXPECT_TRUE(is_endless(model->arm.limits[0]));
  EXPECT_FALSE(is_endless(model->arm.limits[1]));
}

TEST(LinuxCncKinsFile, is_refused_by_the_line_that_is_wrong) {
  const struct {
    std::string from, to;
    std::size_t line;
    std::string_view what;
  } cases[] = {
      {"kins/1", "kins/2", 1,
       "not a file of armsig export in its format linuxcnc-kins, or of another version"},
      {"prismatic", "spherical", 4, "a joint is revolute or prismatic"},
      {"0.3", "nan", 3, "a joint has four numbers and two limits"},
      {"0.3", "1e7", 3, "a joint has four numbers and two limits"},
      {"0.3", "0.3x", 3, "a joint has four numbers and two limits"},
      {"-1 1", "none", 4, "a prismatic joint has limits"},
      {"-2 2", "2 -2", 3, "the limits are the wrong way round"},
      {"-2 2", "-2 2 2", 3, "more words than this line has"},
      {"coupling 2 1", "coupling 2 3", 5, "a coupling has two joints and a ratio"},
      {"coupling 2 1", "coupling 0 1", 5, "a coupling has two joints and a ratio"},
      {"coupling 2 1", "coupling 2 2", 5, "a joint hangs, through others, on itself"},
      {"coupling 2 1 0.5", "coupling 2 1 0.5\ncoupling 1 2 1", 6,
       "a joint hangs, through others, on itself"},
      {"1 0 0 0", "1 0 0", 6, "a tip has seven numbers"},
      {"1 0 0 0", "1 0 0 0.001", 6, "not a unit quaternion"},
      {"tip 0 0 0 1 0 0 0\n", "", 0, "no tip"},
      {"tool", "tip 0 0 0 1 0 0 0\ntool", 7, "a second tip"},
      {"tool 7", "tool seven", 7, "a tool has a number and three lengths"},
      {"tool", "wheel", 7, "a line of no known kind"},
      {"tool", "gravity 1 2 0.001\ntool", 0, "gravity or a nominal model, but no maps"},
      {"tool", "gravity 3 2 0.001\ntool", 7, "gravity has a joint, an origin and a number"},
      {"tool", "drawn 0 0 0 0\ntool", 0, "gravity or a nominal model, but no maps"},
      {"tool", "configuration 0\ntool", 7, "a configuration has a number a joint"},
      {"tool", "map 2 0 1 0\ntool", 7, "maps are in the order of the joints, one each"},
      {"tool", "map 1 0 1 0 1 2 3\ntool", 7, "a map has 120 whole numbers of 16 bits"},
  };
  for (const auto& wrong : cases) {
    const std::string text = sealed(with(kSmall, wrong.from, wrong.to));
    const auto model = linuxcnc::parse_kins(text);
    ASSERT_FALSE(model) << wrong.to;
    EXPECT_EQ(test::failure_of(model).what, wrong.what) << wrong.to;
    EXPECT_EQ(test::failure_of(model).line, wrong.line) << wrong.to;
  }
}

TEST(LinuxCncKinsFile, is_refused_where_maps_and_gravity_are_not_whole_or_too_steep) {
  const Folder folder;
  make_individual(folder, kPuma560, "--tolerances 1 --maps-deg 0.02 --deflection-mm 0.5");
  ASSERT_EQ(export_as(folder, "linuxcnc-kins").status, 0);
  std::string body = read_file(folder / "export.out");
  body.erase(body.rfind("crc32"));
  ASSERT_TRUE(linuxcnc::parse_kins(sealed(body)));
  const auto without = [&](const std::string& key) {
    const std::size_t at = body.rfind("\n" + key) + 1;
    std::string less = body;
    return sealed(less.erase(at, less.find('\n', at) + 1 - at));
  };
  for (const auto& [key, what] :
       {std::pair{"drawn", "maps, but not every joint of the nominal model"},
        std::pair{"configuration", "maps, but no configuration"},
        std::pair{"map 6", "maps or gravity out of range"}}) {
    const std::string text = without(key);
    const auto model = linuxcnc::parse_kins(text);
    ASSERT_FALSE(model) << key;
    EXPECT_EQ(test::failure_of(model).what, what) << key;
  }
  const std::string heavy = sealed(body + "gravity 1 2 5\n");
  ASSERT_FALSE(linuxcnc::parse_kins(heavy));
}

TEST(LinuxCncKinsFile, is_refused_where_it_was_changed_or_cut) {
  const std::string text = sealed(kSmall);
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    EXPECT_FALSE(linuxcnc::parse_kins(text.substr(0, size))) << "cut at " << size;
  }
  for (std::size_t at = 0; at + 1 < text.size(); ++at) {
    std::string changed = text;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_FALSE(linuxcnc::parse_kins(changed)) << "changed at " << at;
  }
}

TEST(LinuxCncKinsFile, is_refused_where_it_is_not_there_or_too_large) {
  const Folder folder;
  const auto absent = linuxcnc::read_kins((folder / "absent").c_str());
  ASSERT_FALSE(absent);
  EXPECT_EQ(test::failure_of(absent).what, "it can't be opened");
  write_file(folder / "large",
             sealed(kSmall + "#" + std::string(linuxcnc::kLargestKinsFile, 'x') + "\n"));
  const auto large = linuxcnc::read_kins((folder / "large").c_str());
  ASSERT_FALSE(large);
  EXPECT_EQ(test::failure_of(large).what, "larger than 64 kB");
}

}  // namespace
}  // namespace armsig::cli
