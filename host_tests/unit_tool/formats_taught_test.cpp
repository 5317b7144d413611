// SPDX-License-Identifier: MIT
// Taught points as files have them.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "firmware/formats/taught_points.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

const JointTypes kTwo{JointType::kRevolute, JointType::kPrismatic};

Problem refusal_of(std::string_view text) {
  return test::failure_of(parse_taught_points(text, "taught.csv", kTwo));
}

TEST(TaughtPoints, are_read_with_their_frame_point_and_line) {
  const auto rows = parse_taught_points(
      "# by hand\npoint,frame,q2_mm,q1_deg\ntip,torch,250,90\nxy,my table,10,-45\n", "taught.csv",
      kTwo);
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ((*rows)[0].line, 3U);
  EXPECT_EQ((*rows)[0].frame, "torch");
  EXPECT_EQ((*rows)[0].point->name, "tip");
  EXPECT_EQ((*rows)[0].point->kind, TaughtFrameKind::kTool);
  EXPECT_DOUBLE_EQ((*rows)[0].q[0], kPi / 2);
  EXPECT_DOUBLE_EQ((*rows)[0].q[1], 0.25);
  EXPECT_EQ((*rows)[1].frame, "my table");
  EXPECT_EQ((*rows)[1].point->kind, TaughtFrameKind::kWorkObject);
}

TEST(TaughtPoints, are_refused_with_the_points_that_there_are) {
  const Problem problem = refusal_of("frame,point,q1_deg,q2_mm\ntorch,tcp,90,250\n");
  EXPECT_EQ(problem.line, 2);
  EXPECT_EQ(problem.column, 7);
  EXPECT_EQ(problem.what, "unknown point \"tcp\"");
  EXPECT_EQ(problem.expected,
            "tip, x+, x-, y+, y-, z+ or z- of a tool; origin, x, y or xy of a work object");
}

TEST(TaughtPoints, are_refused_without_a_frame_without_rows_and_in_great_numbers) {
  EXPECT_EQ(refusal_of("frame,point,q1_deg,q2_mm\n,tip,90,250\n").what, "a frame without a name");
  EXPECT_EQ(refusal_of("frame,point,q1_deg,q2_mm\n").what, "the file ends after its header");
  EXPECT_EQ(refusal_of("point,q1_deg,q2_mm\ntip,90,250\n").what, "there is no column for frame");
  std::string log = "frame,point,q1_deg,q2_mm\n";
  for (std::size_t k = 0; k <= kMostTaughtRows; ++k) log += "torch,tip,90,250\n";
  EXPECT_EQ(refusal_of(log).what, "more than 500 rows");
}

// A file that is there while the test runs.
class TaughtFile {
 public:
  explicit TaughtFile(std::string_view text)
      : path_(std::filesystem::temp_directory_path() /
              ("armsig-taught-" + std::to_string(::getpid()))) {
    std::ofstream(path_) << text;
  }
  ~TaughtFile() { std::filesystem::remove(path_); }
  TaughtFile(const TaughtFile&) = delete;
  TaughtFile& operator=(const TaughtFile&) = delete;
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(TaughtPoints, of_other_software_are_mapped) {
  const TaughtFile file(
      "Teach pendant 4\nNo;Frame;Point;A1 [deg];Rail [mm]\n1;torch;x-;12,5;100\n");
  const auto table = read_taught_points(file.name(), "auto,q2_mm=Rail [mm]", kTwo);
  ASSERT_TRUE(table) << render(table.error());
  ASSERT_EQ(table->rows.size(), 1U);
  EXPECT_EQ(table->rows[0].line, 3U);
  EXPECT_EQ(table->rows[0].frame, "torch");
  EXPECT_EQ(table->rows[0].point->name, "x-");
  EXPECT_DOUBLE_EQ(table->rows[0].q[0], radians(12.5));
  EXPECT_DOUBLE_EQ(table->rows[0].q[1], 0.1);
  EXPECT_NE(table->mapped.find("not used: No"), std::string::npos) << table->mapped;
}

TEST(TaughtPoints, of_other_software_may_have_no_header) {
  const TaughtFile file("torch tip 90 250\ntorch tip 80 240\n");
  const auto table = read_taught_points(file.name(), "frame=@1,point=@2,q1_deg=@3,q2_mm=@4", kTwo);
  ASSERT_TRUE(table) << render(table.error());
  EXPECT_EQ(table->rows.size(), 2U);
  EXPECT_EQ(table->rows[1].line, 2U);
}

TEST(TaughtPoints, of_other_software_are_refused_without_their_columns) {
  const TaughtFile file("Point;A1 [deg];A2 [mm]\ntip;90;250\n");
  const Problem problem = test::failure_of(read_taught_points(file.name(), "auto", kTwo));
  EXPECT_EQ(problem.what,
            "no line of it names a frame, a point and the readings of 2 joints with their units");
  // One frame in all rows has a name all the same.
  EXPECT_TRUE(read_taught_points(file.name(), "auto,frame=#torch", kTwo));
}

TEST(TaughtPoints, of_other_software_have_names_without_commas) {
  const TaughtFile file("Frame;Point;A1 [deg];A2 [mm]\nmy, table;x;90;250\n");
  const Problem problem = test::failure_of(read_taught_points(file.name(), "auto", kTwo));
  EXPECT_EQ(problem.line, 2);
  EXPECT_EQ(problem.what, "Frame: \"my, table\" has a comma");
}

}  // namespace
}  // namespace armsig::tool
