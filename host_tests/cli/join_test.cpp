// SPDX-License-Identifier: MIT
// armsig join, from a simulated arm's measurements taken apart into a joint log and a tracker's
// points.
#include "host_tests/cli/files.hpp"
#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

TEST(Join, puts_together_what_was_taken_apart_and_finds_the_sweeps) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm puma560 --arc 120 --points 12 --sigma-mm 0.05 --seed 3"
                     " --out whole.csv --truth-out truth.yaml")
                .status,
            0);
  const Csv whole = Csv::read(folder / "whole.csv");
  std::string log = "Name;Target;A1 [deg];A2 [deg];A3 [deg];A4 [deg];A5 [deg];A6 [deg]\n";
  std::string points = "// Collection Group Target x y z\n";
  for (std::size_t k = 0; k < whole.rows.size(); ++k) {
    log += "P" + std::to_string(k) + ";" + whole.rows[k][whole.column("target")];
    for (int j = 1; j <= 6; ++j) {
      log += ";" + whole.rows[k][whole.column("q" + std::to_string(j) + "_deg")];
    }
    log += "\n";
    points += "A Sweeps P" + std::to_string(k);
    for (const char* axis : {"x_mm", "y_mm", "z_mm"})
      points += " " + whole.rows[k][whole.column(axis)];
    points += "\n";
  }
  write_file(folder / "log.txt", log);
  write_file(folder / "points.txt", points);
  const Outcome joined = run_tool(
      folder,
      "join --arm puma560 --joints log.txt --points points.txt --units mm --out joined.csv");
  ASSERT_EQ(joined.status, 0) << joined.err;
  EXPECT_NE(joined.out.find("joint 6 swept: 12 points"), std::string::npos) << joined.out;
  const Csv rows = Csv::read(folder / "joined.csv");
  ASSERT_EQ(rows.rows.size(), whole.rows.size());
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    EXPECT_EQ(rows.rows[k][rows.column("sweep")], whole.rows[k][whole.column("sweep")]) << k;
    EXPECT_NEAR(rows.number(k, "x_mm"), whole.number(k, "x_mm"), 1e-9);
    EXPECT_NEAR(rows.number(k, "q4_deg"), whole.number(k, "q4_deg"), 1e-9);
  }
  const Outcome found =
      run_tool(folder, "identify --arm puma560 --measurements joined.csv --out s.yaml");
  EXPECT_EQ(found.status, 0) << found.err;
}

TEST(Join, refuses_files_that_end_with_their_header) {
  const Folder folder;
  const std::string header = "Name;A1 [deg];A2 [deg];A3 [deg];A4 [deg];A5 [deg];A6 [deg]\n";
  write_file(folder / "log.txt", header + "P1;1;2;3;4;5;6\n");
  write_file(folder / "no-poses.txt", header);
  write_file(folder / "points.txt", "Name;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n");
  write_file(folder / "no-points.txt", "Name;X [mm];Y [mm];Z [mm]\n");
  const auto expect = [&](const std::string& log, const std::string& points,
                          const std::string& words) {
    for (const std::string by : {"name", "order", "time"}) {
      const Outcome joined = run_tool(folder, "join --arm puma560 --joints " + log + " --points " +
                                                  points + " --out joined.csv --by " + by);
      EXPECT_EQ(joined.status, 2) << by;
      EXPECT_EQ(joined.err, "armsig: " + words + "\n") << by;
    }
  };
  expect("log.txt", "no-points.txt",
         "no-points.txt:1: no rows below the header; expected a row for each point, with its "
         "position");
  expect("no-poses.txt", "points.txt",
         "no-poses.txt:1: no rows below the header; expected a row for each pose, with the joints' "
         "readings");
}

// A log of 100,000 rows, of which two are wanted: larger than any description.
TEST(Join, takes_a_long_log_and_warns_where_most_points_go_with_no_pose) {
  const Folder folder;
  std::string log = "Time;A1 [deg];A2 [deg]\n";
  for (int k = 0; k < 100000; ++k) {
    log += std::to_string(0.1 * k) + (k < 50000 ? ";10;20\n" : ";30;20\n");
  }
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "log.csv", log);
  const auto join = [&](const std::string& points) {
    write_file(folder / "points.csv", "Time;X [mm];Y [mm];Z [mm]\n" + points);
    return run_tool(folder,
                    "join --arm arm.yaml --joints log.csv --points points.csv --by time "
                    "--out joined.csv");
  };
  const Outcome both = join("1000;1;2;3\n9000;4;5;6\n");
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.err, "");
  const Csv rows = Csv::read(folder / "joined.csv");
  ASSERT_EQ(rows.rows.size(), 2U);
  EXPECT_EQ(rows.number(1, "q1_deg"), 30);
  // The arm moved at 5,000 s.
  const Outcome few = join("5000;1;2;3\n5000.1;1;2;3\n9000;4;5;6\n");
  EXPECT_EQ(few.status, 0);
  EXPECT_NE(few.err.find("warning: points.csv: 2 of 3 points go with no pose; are both times of "
                         "one clock"),
            std::string::npos)
      << few.err;
  EXPECT_NE(few.out.find("1 point with its pose, by time\n  2 points without a pose"),
            std::string::npos)
      << few.out;
}

TEST(Join, never_guesses_which_of_two_columns_is_meant) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "log.csv", "Name;A1 [deg];A2 [deg];J1 [deg];J2 [deg]\nP1;10;20;11;21\n");
  write_file(folder / "points.csv", "Name;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n");
  const Outcome outcome =
      run_tool(folder, "join --arm arm.yaml --joints log.csv --points points.csv --out joined.csv");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err,
            "armsig: log.csv:1: q1 may come from \"A1 [deg]\" or from \"J1 [deg]\"; expected "
            "--joint-columns auto,q1_deg=A1 [deg], or q1_deg=J1 [deg]\n");
}

// A reading, or positions, that no arm has: another unit than is said.
TEST(Join, refuses_what_no_arm_reads_or_reaches) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "log.csv", "Name;A1 [deg];A2 [deg]\nP1;10;20\nP2;30;9759\nP3;-90;20\n");
  write_file(folder / "points.csv", "Name;X [mm];Y [mm];Z [mm]\nP1;100;200;300\nP3;-400;0;0\n");
  const auto join = [&] {
    return run_tool(folder,
                    "join --arm arm.yaml --joints log.csv --points points.csv --out joined.csv");
  };
  EXPECT_EQ(join().err,
            "armsig: log.csv:3: joint 2 reads 9759.000°, its limits are -170.000° to 170.000°; "
            "expected readings in the unit that the header or --units says; whole turns taken off "
            "a joint that turns without an end\n");
  // Degrees in radians' columns.
  write_file(folder / "log.csv", "Name;A1 [rad];A2 [rad]\nP1;10;20\nP2;0;0\nP3;-90;20\n");
  EXPECT_EQ(join().err,
            "armsig: log.csv:2: joint 2 reads 1145.916°, its limits are -170.000° to 170.000°; 2 "
            "of 3 rows are so: the unit (degrees or radians) or the order of the joints is wrong; "
            "expected readings in the unit that the header or --units says, of the joints in the "
            "order of the arm description\n");
  write_file(folder / "log.csv", "Name;A1 [deg];A2 [deg]\nP1;10;20\nP3;-90;20\n");
  EXPECT_EQ(join().status, 0);
  std::filesystem::remove(folder / "joined.csv");
  // Metres, and micrometres, under the name of millimetres.
  write_file(folder / "points.csv", "Name;X [mm];Y [mm];Z [mm]\nP1;0.1;0.2;0.3\nP3;-0.4;0;0\n");
  EXPECT_NE(join().err.find("points.csv: positions of target 1 stay within 0.616 mm, and the arm "
                            "moves it by some"),
            std::string::npos);
  write_file(folder / "points.csv",
             "Name;X [mm];Y [mm];Z [mm]\nP1;100000;200000;300000\nP3;-400000;0;0\n");
  const Outcome far = join();
  EXPECT_EQ(far.status, 2);
  EXPECT_NE(far.err.find("points.csv: positions of target 1 lie 616 m apart, and the arm reaches "),
            std::string::npos)
      << far.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "joined.csv"));
}

TEST(Join, names_a_control_character) {
  const Folder folder;
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_file(folder / "log.csv", "Name;A1 [deg];A2 [deg]\nP1;10;20\nP\x1B[31m;30;20\n");
  write_file(folder / "points.csv", "Name;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n");
  const Outcome outcome =
      run_tool(folder, "join --arm arm.yaml --joints log.csv --points points.csv --out joined.csv");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "armsig: log.csv:3: the character \"\\x1B\"; expected printable text\n");
}

TEST(Join, refuses_in_one_line_with_status_2) {
  const Folder folder;
  write_file(folder / "log.txt", "Name;A1 [deg]\nP1;10\n");
  write_file(folder / "points.txt", "P1 1 2 3\n");
  const Outcome joined = run_tool(
      folder,
      "join --arm puma560 --joints log.txt --points points.txt --units mm --out joined.csv");
  EXPECT_EQ(joined.status, 2);
  EXPECT_NE(joined.err.find("log.txt:1: no header with the readings of 6 joints"),
            std::string::npos)
      << joined.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "joined.csv"));
}

}  // namespace
}  // namespace armsig::cli
