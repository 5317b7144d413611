// SPDX-License-Identifier: MIT
// The kinematics that makers and solvers write, and mimic joints with an offset.
#include <array>
#include <cmath>

#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

constexpr double kQuarter = 1.5707963267948966;

// Distances of the tool from the base origin and height, of an arm description at readings [deg].
struct ToolPlace {
  double x = 0, y = 0, z = 0;
};

ToolPlace tool_of(const Folder& folder, const std::string& arm, const std::string& readings) {
  EXPECT_EQ(run_tool(folder,
                     "simulate --sigma-mm 0 --arc 60 --points 10 --out m.csv "
                     "--truth-out t.yaml --arm " +
                         arm)
                .status,
            0);
  write_file(folder / "q.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n" + readings + "\n");
  EXPECT_EQ(run_tool(folder, "predict --signature t.yaml --joints q.csv --out p.csv").status, 0);
  const Csv poses = Csv::read(folder / "p.csv");
  return {poses.number(0, "x_m"), poses.number(0, "y_m"), poses.number(0, "z_m")};
}

constexpr const char* kUr5eYaml =
    "kinematics:\n"
    "  shoulder: {x: 0, y: 0, z: 0.1625, roll: -0, pitch: 0, yaw: -0}\n"
    "  upper_arm: {x: 0, y: 0, z: 0, roll: 1.570796327, pitch: 0, yaw: -0}\n"
    "  forearm: {x: -0.425, y: 0, z: 0, roll: -0, pitch: 0, yaw: -0}\n"
    "  wrist_1: {x: -0.3922, y: 0, z: 0.1333, roll: -0, pitch: 0, yaw: -0}\n"
    "  wrist_2: {x: 0, y: -0.0997, z: -2.044881182297852e-11, roll: 1.570796327, pitch: 0, yaw: "
    "-0}\n"
    "  wrist_3: {x: 0, y: 0.0996, z: -2.042830148012698e-11, roll: 1.570796326589793, pitch: "
    "3.141592653589793, yaw: 3.141592653589793}\n"
    "  hash: calib_12788084448423163542\n";

Outcome import_yaml(const Folder& folder, const std::string& option, const std::string& text) {
  write_file(folder / "k.yaml", text);
  return run_tool(folder, "import " + option + " k.yaml --out a.yaml");
}

TEST(ImportReaders, take_the_kinematics_of_universal_robots) {
  const Folder folder;
  const Outcome outcome = import_yaml(folder, "--ur-yaml", kUr5eYaml);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("1 is shoulder_pan_joint"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("the file has no limits"), std::string::npos);
  const std::string arm = read_file(folder / "a.yaml");
  for (const char* number : {"d_m: 0.1625", "a_m: -0.425", "a_m: -0.3922", "d_m: 0.1333",
                             "d_m: 0.0997", "d_m: 0.0996"}) {
    EXPECT_NE(arm.find(number), std::string::npos) << number << "\n" << arm;
  }
}

// The places that a description predicts for q.csv.
Csv places_by(const Folder& folder, const std::string& arm) {
  EXPECT_EQ(run_tool(folder,
                     "simulate --sigma-mm 0 --arc 60 --points 10 --out m.csv --truth-out "
                     "t.yaml --arm " +
                         arm)
                .status,
            0);
  EXPECT_EQ(run_tool(folder, "predict --signature t.yaml --joints q.csv --out x.csv").status, 0);
  return Csv::read(folder / "x.csv");
}

// Of an arm that was made to tolerances, as a URDF of it holds them.
TEST(ImportReaders, take_back_the_kinematics_that_were_exported) {
  const Folder folder;
  make_individual(folder, run_tool(folder, "arms --show ur5e").out);
  ASSERT_EQ(export_as(folder, "urdf").status, 0);
  ASSERT_EQ(run_tool(folder, "import --urdf export.out --base base_link --tip link_6 --out u.yaml")
                .status,
            0);
  ASSERT_EQ(export_as(folder, "ur-yaml").status, 0);
  const Outcome outcome = run_tool(folder, "import --ur-yaml export.out --out a.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Csv expected = places_by(folder, "u.yaml");
  const Csv found = places_by(folder, "a.yaml");
  const auto distance_m = [](const Csv& poses, std::size_t i) {
    return std::hypot(poses.number(i, "x_m") - poses.number(i - 1, "x_m"),
                      poses.number(i, "y_m") - poses.number(i - 1, "y_m"),
                      poses.number(i, "z_m") - poses.number(i - 1, "z_m"));
  };
  for (std::size_t i = 1; i < expected.rows.size(); ++i) {
    EXPECT_NEAR(distance_m(found, i), distance_m(expected, i), kExportTolerance_m);
  }
}

TEST(ImportReaders, say_what_is_wrong_with_the_kinematics_of_universal_robots) {
  const Folder folder;
  const auto said = [&](const std::string& text) {
    const Outcome outcome = import_yaml(folder, "--ur-yaml", text);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_NE(said("armsig: arm/1\n").find("there is no key kinematics"), std::string::npos);
  std::string text = kUr5eYaml;
  EXPECT_NE(said(text.replace(text.find("z: 0.1625"), 9, "z: 162.5"))
                .find("z of shoulder: 162.5; expected metres"),
            std::string::npos);
  text = kUr5eYaml;
  EXPECT_NE(said(text.replace(text.find("roll: 1.570796327"), 17, "roll: 90"))
                .find("roll of upper_arm: 90; expected radians"),
            std::string::npos);
}

constexpr const char* kOpwYaml =
    "opw_kinematics_geometric_parameters: {a1: 0.15, a2: -0.1, b: 0.02, c1: 0.525, c2: 0.77, c3: "
    "0.74, c4: 0.1}\n"
    "opw_kinematics_joint_offsets: [0.0, 0.0, deg(-90.0), 0.0, 0.0, deg(180.0)]\n"
    "opw_kinematics_joint_sign_corrections: [1, 1, -1, -1, -1, -1]\n";

// The equations of the paper of these arms, as they are printed there.
ToolPlace opw_place(const std::array<double, 6>& readings_rad) {
  constexpr std::array<double, 6> kSigns{1, 1, -1, -1, -1, -1};
  constexpr std::array<double, 6> kOffsets{0, 0, -kQuarter, 0, 0, 2 * kQuarter};
  std::array<double, 6> q{};
  for (std::size_t i = 0; i < 6; ++i) q.at(i) = readings_rad.at(i) * kSigns.at(i) - kOffsets.at(i);
  const double psi = std::atan2(-0.1, 0.74);
  const double k = std::hypot(-0.1, 0.74);
  const double s23 = std::sin(q[1] + q[2]);
  const double c23 = std::cos(q[1] + q[2]);
  const double x = 0.77 * std::sin(q[1]) + k * std::sin(q[1] + q[2] + psi) + 0.15;
  const double z = 0.77 * std::cos(q[1]) + k * std::cos(q[1] + q[2] + psi);
  // The z axis of the tool, before joint 1 turns it.
  const double along = std::cos(q[3]) * std::sin(q[4]);
  const double zx = c23 * along + s23 * std::cos(q[4]);
  const double zy = std::sin(q[3]) * std::sin(q[4]);
  const double zz = -s23 * along + c23 * std::cos(q[4]);
  const double cx = x + 0.1 * zx;
  const double cy = 0.02 + 0.1 * zy;
  return {cx * std::cos(q[0]) - cy * std::sin(q[0]), cx * std::sin(q[0]) + cy * std::cos(q[0]),
          z + 0.525 + 0.1 * zz};
}

TEST(ImportReaders, take_the_parameters_of_opw_kinematics) {
  const Folder folder;
  const Outcome outcome = import_yaml(folder, "--opw", kOpwYaml);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const double degree = kQuarter / 90;
  const ToolPlace first = tool_of(folder, "a.yaml", "10,20,-30,40,50,60");
  const ToolPlace second = tool_of(folder, "a.yaml", "-70,-15,25,80,-65,-110");
  const ToolPlace expected_first =
      opw_place({10 * degree, 20 * degree, -30 * degree, 40 * degree, 50 * degree, 60 * degree});
  const ToolPlace expected_second = opw_place(
      {-70 * degree, -15 * degree, 25 * degree, 80 * degree, -65 * degree, -110 * degree});
  EXPECT_NEAR(std::hypot(first.x - second.x, first.y - second.y, first.z - second.z),
              std::hypot(expected_first.x - expected_second.x, expected_first.y - expected_second.y,
                         expected_first.z - expected_second.z),
              1e-9);
}

TEST(ImportReaders, take_the_parameters_of_opw_kinematics_inside_of_other_keys) {
  const Folder folder;
  std::string inside = "manipulator:\n  plugin: opw\n";
  for (const std::string& line : split(kOpwYaml, '\n')) inside += "  " + line + "\n";
  ASSERT_EQ(import_yaml(folder, "--opw", kOpwYaml).status, 0);
  const std::string expected = read_file(folder / "a.yaml");
  const Outcome outcome = import_yaml(folder, "--opw", inside);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_file(folder / "a.yaml"), expected);
}

TEST(ImportReaders, say_what_is_wrong_with_the_parameters_of_opw_kinematics) {
  const Folder folder;
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string text = kOpwYaml;
    const Outcome outcome =
        import_yaml(folder, "--opw", text.replace(text.find(from), from.size(), to));
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_NE(said("deg(-90.0)", "-90.0")
                .find("opw_kinematics_joint_offsets: \"-90.0\"; expected radians, or such as"),
            std::string::npos);
  EXPECT_NE(
      said("[1, 1,", "[2, 1,").find("opw_kinematics_joint_sign_corrections: 2; expected 1 or -1"),
      std::string::npos);
  EXPECT_NE(said("c1: 0.525", "c1: 525")
                .find("c1 of opw_kinematics_geometric_parameters: 525; expected metres"),
            std::string::npos);
  EXPECT_NE(said("opw_kinematics_geometric_parameters", "opw")
                .find("there is no key opw_kinematics_geometric_parameters"),
            std::string::npos);
}

// The hand's joint turns by twice the first and 0.3 rad more, about the axis of the last.
constexpr const char* kMimicUrdf =
    "<robot name=\"m\"><link name=\"base\"/><link name=\"a\"/><link name=\"b\"/><link "
    "name=\"c\"/><link name=\"tip\"/>\n"
    "<joint name=\"j1\" type=\"revolute\"><parent link=\"base\"/><child link=\"a\"/>\n"
    "<origin xyz=\"0 0 0.3\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\"/></joint>\n"
    "<joint name=\"share\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\n"
    "<origin xyz=\"0.4 0 0\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 0 1\"/>\n"
    "<limit lower=\"-2\" upper=\"2\"/><mimic joint=\"j1\" multiplier=\"2\" "
    "offset=\"0.3\"/></joint>\n"
    "<joint name=\"j2\" type=\"revolute\"><parent link=\"b\"/><child link=\"c\"/>\n"
    "<axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\"/></joint>\n"
    "<joint name=\"f\" type=\"fixed\"><parent link=\"c\"/><child link=\"tip\"/>\n"
    "<origin xyz=\"0.2 0 0\"/></joint></robot>\n";

TEST(ImportReaders, take_the_offset_of_a_mimic_joint_into_the_geometry) {
  const Folder folder;
  write_file(folder / "m.urdf", kMimicUrdf);
  const Outcome outcome =
      run_tool(folder, "import --urdf m.urdf --base base --tip tip --out a.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string arm = read_file(folder / "a.yaml");
  EXPECT_NE(arm.find("{joint: 2, from: 1, ratio: 2}"), std::string::npos) << arm;
  EXPECT_NE(arm.find("theta_rad: 0.3"), std::string::npos) << arm;
}

TEST(ImportReaders, want_one_file) {
  const Folder folder;
  write_file(folder / "k.yaml", kOpwYaml);
  EXPECT_EQ(run_tool(folder, "import --opw k.yaml --dh k.yaml --out a.yaml").status, 2);
  EXPECT_EQ(run_tool(folder, "import --opw k.yaml --out k.yaml").status, 2);
}

}  // namespace
}  // namespace armsig::cli
