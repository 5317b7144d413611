// SPDX-License-Identifier: MIT
// Thousands of damaged files: every reader gives a value or a problem with words, and neither
// crashes nor throws. Fixed seeds; with the sanitizers this also finds reads out of bounds.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/formats/sensor_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/random_signature.hpp"

namespace armsig::tool {
namespace {

const std::string kArm =
    "# a comment\narmsig: arm/1\nname: \"Puma\" # x\njoints:\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 1e2, a_mm: 0, alpha_deg: -90, limits_deg: [-160, "
    "160]}\n"
    "  - type: prismatic\n    theta_rad: .5\n    d_m: 0\n    a_mm: 20.3\n    alpha_deg: 0\n"
    "    limits_mm:\n      - 100\n      - 900\n"
    "  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0}\n"
    "coupling:\n  - {joint: 3, from: 1, ratio: 1.0}\n";
const std::string kSensor =
    "armsig: sensor/1\nname: frame\nreceivers:\n  - {x_mm: 0, y_mm: 0, z_mm: 0}\n"
    "  - {x_mm: 1500, y_mm: 0, z_mm: 0}\n  - {x_mm: 0, y_m: 1.5, z_mm: 0}\n"
    "range_sigma_mm: 0.2\npath: one-way\nfacing: [0, 0, 1]\ncalibrated_at_c: 20\n";
const std::string kPositions =
    "\xEF\xBB\xBF# c\nsweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm,sigma_mm\n1,1,-10.5,0,1,2,3,0.2\r\n"
    "2,1,0,1e3,,,,\n0,-7,1,2,3,4,5,6";
const std::string kRanges =
    "sweep,target,q1_rad,q2_m,r1_mm,r2_mm,r3_mm,air_c\n1,1,1,2,1000,,2000,21.5\n"
    "2,1,0,0,1,2,3,\n";
const std::string kJoints = "q1_deg,q2_mm\n1,2\n3,4e-1\n";
const std::string kTools = "x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,1,0,0,0\n1,2,3,.6,.8,0,0\n";

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};

// One to four random edits: a byte changed, inserted or removed, a piece repeated, cut or swapped
// for something with a meaning, the end cut off.
std::string damaged(std::string text, std::mt19937& random) {
  constexpr std::string_view kBytes =
      "0123456789.-+eE,:;[]{}\"'#&*!|>%@`~?\n\r\t \\\x00\x04\xFF\xEF";
  const std::array<std::string, 16> pieces{
      "nan", ".inf", "1e999",    "- ",   "---\n", "...\n",        "&a ", "*a",
      "!!x", "? ",   "{{{{[[[[", "|\n ", "<<: ",  "\xEF\xBB\xBF", "\"",  std::string(300, '[')};
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(text.size() - at, 40) + 1);
    switch (below(7)) {
      case 0:
        if (at < text.size()) text[at] = kBytes[below(kBytes.size())];
        break;
      case 1:
        text.insert(at, 1, kBytes[below(kBytes.size())]);
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(at, length));
        break;
      case 4:
        text.replace(at, length, pieces[below(pieces.size())]);
        break;
      case 5:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      default:
        if (below(4) == 0) text.resize(at);
        break;
    }
  }
  return text;
}

// Gives `trials` damaged versions of `text` to `read`, and every truncation of it.
void torture(const std::string& text, int trials,
             const std::function<std::string(const std::string&)>& read) {
  std::mt19937 random(20);
  const std::size_t step = std::max<std::size_t>(1, text.size() / 200);
  for (std::size_t length = 0; length < text.size(); length += step) {
    const std::string message = read(text.substr(0, length));
    ASSERT_EQ(message.find('\n'), std::string::npos) << message;
  }
  for (int trial = 0; trial < trials; ++trial) {
    const std::string message = read(damaged(text, random));
    ASSERT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

template <typename T>
std::string outcome(const Read<T>& read) {
  if (read) return "read";
  EXPECT_FALSE(test::failure_of(read).what.empty());
  EXPECT_EQ(test::failure_of(read).file, "F");
  EXPECT_GE(test::failure_of(read).line, 0);
  EXPECT_GE(test::failure_of(read).column, 0);
  return render(read.error());
}

std::string measure(const std::string& text) {
  auto reader = MeasurementReader::over(text, "F", kTypes);
  if (!reader) return outcome(reader);
  for (MeasurementRow row;;) {
    const auto more = reader->next(row);
    if (!more || !*more) return outcome(more);
    EXPECT_TRUE(std::isfinite(row.q[0]) && std::isfinite(row.q[1]));
    EXPECT_TRUE(!row.p_S || row.p_S->allFinite());
  }
}

TEST(Robustness, of_the_arm_reader) {
  ASSERT_EQ(outcome(parse_arm(kArm, "F")), "read");
  torture(kArm, 20000, [](const std::string& text) { return outcome(parse_arm(text, "F")); });
}

TEST(Robustness, of_the_sensor_reader) {
  ASSERT_EQ(outcome(parse_sensor(kSensor, "F")), "read");
  torture(kSensor, 10000, [](const std::string& text) { return outcome(parse_sensor(text, "F")); });
}

TEST(Robustness, of_the_measurement_reader) {
  ASSERT_EQ(measure(kPositions), "read");
  ASSERT_EQ(measure(kRanges), "read");
  torture(kPositions, 50000, measure);
  torture(kRanges, 50000, measure);
}

TEST(Robustness, of_the_pose_readers) {
  torture(kJoints, 20000,
          [](const std::string& text) { return outcome(parse_joint_poses(text, "F", kTypes)); });
  torture(kTools, 20000,
          [](const std::string& text) { return outcome(parse_tool_poses(text, "F")); });
}

// A signature without the long tables, so that edits hit its keys.
std::string a_signature() {
  SignatureRecord record = test::RandomRecord(3).make(2);
  record.covariance.reset();
  return signature_text(record).value_or("");
}

TEST(Robustness, of_the_signature_reader) {
  torture(a_signature(), 800,
          [](const std::string& text) { return outcome(parse_signature(text, "F")); });
}

TEST(Robustness, of_the_signature_reader_behind_the_crc) {
  const std::string whole = a_signature();
  const std::string body = whole.substr(0, whole.find("crc32: 0x"));
  torture(body, 800, [](const std::string& text) -> std::string {
    const auto resealed = sealed(text);
    return resealed ? outcome(parse_signature(*resealed, "F")) : "no YAML";
  });
}

}  // namespace
}  // namespace armsig::tool
