// SPDX-License-Identifier: MIT
// The file of touches: whole rows that `armsig identify --instrument` reads, and nothing else.
#include "firmware/linux/touch_file.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/touches.hpp"
#include "host_tests/cli/files.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::daemon {
namespace {

using cli::Folder;

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};
constexpr const char* kHeader = "place,q1_deg,q2_mm\n";

TouchFile file_in(const Folder& folder, const std::string& plan = "") {
  return {{.file = (folder / "touches.csv").string(),
           .plan = plan.empty() ? "" : (folder / plan).string()},
          kTypes};
}

std::string text_in(const Folder& folder) { return cli::read_file(folder / "touches.csv"); }

// A plan of three touches of A1 and one of B1.
void write_plan(const Folder& folder) {
  cli::write_file(folder / "plan.csv", std::string(kHeader) + "A1,1,0\nB1,2,0\nA1,3,0\nA1,4,0\n");
}

void expect_refused(const Told& told, Error error, const std::string& words) {
  const TouchRefusal refusal = test::failure_of(told);
  EXPECT_EQ(refusal.error, error) << refusal.why;
  EXPECT_NE(refusal.why.find(words), std::string::npos) << refusal.why;
  EXPECT_EQ(refusal.why.find_first_of("\"\n"), std::string::npos) << refusal.why;
}

TEST(TouchFile, is_made_with_the_first_touch_and_read_by_the_reader_of_touches) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  EXPECT_EQ(file.tell().value(), " touches=0");
  EXPECT_EQ(file.add("A1", {radians(-30), 0.25}).value(), " place=A1 at_place=1 touches=1");
  EXPECT_EQ(file.add("A2", {radians(45.5), -0.1}).value(), " place=A2 at_place=1 touches=2");
  EXPECT_EQ(file.add("A1", {0, 0}).value(), " place=A1 at_place=2 touches=3");
  EXPECT_EQ(file.tell().value(), " touches=3 places=A1:2,A2:1");
  EXPECT_EQ(text_in(folder), std::string(kHeader) +
                                 "A1,-30.00000,250.00000\nA2,45.50000,-100.00000\n"
                                 "A1,0.00000,0.00000\n");
  tool::InstrumentDescription sockets;
  sockets.instruments.emplace_back();
  const auto touches =
      tool::read_touches((folder / "touches.csv").string(), kTypes, sockets).value();
  ASSERT_EQ(touches.size(), 3U);
  EXPECT_EQ(touches[1].place, "A2");
  EXPECT_NEAR(touches[1].q[1], -0.1, 1e-9);
}

TEST(TouchFile, loses_its_last_touch_and_no_other_by_drop) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  ASSERT_TRUE(file.add("A1", {0, 0}));
  const std::string one = text_in(folder);
  ASSERT_TRUE(file.add("B1", {1, 1}));
  EXPECT_EQ(file.drop().value(), " place=B1 at_place=0 touches=1");
  EXPECT_EQ(text_in(folder), one);
  EXPECT_EQ(file.drop().value(), " place=A1 at_place=0 touches=0");
  EXPECT_EQ(text_in(folder), kHeader);
  expect_refused(file.drop(), Error::kWrongMode, "no touch to drop");
  ASSERT_TRUE(file.add("A1", {0, 0}));
  EXPECT_EQ(text_in(folder), one);
}

TEST(TouchFile, goes_on_with_what_a_person_wrote) {
  const Folder folder;
  cli::write_file(folder / "touches.csv", std::string(kHeader) + "# on Monday\nA1,1,2\n\nA2,3,4");
  const TouchFile file = file_in(folder);
  EXPECT_EQ(file.add("A2", {0, 0}).value(), " place=A2 at_place=2 touches=3");
  EXPECT_EQ(text_in(folder),
            std::string(kHeader) + "# on Monday\nA1,1,2\n\nA2,3,4\nA2,0.00000,0.00000\n");
  ASSERT_TRUE(file.drop());
  EXPECT_EQ(file.drop().value(), " place=A2 at_place=0 touches=1");
  EXPECT_EQ(text_in(folder), std::string(kHeader) + "# on Monday\nA1,1,2\n\n");
  ASSERT_TRUE(file.drop());
  EXPECT_EQ(text_in(folder), kHeader);
}

TEST(TouchFile, tells_what_is_left_of_the_plan_and_which_place_is_next) {
  const Folder folder;
  write_plan(folder);
  const TouchFile file = file_in(folder, "plan.csv");
  EXPECT_EQ(file.tell().value(), " touches=0 left=4 next=A1 places=A1:0/3,B1:0/1");
  EXPECT_EQ(file.add("A1", {0, 0}).value(), " place=A1 at_place=1 touches=1 left=3 next=B1");
  EXPECT_EQ(file.add("A1", {0, 0}).value(), " place=A1 at_place=2 touches=2 left=2 next=B1");
  EXPECT_EQ(file.add("B1", {0, 0}).value(), " place=B1 at_place=1 touches=3 left=1 next=A1");
  EXPECT_EQ(file.add("B1", {0, 0}).value(), " place=B1 at_place=2 touches=4 left=1 next=A1");
  EXPECT_EQ(file.add("A1", {0, 0}).value(), " place=A1 at_place=3 touches=5 left=0");
  EXPECT_EQ(file.tell().value(), " touches=5 left=0 places=A1:3/3,B1:2/1");
  expect_refused(file.add("A2", {0, 0}), Error::kOutOfRange, "A2 is no place of");
}

TEST(TouchFile, needs_the_plan_that_is_configured) {
  const Folder folder;
  const TouchFile file = file_in(folder, "plan.csv");
  expect_refused(file.add("A1", {0, 0}), Error::kStorageFault, "plan.csv: no file");
  cli::write_file(folder / "plan.csv", "place,q1_deg\nA1,1\n");
  expect_refused(file.tell(), Error::kStorageFault, "plan.csv:1");
  EXPECT_FALSE(std::filesystem::exists(folder / "touches.csv"));
}

TEST(TouchFile, takes_no_name_that_is_more_than_a_name) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  for (const char* name : {"", "A,1", "A 1", "\"A\"", "A\n1", "=1+1", "-A", "@A", "../A", "A:1",
                           "A/1", "A\t", "\xC3\xA9", "A\\", "a23456789012345678901234567890123"}) {
    EXPECT_FALSE(is_place_name(name)) << name;
    expect_refused(file.add(name, {0, 0}), Error::kOutOfRange, "a letter or digit");
  }
  for (const char* name : {"A1", "1", "z", "Bar-2.left_end", "a2345678901234567890123456789012"}) {
    EXPECT_TRUE(is_place_name(name)) << name;
    EXPECT_TRUE(file.add(name, {0, 0})) << name;
  }
}

TEST(TouchFile, leaves_a_file_alone_that_it_cannot_go_on_with) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  for (const char* text : {"place,q1_deg,q2_deg\nA1,1,2\n", "q1_deg,q2_mm,place\n1,2,A1\n",
                           "place,q1_deg,q2_mm\nA1,1\n", "place,q1_deg,q2_mm\nA1,1,nan\n",
                           "place,q1_deg,q2_mm\n,1,2\n", "no table", "\xEF\xBB\xBF"}) {
    cli::write_file(folder / "touches.csv", text);
    expect_refused(file.add("A1", {0, 0}), Error::kStorageFault, "touches.csv");
    expect_refused(file.drop(), Error::kStorageFault, "touches.csv");
    expect_refused(file.tell(), Error::kStorageFault, "touches.csv");
    EXPECT_EQ(text_in(folder), text);
  }
  cli::write_file(folder / "touches.csv", std::string(kHeader) + "A 1,1,2\n");
  expect_refused(file.add("A1", {0, 0}), Error::kOutOfRange, "touches.csv: line 2: the name");
}

TEST(TouchFile, waits_for_no_pipe_and_writes_into_no_folder_that_is_not_there) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  ASSERT_EQ(::mkfifo((folder / "touches.csv").c_str(), 0600), 0);
  expect_refused(file.add("A1", {0, 0}), Error::kStorageFault, "touches.csv: no file");
  ASSERT_TRUE(std::filesystem::remove(folder / "touches.csv"));
  ASSERT_TRUE(std::filesystem::create_directory(folder / "touches.csv"));
  expect_refused(file.add("A1", {0, 0}), Error::kStorageFault, "touches.csv: no file");
  const TouchFile nowhere({.file = (folder / "none/touches.csv").string(), .plan = {}}, kTypes);
  expect_refused(nowhere.add("A1", {0, 0}), Error::kStorageFault, "none/touches.csv");
  EXPECT_EQ(nowhere.tell().value(), " touches=0");
}

TEST(TouchFile, has_bounds) {
  const Folder folder;
  const TouchFile file = file_in(folder);
  std::string text = kHeader;
  for (std::size_t i = 0; i < kMostTouches - 1; ++i) text += "A1,0,0\n";
  cli::write_file(folder / "touches.csv", text);
  EXPECT_EQ(file.add("A1", {0, 0}).value(), " place=A1 at_place=1000 touches=1000");
  expect_refused(file.add("A1", {0, 0}), Error::kCapacityExceeded, "1001 touches, at most 1000");
  EXPECT_TRUE(file.drop());

  ASSERT_TRUE(std::filesystem::remove(folder / "touches.csv"));
  for (std::size_t i = 0; i < kMostPlaces; ++i) {
    ASSERT_TRUE(file.add(std::to_string(i), {0, 0}));
  }
  expect_refused(file.add("B", {0, 0}), Error::kCapacityExceeded, "33 places, at most 32");
  EXPECT_TRUE(file.add("31", {0, 0}));
  cli::write_file(folder / "touches.csv", text + std::string(1U << 20U, '#'));
  expect_refused(file.tell(), Error::kStorageFault, "too large");
}

}  // namespace
}  // namespace armsig::daemon
