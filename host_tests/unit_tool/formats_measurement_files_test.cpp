// SPDX-License-Identifier: MIT
// Measurements as files: streamed, written, shared.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/measurements.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};
const std::string kHeader = "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n";
const std::string kRow = "1,7,90,250,1,-2,3.5\n";

TEST(Measurements, are_streamed_over_the_borders_of_the_read_buffer) {
  const std::string path = test::temporary("stream.csv");
  constexpr int kRows = 50000;  // several buffers of 256 KiB
  {
    std::ofstream file(path);
    file << kHeader;
    for (int i = 0; i < kRows; ++i)
      file << "1," << i % 32 << "," << 0.001 * i << ",0,1,2," << i << "\n";
  }
  int count = 0;
  const auto read = read_measurements(path, kTypes, [&](const MeasurementRow& row) -> Read<void> {
    EXPECT_EQ(row.target, count % 32);
    EXPECT_EQ(row.line, static_cast<std::size_t>(count + 2));
    EXPECT_EQ(row.p_S->z(), count / 1000.0);
    ++count;
    return {};
  });
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(*read, static_cast<std::size_t>(kRows));
  std::filesystem::remove(path);
}

TEST(Measurements, stop_at_a_problem_of_the_taker) {
  const std::string path = test::temporary("taker.csv");
  std::ofstream(path) << kHeader << kRow << kRow;
  const auto read = read_measurements(path, kTypes, [](const MeasurementRow& row) -> Read<void> {
    return problem_at(static_cast<int>(row.line), 0, "no", "yes");
  });
  ASSERT_FALSE(read);
  EXPECT_EQ(render(test::failure_of(read)), path + ":2: no; expected yes");
  std::filesystem::remove(path);
}

TEST(Measurements, tell_how_far_they_have_been_read) {
  auto reader = MeasurementReader::over(kHeader + kRow + kRow, "M.csv", kTypes);
  ASSERT_TRUE(reader);
  MeasurementRow row;
  EXPECT_TRUE(reader->next(row).value_or(false));
  EXPECT_LT(reader->progress().value_or(1), 1);
  EXPECT_TRUE(reader->next(row).value_or(false));
  EXPECT_FALSE(reader->next(row).value_or(true));
  EXPECT_EQ(reader->progress(), 1.0);
}

TEST(Measurements, say_why_a_file_cannot_be_opened) {
  EXPECT_EQ(render(test::failure_of(MeasurementReader::open("/nonexistent/M.csv", kTypes))),
            "/nonexistent/M.csv: can't be opened: No such file or directory");
}

TEST(MeasurementWriter, writes_positions_that_read_back) {
  const std::string path = test::temporary("written.csv");
  auto writer = MeasurementWriter::create(
      path, {.types = kTypes, .sigma = true, .comment = "seed 1\nsecond line"});
  ASSERT_TRUE(writer) << render(writer.error());
  MeasurementRow row;
  row.sweep = 2;
  row.target = -3;
  row.q = {1.0 / 3, -0.123456789012345678};
  row.p_S = Vector3(1.0 / 7, -2e-9, 1234.56789);
  row.sigma_m = 2e-4;
  writer->write(row);
  row.p_S.reset();
  row.sigma_m.reset();
  writer->write(row);
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_TRUE(writer->commit());
  std::vector<MeasurementRow> rows;
  ASSERT_TRUE(read_measurements(path, kTypes, [&](const MeasurementRow& read) -> Read<void> {
    rows.push_back(read);
    return {};
  }));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].line, 4U);
  EXPECT_EQ(rows[0].sweep, 2U);
  EXPECT_EQ(rows[0].target, -3);
  EXPECT_NEAR(rows[0].q[0], 1.0 / 3, 1e-16);
  EXPECT_NEAR(rows[0].q[1], -0.123456789012345678, 1e-16);
  EXPECT_LT((*rows[0].p_S - Vector3(1.0 / 7, -2e-9, 1234.56789)).norm(), 1e-12);
  EXPECT_NEAR(*rows[0].sigma_m, 2e-4, 1e-19);
  EXPECT_FALSE(rows[1].p_S);
  EXPECT_FALSE(rows[1].sigma_m);
  std::filesystem::remove(path);
}

TEST(MeasurementWriter, writes_ranges_that_read_back) {
  const std::string path = test::temporary("ranges.csv");
  auto writer = MeasurementWriter::create(path, {.types = kTypes, .receivers = 3, .air = true});
  ASSERT_TRUE(writer) << render(writer.error());
  MeasurementRow row;
  row.q = {0, 0};
  row.ranges_m = {1.5, std::nullopt, 2.25};
  row.air_c = 19.5;
  writer->write(row);
  ASSERT_TRUE(writer->commit());
  ASSERT_TRUE(read_measurements(path, kTypes, [&](const MeasurementRow& read) -> Read<void> {
    EXPECT_EQ(read.ranges_m[0], 1.5);
    EXPECT_FALSE(read.ranges_m[1]);
    EXPECT_EQ(read.ranges_m[2], 2.25);
    EXPECT_EQ(read.air_c, 19.5);
    return {};
  }));
  std::filesystem::remove(path);
}

TEST(MeasurementWriter, leaves_no_file_when_it_is_not_committed) {
  const std::filesystem::path folder = test::temporary("empty_folder");
  std::filesystem::create_directory(folder);
  {
    ASSERT_TRUE(MeasurementWriter::create(folder / "M.csv", {.types = kTypes}));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove(folder);
}

TEST(MeasurementWriter, refuses_what_is_not_finite) {
  const std::filesystem::path folder = test::temporary("nan_folder");
  std::filesystem::create_directory(folder);
  {
    auto writer = MeasurementWriter::create(folder / "M.csv", {.types = kTypes});
    ASSERT_TRUE(writer);
    MeasurementRow row;
    row.q = {std::nan(""), 0};
    writer->write(row);
    EXPECT_FALSE(writer->commit());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove(folder);
}

// The number of rows of a shared file; checks that each has a position.
std::size_t rows_in_shared(const std::string& name, const JointTypes& types) {
  const auto count = read_measurements(ARMSIG_SHARED_DATA "/" + name, types,
                                       [](const MeasurementRow& row) -> Read<void> {
                                         EXPECT_TRUE(row.p_S);
                                         return {};
                                       });
  EXPECT_TRUE(count) << render(count.error());
  return count.value_or(0);
}

TEST(Measurements, of_the_positioner_stage_are_read) {
  if (!std::filesystem::exists(ARMSIG_SHARED_DATA)) GTEST_SKIP() << "shared data are absent";
  EXPECT_EQ(
      rows_in_shared("positioner-stage/sweeps.csv", {JointType::kPrismatic, JointType::kRevolute,
                                                     JointType::kPrismatic, JointType::kPrismatic}),
      44U);
}

TEST(Measurements, of_the_laser_tracker_are_read) {
  if (!std::filesystem::exists(ARMSIG_SHARED_DATA)) GTEST_SKIP() << "shared data are absent";
  EXPECT_EQ(rows_in_shared("ur5-laser-tracker/grid.csv", JointTypes(6)), 1000U);
}

}  // namespace
}  // namespace armsig::tool
