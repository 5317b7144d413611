// SPDX-License-Identifier: MIT
// Joints that turn without end: from the file to the signature, its exports and its solutions.
#include <fmt/format.h>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

// Joints 1, 4 and 6 turn without end.
constexpr const char* kEndlessUrdf =
    "<robot name=\"turns without end\">\n"
    "<link name=\"base\"/><link name=\"l1\"/><link name=\"l2\"/><link name=\"l3\"/>\n"
    "<link name=\"l4\"/><link name=\"l5\"/><link name=\"tip\"/>\n"
    "<joint name=\"j1\" type=\"continuous\"><parent link=\"base\"/><child link=\"l1\"/>\n"
    "<origin xyz=\"0 0 0.3\"/><axis xyz=\"0 0 1\"/></joint>\n"
    "<joint name=\"j2\" type=\"revolute\"><parent link=\"l1\"/><child link=\"l2\"/>\n"
    "<origin rpy=\"-1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/>\n"
    "<limit lower=\"-2.3\" upper=\"2.3\"/></joint>\n"
    "<joint name=\"j3\" type=\"revolute\"><parent link=\"l2\"/><child link=\"l3\"/>\n"
    "<origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2.6\" upper=\"2.6\"/></joint>\n"
    "<joint name=\"j4\" type=\"continuous\"><parent link=\"l3\"/><child link=\"l4\"/>\n"
    "<origin xyz=\"0 0.35 0\" rpy=\"-1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/></joint>\n"
    "<joint name=\"j5\" type=\"revolute\"><parent link=\"l4\"/><child link=\"l5\"/>\n"
    "<origin rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/>\n"
    "<limit lower=\"-2\" upper=\"2\"/></joint>\n"
    "<joint name=\"j6\" type=\"revolute\"><parent link=\"l5\"/><child link=\"tip\"/>\n"
    "<origin rpy=\"-1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/>\n"
    "<limit lower=\"-1e16\" upper=\"inf\"/></joint></robot>\n";

// Leaves arm.yaml, the measurements m.csv, and the signature truth.yaml of an arm so imported.
void import_endless(const Folder& folder) {
  write_file(folder / "r.urdf", kEndlessUrdf);
  const Outcome imported =
      run_tool(folder, "import --urdf r.urdf --base base --tip tip --out arm.yaml");
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_NE(imported.out.find("the limits of \"j6\" are so far away that they mean none"),
            std::string::npos)
      << imported.out;
  const Outcome simulated =
      run_tool(folder,
               "simulate --arm arm.yaml --configuration 0 -60 70 0 50 0 --sigma-mm 0.05 --arc 90 "
               "--points 20 --free-poses 60 "
               "--flange-target-mm 80,30,120 --tolerances 1 --seed 3 --out m.csv --truth-out "
               "truth.yaml");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
}

std::size_t times_in(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

TEST(ContinuousJoints, have_no_limits_in_the_description_and_the_signature) {
  const Folder folder;
  import_endless(folder);
  EXPECT_EQ(times_in(read_file(folder / "arm.yaml"), "limits: none"), 3U)
      << read_file(folder / "arm.yaml");
  EXPECT_EQ(times_in(read_file(folder / "truth.yaml"), "limits: none"), 3U);
}

TEST(ContinuousJoints, are_continuous_again_in_every_export) {
  const Folder folder;
  import_endless(folder);
  const auto exported = [&](const std::string& format) {
    const Outcome outcome =
        run_tool(folder, "export --signature truth.yaml --out export.out --format " + format);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_file(folder / "export.out");
  };
  const std::string urdf = exported("urdf");
  EXPECT_EQ(times_in(urdf, "type=\"continuous\""), 3U) << urdf;
  EXPECT_EQ(times_in(urdf, "<limit lower="), 3U) << urdf;
  EXPECT_EQ(times_in(exported("dh-csv"), ",,\n"), 3U);
  EXPECT_EQ(times_in(exported("mdh-csv"), ",,\n"), 3U);
  EXPECT_EQ(times_in(exported("rtb"), "qlim=None"), 3U);
  EXPECT_EQ(times_in(exported("linuxcnc-kins"), " none\n"), 3U);
  EXPECT_EQ(times_in(exported("linuxcnc"), "no MIN_LIMIT and no MAX_LIMIT"), 3U);
  const std::string json = exported("json");
  EXPECT_EQ(json.find("inf"), std::string::npos) << json;
}

TEST(ContinuousJoints, are_imported_from_their_own_exports) {
  const Folder folder;
  import_endless(folder);
  for (const auto& [format, how] : {std::pair{"urdf", "--urdf x --base base_link --tip last_link"},
                                    {"dh-csv", "--dh x"},
                                    {"mdh-csv", "--dh x"}}) {
    ASSERT_EQ(
        run_tool(folder, std::string("export --signature truth.yaml --out x --format ") + format)
            .status,
        0);
    const Outcome imported = run_tool(folder, std::string("import --out again.yaml ") + how);
    EXPECT_EQ(imported.status, 0) << imported.err;
    EXPECT_EQ(times_in(read_file(folder / "again.yaml"), "limits: none"), 3U) << format;
  }
}

// q1 and q6 near half a turn, and poses a little further on.
void write_turns(const Folder& folder, const std::string& file, double by_deg) {
  Csv q;
  q.header = {"q1_deg", "q2_deg", "q3_deg", "q4_deg", "q5_deg", "q6_deg"};
  q.rows = {{std::to_string(179.9 + by_deg), "-60", "70", "10", "50", "20"},
            {"20", "-60", "70", std::to_string(-179.9 - by_deg), "50", "20"},
            {"20", "-60", "70", "10", "50", std::to_string(539.9 + by_deg)}};
  q.write(folder / file);
}

TEST(ContinuousJoints, are_solved_the_short_way_from_a_seed) {
  const Folder folder;
  import_endless(folder);
  write_turns(folder, "seed.csv", 0);
  write_turns(folder, "asked.csv", 0.4);
  const Outcome predicted =
      run_tool(folder, "predict --signature truth.yaml --joints asked.csv --out p.csv");
  ASSERT_EQ(predicted.status, 0) << predicted.err;
  EXPECT_EQ(predicted.err.find("limit"), std::string::npos) << predicted.err;
  const Outcome solved =
      run_tool(folder, "solve --signature truth.yaml --poses p.csv --seed seed.csv --out q.csv");
  ASSERT_EQ(solved.status, 0) << solved.err;
  const Csv asked = Csv::read(folder / "asked.csv");
  const Csv found = Csv::read(folder / "q.csv");
  for (std::size_t k = 0; k < asked.rows.size(); ++k) {
    for (const std::string& joint : asked.header) {
      EXPECT_NEAR(found.number(k, joint), asked.number(k, joint), 1e-6) << joint;
    }
  }
}

// A controller that shows such a joint between -180 and 180 degrees: the rows of a sweep jump by a
// turn, and mean the same arm.
TEST(ContinuousJoints, may_be_logged_within_one_turn) {
  const Folder folder;
  import_endless(folder);
  const std::string simulate =
      "simulate --arm arm.yaml --truth truth.yaml --configuration 170 -60 70 170 50 170 --arc 300 "
      "--points 40 --sigma-mm 0.05 --free-poses 60 --flange-target-mm 80,30,120 --out m.csv";
  ASSERT_EQ(run_tool(folder, simulate).status, 0);
  Csv rows = Csv::read(folder / "m.csv");
  write_joint_poses(rows, folder / "q.csv");
  std::size_t wrapped = 0;
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (const char* joint : {"q1_deg", "q4_deg", "q6_deg"}) {
      const double within = std::remainder(rows.number(k, joint), 360);
      wrapped += static_cast<std::size_t>(std::abs(within - rows.number(k, joint)) > 1);
      rows.rows[k][rows.column(joint)] = fmt::format("{}", within);
    }
  }
  ASSERT_GT(wrapped, 50U);
  rows.write(folder / "w.csv");
  for (const char* name : {"m", "w"}) {
    const Outcome outcome = run_tool(
        folder, fmt::format("identify --arm arm.yaml --measurements {0}.csv --out {0}.yaml", name));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
  }
  EXPECT_LT(largest_distance(predict(folder, "m.yaml", "1"), predict(folder, "w.yaml", "1")), 5e-6);
}

// Ten turns of a joint without end are ten turns; of one with limits nobody gets there.
TEST(ContinuousJoints, count_their_turns) {
  const Folder folder;
  import_endless(folder);
  write_file(folder / "q.csv",
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n3610,-60,70,10,50,20\n"
             "10,-60,70,10,50,20\n");
  ASSERT_EQ(run_tool(folder, "predict --signature truth.yaml --joints q.csv --out p.csv").status,
            0);
  const Csv poses = Csv::read(folder / "p.csv");
  for (const char* number : {"x_m", "y_m", "z_m"}) {
    EXPECT_NEAR(poses.number(0, number), poses.number(1, number), 1e-12);
  }
  write_file(folder / "q.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,3600,70,10,50,20\n");
  EXPECT_EQ(run_tool(folder, "predict --signature truth.yaml --joints q.csv --out p.csv").status,
            1);
}

TEST(ContinuousJoints, are_identified_planned_and_reported_like_others) {
  const Folder folder;
  import_endless(folder);
  const auto done = [&](const std::string& command) {
    const Outcome outcome = run_tool(folder, command);
    EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.out << outcome.err;
    EXPECT_EQ(outcome.out.find("nan"), std::string::npos) << command << outcome.out;
    EXPECT_EQ(outcome.out.find("inf "), std::string::npos) << command << outcome.out;
  };
  done("plan --arm arm.yaml --out plan.csv");
  done("identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml");
  done("identify --arm arm.yaml --measurements m.csv --out e.yaml");
  done(
      "simulate --arm arm.yaml --truth truth.yaml --sigma-mm 0.05 --arc 60 --points 10 "
      "--free-poses 40 --flange-target-mm 80,30,120 --seed 8 --out later.csv");
  done("check --signature s.yaml --measurements later.csv");
  done("suggest --signature s.yaml --count 3 --out more.csv");
  done("report --signature s.yaml --measurements m.csv --out r.html");
  done("evaluate --arm arm.yaml --truth truth.yaml --signature s.yaml");
  done("export --signature s.yaml --format urdf --out s.urdf");
  done("export --signature s.yaml --into r.urdf --base base --tip tip --out c.urdf");
}

// LinuxCNC holds the last entry beyond the ends of a table, and a map goes on turn after turn.
TEST(ContinuousJoints, are_refused_where_their_map_would_be_a_table_with_ends) {
  const Folder folder;
  import_endless(folder);
  ASSERT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --arc 60 --points 10 --maps-deg 0.02 --out m.csv "
                     "--truth-out bent.yaml")
                .status,
            0);
  const Outcome outcome =
      run_tool(folder, "export --signature bent.yaml --format linuxcnc --out x.hal");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("linuxcnc can't hold this arm: joint 1 turns without end, and its map "
                             "is a table with ends; expected linuxcnc-kins"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(
      run_tool(folder, "export --signature bent.yaml --format linuxcnc-kins --out x.kins").status,
      0);
}

TEST(ContinuousJoints, are_refused_where_a_slide_or_a_unit_is_meant) {
  const Folder folder;
  const auto said = [&](const std::string& joint) {
    write_file(folder / "arm.yaml", "armsig: arm/1\nname: n\njoints:\n  - {" + joint + "}\n");
    return run_tool(folder, "arms --show arm.yaml").err +
           run_tool(folder, "plan --arm arm.yaml --out p.csv").err;
  };
  EXPECT_NE(said("type: prismatic, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits: none")
                .find("joint 1 is prismatic and has no limits; expected limits_mm or limits_m"),
            std::string::npos);
  EXPECT_NE(said("type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits: [0, 1]")
                .find("limits of joint 1 have no unit; expected limits_deg or limits_rad; or "
                      "limits: none"),
            std::string::npos);
  EXPECT_NE(said("type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, alpha_deg: 0, limits: none, "
                 "limits_deg: [0, 1]")
                .find("limits and limits_deg of joint 1; expected one of the two"),
            std::string::npos);
}

}  // namespace
}  // namespace armsig::cli
