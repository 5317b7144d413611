// SPDX-License-Identifier: MIT
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "core/base/joint_range.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/arm_file.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

// A file with these joints, the first of them in line 4.
std::string arm_with(const std::string& joints, const std::string& rest = "") {
  return "armsig: arm/1\nname: test\njoints:\n" + joints + rest;
}

const std::string kRevolute =
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: -90, "
    "limits_deg: [-160, 160]}\n";
const std::string kPrismatic =
    "  - {type: prismatic, theta_deg: -90, d_mm: 0, a_mm: 20.3, alpha_deg: 0, "
    "limits_mm: [100, 900]}\n";

std::string message_of(const std::string& text) {
  const auto arm = parse_arm(text, "A.yaml");
  return arm ? "read" : render(arm.error());
}

// What is said about a revolute joint in which `from` has been replaced by `to`.
std::string message_with(const std::string& from, const std::string& to) {
  std::string joint = kRevolute;
  joint.replace(joint.find(from), from.size(), to);
  return message_of(arm_with(joint));
}

TEST(ArmFile, converts_degrees_and_millimetres) {
  const auto read = parse_arm(arm_with(kRevolute + kPrismatic), "A.yaml");
  ASSERT_TRUE(read) << render(read.error());
  const Arm& arm = read->arm;
  EXPECT_EQ(read->name, "test");
  ASSERT_EQ(arm.joints.size(), 2U);
  EXPECT_EQ(arm.joints[0].type, JointType::kRevolute);
  EXPECT_EQ(arm.joints[0].alpha_rad, -kPi / 2);
  EXPECT_NEAR(arm.limits[0].upper, 2.7925268031909272734, 1e-15);  // 160 pi / 180, by Python
  EXPECT_EQ(arm.joints[1].type, JointType::kPrismatic);
  EXPECT_DOUBLE_EQ(arm.joints[1].a_m, 0.0203);
  EXPECT_EQ(arm.limits[1].lower, 0.1);
  EXPECT_EQ(arm.limits[1].upper, 0.9);
}

TEST(ArmFile, tells_which_way_is_up_by_how_the_arm_is_mounted) {
  const auto up = [](const std::string& mounted) {
    const auto read = parse_arm(arm_with(kRevolute, mounted), "A.yaml");
    return read ? read->arm.up_0 : Vector3(Vector3::Zero());
  };
  EXPECT_EQ(up(""), Vector3(0, 0, 1));
  EXPECT_EQ(up("mounted: ceiling\n"), Vector3(0, 0, -1));
  EXPECT_EQ(up("mounted: wall\n"), Vector3(1, 0, 0));
  EXPECT_TRUE(up("mounted: {gravity: [0, -6, 8]}\n").isApprox(Vector3(0, 0.6, -0.8), 1e-15));
}

TEST(ArmFile, takes_radians_and_metres) {
  const auto read =
      parse_arm(arm_with("  - {type: revolute, theta_rad: 1.5, d_m: 303.1234567890123, a_m: -0.25, "
                         "alpha_rad: 1e-3, limits_rad: [-1, 1]}\n"),
                "A.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->arm.joints[0].d_m, 303.1234567890123);
  EXPECT_EQ(read->arm.joints[0].alpha_rad, 1e-3);
}

TEST(ArmFile, takes_block_style_comments_and_a_byte_order_mark) {
  EXPECT_EQ(message_of("\xEF\xBB\xBF# drawing 7\r\narmsig: arm/1\r\nname: x\r\njoints:\r\n"
                       "  - type: revolute\r\n    theta_deg: +0.5  # offset\r\n    d_m: .5\r\n"
                       "    a_m: 1.e-1\r\n    alpha_rad: 0\r\n"),
            "read");
}

TEST(ArmFile, gives_a_revolute_joint_without_limits_one_turn) {
  const auto read = parse_arm(
      arm_with("  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0}\n"), "A.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->arm.limits[0].lower, -kPi);
  EXPECT_EQ(read->arm.limits[0].upper, kPi);
}

TEST(ArmFile, has_joints_that_turn_without_end) {
  const auto read = parse_arm(
      arm_with(
          "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits: none}\n"),
      "A.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_TRUE(is_endless(read->arm.limits[0]));
  const auto again = parse_arm(arm_text(*read), "B.yaml");
  ASSERT_TRUE(again) << render(again.error());
  EXPECT_TRUE(is_endless(again->arm.limits[0]));
}

TEST(ArmFile, reads_couplings) {
  const auto read = parse_arm(arm_with(kRevolute + kRevolute + kRevolute,
                                       "coupling:\n  - {joint: 3, from: 2, ratio: -1.0}\n"),
                              "A.yaml");
  ASSERT_TRUE(read) << render(read.error());
  ASSERT_EQ(read->arm.couplings.size(), 1U);
  EXPECT_EQ(read->arm.couplings[0].joint, 2U);
  EXPECT_EQ(read->arm.couplings[0].from, 1U);
  EXPECT_EQ(read->arm.couplings[0].ratio, -1.0);
}

TEST(ArmFile, refuses_an_unknown_key_and_names_the_nearest) {
  EXPECT_EQ(message_with("theta_deg", "thta_deg"),
            "A.yaml:4:22: unknown key \"thta_deg\" in joint 1; expected theta_deg");
}

TEST(ArmFile, refuses_an_unknown_key_and_lists_the_known_ones) {
  EXPECT_EQ(message_of(arm_with(kRevolute, "payload: 3\n")),
            "A.yaml:5:1: unknown key \"payload\" in the arm; expected armsig, name, joints, "
            "coupling, deviations, mounted, floor_mm, floor_m, link_radius_mm or link_radius_m");
}

TEST(ArmFile, refuses_a_key_without_unit) {
  EXPECT_EQ(message_with("d_mm", "d"),
            "A.yaml:4:36: key \"d\" of joint 1 has no unit; expected d_mm or d_m");
}

TEST(ArmFile, refuses_a_missing_key) {
  EXPECT_EQ(message_with(" a_mm: 0,", ""),
            "A.yaml:4:5: joint 1 has no key \"a\"; expected a_mm or a_m");
  EXPECT_EQ(message_with("type: revolute,", ""),
            "A.yaml:4:5: joint 1 has no key \"type\"; expected type");
}

TEST(ArmFile, refuses_both_units) {
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: 0, d_m: 0"),
            "A.yaml:4:45: d_mm and d_m are both given; expected one of the two");
}

TEST(ArmFile, refuses_a_key_given_twice) {
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: 0, d_mm: 1"),
            "A.yaml:4:45: key \"d_mm\" is given twice (first in line 4); expected each key once");
}

TEST(ArmFile, refuses_another_version) {
  EXPECT_EQ(message_of("armsig: arm/2\nname: x\n"),
            "A.yaml:1:9: armsig: \"arm/2\"; expected armsig: arm/1");
}

TEST(ArmFile, refuses_another_kind_of_file) {
  EXPECT_EQ(message_of("armsig: signature/1\nname: x\n"),
            "A.yaml:1:9: armsig: \"signature/1\"; expected armsig: arm/1");
  EXPECT_EQ(message_of("name: x\n"),
            "A.yaml:1:1: the file does not say what it is; expected armsig: arm/1 as its first "
            "line");
}

TEST(ArmFile, refuses_an_arm_without_joints) {
  EXPECT_EQ(message_of("armsig: arm/1\nname: x\njoints: []\n"),
            "A.yaml:3:9: joints: 0 items; expected a list of 1 to 8 items");
}

TEST(ArmFile, refuses_an_arm_with_nine_joints) {
  std::string joints;
  for (int i = 0; i < 9; ++i) joints += kRevolute;
  EXPECT_EQ(message_of(arm_with(joints)),
            "A.yaml:4:3: joints: 9 items; expected a list of 1 to 8 items");
}

TEST(ArmFile, refuses_what_is_no_number) {
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: 1O"),
            "A.yaml:4:42: d_mm: \"1O\" is not a number; expected a number");
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: 12 mm"),
            "A.yaml:4:42: d_mm: \"12 mm\" is not a number; expected a number");
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: [1]"), "A.yaml:4:42: d_mm: a list; expected a number");
}

TEST(ArmFile, refuses_numbers_that_are_not_finite) {
  for (const std::string text : {".nan", ".inf", "-.inf", ".NaN", "nan", "-inf", "Infinity"}) {
    EXPECT_EQ(message_with("d_mm: 0", "d_mm: " + text),
              "A.yaml:4:42: d_mm: \"" + text + "\" is not a finite number; expected a number");
  }
  EXPECT_EQ(message_with("d_mm: 0", "d_mm: 1e999"),
            "A.yaml:4:42: d_mm: \"1e999\" is out of range; expected a number");
}

TEST(ArmFile, refuses_reversed_limits) {
  EXPECT_EQ(message_with("[-160, 160]", "[160, -160]"),
            "A.yaml:4:82: limits_deg of joint 1: 160 is not below -160; expected the lower limit "
            "first");
}

TEST(ArmFile, refuses_limits_that_are_no_pair) {
  EXPECT_EQ(message_with("[-160, 160]", "[160]"),
            "A.yaml:4:82: limits_deg: 1 item; expected a list of 2 items");
}

TEST(ArmFile, refuses_limits_in_the_unit_of_the_other_type) {
  EXPECT_EQ(message_with("revolute", "prismatic"),
            "A.yaml:4:71: limits_deg on joint 1, which is prismatic; expected limits_mm or "
            "limits_m");
  EXPECT_EQ(message_with("limits_deg", "limits_mm"),
            "A.yaml:4:70: limits_mm on joint 1, which is revolute; expected limits_deg or "
            "limits_rad");
}

TEST(ArmFile, refuses_a_prismatic_joint_without_limits) {
  EXPECT_EQ(
      message_of(arm_with("  - {type: prismatic, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0}\n")),
      "A.yaml:4:5: joint 1 is prismatic and has no limits; expected limits_mm or limits_m");
}

TEST(ArmFile, refuses_an_unknown_joint_type) {
  EXPECT_EQ(message_with("revolute", "hinge"),
            "A.yaml:4:12: type of joint 1: \"hinge\"; expected revolute or prismatic");
}

TEST(ArmFile, refuses_a_coupling_outside_the_arm) {
  EXPECT_EQ(
      message_of(arm_with(kRevolute + kRevolute, "coupling:\n  - {joint: 3, from: 1, ratio: 1}\n")),
      "A.yaml:7:13: joint: \"3\"; expected an integer from 1 to 2");
  EXPECT_EQ(
      message_of(arm_with(kRevolute + kRevolute, "coupling:\n  - {joint: 2, from: 0, ratio: 1}\n")),
      "A.yaml:7:22: from: \"0\"; expected an integer from 1 to 2");
}

TEST(ArmFile, refuses_couplings_that_make_no_sense) {
  const std::string joints = kRevolute + kRevolute + kPrismatic;
  EXPECT_EQ(message_of(arm_with(joints, "coupling: [{joint: 2, from: 2, ratio: 1}]\n")),
            "A.yaml:7:12: joint 2 is coupled to itself; expected another joint");
  EXPECT_EQ(message_of(arm_with(joints, "coupling: [{joint: 3, from: 2, ratio: 1}]\n")),
            "A.yaml:7:12: joint 3 is prismatic, joint 2 is revolute; expected a coupling between "
            "joints of one type");
  EXPECT_EQ(message_of(arm_with(joints,
                                "coupling: [{joint: 2, from: 1, ratio: 1}, "
                                "{joint: 2, from: 1, ratio: 2}]\n")),
            "A.yaml:7:43: the coupling of joint 2 from joint 1 is given twice; expected each pair "
            "once");
  EXPECT_EQ(message_of(arm_with(joints,
                                "coupling: [{joint: 2, from: 1, ratio: 1}, "
                                "{joint: 1, from: 2, ratio: 2}]\n")),
            "A.yaml:7:43: joint 1 hangs, through others, on itself; expected couplings that lead "
            "from inner joints to outer ones, or the other way");
}

TEST(ArmFile, refuses_what_is_not_yaml) {
  EXPECT_EQ(message_of("armsig: arm/1\njoints: [\n"),
            "A.yaml:3:1: not YAML: end of sequence flow not found; expected a YAML document");
  EXPECT_EQ(message_of("\tarmsig: arm/1\n").find("A.yaml:1:"), 0U);
}

TEST(ArmFile, refuses_what_is_nested_too_deeply) {
  EXPECT_EQ(message_of(std::string(100000, '[')),
            "A.yaml:1:9: nested too deeply; expected 16 levels");
}

TEST(ArmFile, refuses_more_keys_than_any_map_has) {
  std::string text = "armsig: arm/1\n";
  for (int i = 0; i < 100000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  EXPECT_EQ(message_of(text), "A.yaml:257:1: too many keys; expected at most 256 in a map");
}

TEST(ArmFile, refuses_what_is_not_utf_8) {
  EXPECT_EQ(message_of("armsig: arm/1\nname: Gr\xF6\xDF"
                       "e\n"),
            "A.yaml:2:9: the byte \"\\xF6\"; expected UTF-8 text");
  EXPECT_EQ(message_of(std::string("\xFF\xFE"
                                   "a\0",
                                   4)),
            "A.yaml: text in UTF-16; expected UTF-8: save it so, or iconv -f UTF-16 -t UTF-8 (-f "
            "UTF-16LE without a mark)");
}

TEST(ArmFile, refuses_an_empty_file) {
  EXPECT_EQ(message_of(""), "A.yaml: the file is empty; expected a YAML document");
  EXPECT_EQ(message_of("# nothing\n"),
            "A.yaml: the file holds only comments; expected a YAML document");
  EXPECT_EQ(message_of("\n\n"),
            "A.yaml: the file holds only blank lines; expected a YAML document");
}

TEST(ArmFile, refuses_what_is_no_map) {
  EXPECT_EQ(message_of("[1, 2]\n"),
            "A.yaml:1:1: the file does not say what it is; expected armsig: arm/1 as its first "
            "line");
  EXPECT_EQ(message_of(arm_with("  - 3\n")),
            "A.yaml:4:5: joint 1 is \"3\"; expected a map of keys and values");
}

TEST(ArmFile, refuses_anchors_tags_and_second_documents) {
  EXPECT_EQ(message_of("armsig: arm/1\nname: &a x\n"),
            "A.yaml:2:7: a YAML anchor or alias; expected the value itself");
  EXPECT_EQ(message_of("armsig: arm/1\nname: !!str x\n"),
            "A.yaml:2:7: a YAML tag; expected a value without a tag");
  EXPECT_EQ(message_of("armsig: arm/1\n---\nname: x\n"),
            "A.yaml:3: a second YAML document; expected one document a file");
}

TEST(ArmFile, says_why_a_file_cannot_be_opened) {
  const auto read = read_arm_file("/nonexistent/A.yaml");
  ASSERT_FALSE(read);
  EXPECT_EQ(render(test::failure_of(read)),
            "/nonexistent/A.yaml: can't be opened: No such file or directory");
  EXPECT_EQ(render(test::failure_of(read_arm_file("/"))), "/: can't be read: Is a directory");
}

TEST(ArmFile, gives_back_every_bit_that_was_written) {
  ArmDescription written{"a \"name\": # with signs", {}};
  written.arm.joints = {{JointType::kRevolute, 0.1, -303.1234567890123, 1.0 / 3, -kPi / 2},
                        {JointType::kRevolute, -1e-17, 5e6, 0, 1e-7},
                        {JointType::kPrismatic, 0.2, 0.3, -0.0, 0.7}};
  written.arm.limits = {{-kPi, kPi}, {-1, 2}, {0.1, 0.9}};
  written.arm.couplings = {{1, 0, 1.0 / 3}};
  const std::string path = test::temporary("arm.yaml");
  ASSERT_TRUE(write_arm_file(path, written));
  const auto read = read_arm_file(path);
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->name, written.name);
  ASSERT_EQ(read->arm.joints.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->arm.joints[i].type, written.arm.joints[i].type);
    EXPECT_EQ(read->arm.joints[i].theta_rad, written.arm.joints[i].theta_rad);
    EXPECT_EQ(read->arm.joints[i].d_m, written.arm.joints[i].d_m);
    EXPECT_EQ(read->arm.joints[i].a_m, written.arm.joints[i].a_m);
    EXPECT_EQ(read->arm.joints[i].alpha_rad, written.arm.joints[i].alpha_rad);
    EXPECT_EQ(read->arm.limits[i].lower, written.arm.limits[i].lower);
    EXPECT_EQ(read->arm.limits[i].upper, written.arm.limits[i].upper);
  }
  EXPECT_EQ(read->arm.couplings[0].ratio, 1.0 / 3);
  EXPECT_EQ(read_tag(path).value_or(""), "arm/1");
  std::filesystem::remove(path);
}

TEST(ArmFile, refuses_to_write_what_it_would_not_read) {
  ArmDescription description{"x", {}};
  description.arm.joints = {{JointType::kRevolute, std::nan(""), 0, 0, 0}};
  description.arm.limits = {{-1, 1}};
  const std::string path = test::temporary("never.yaml");
  EXPECT_FALSE(write_arm_file(path, description));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ArmFile, reads_every_arm_of_the_shared_data) {
  const std::filesystem::path folder = ARMSIG_SHARED_DATA "/arms";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto read = read_arm_file(entry.path().string());
    EXPECT_TRUE(read) << render(read.error());
    ++count;
  }
  EXPECT_EQ(count, 11);
}

TEST(ArmFile, reads_the_puma_of_table_2_as_printed) {
  const std::string path = ARMSIG_SHARED_DATA "/arms/puma560-stone1986-robot1.yaml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const auto read = read_arm_file(path);
  ASSERT_TRUE(read) << render(read.error());
  ASSERT_EQ(read->arm.joints.size(), 6U);
  EXPECT_DOUBLE_EQ(read->arm.joints[1].d_m, 112.10213);
  EXPECT_NEAR(degrees(read->arm.joints[1].alpha_rad), -0.217, 1e-15);
  EXPECT_NEAR(degrees(read->arm.limits[5].lower), -266, 1e-12);
}

}  // namespace
}  // namespace armsig::tool
