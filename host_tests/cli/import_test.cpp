// SPDX-License-Identifier: MIT
// Arm descriptions out of URDF and Denavit-Hartenberg rows: the same arm, whatever way it came in.
#include <cmath>

#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

// Positions of the last link's frame of the arm description `arm` at the readings q.csv.
Csv positions_of(const Folder& folder, const std::string& arm) {
  EXPECT_EQ(
      run_tool(
          folder,
          "simulate --sigma-mm 0 --arc 60 --points 10 --out x.csv --truth-out x.yaml --arm " + arm)
          .status,
      0);
  EXPECT_EQ(run_tool(folder, "predict --signature x.yaml --joints q.csv --out x.csv").status, 0);
  return Csv::read(folder / "x.csv");
}

double distance_m(const Csv& poses, std::size_t i, std::size_t k) {
  return std::hypot(poses.number(i, "x_m") - poses.number(k, "x_m"),
                    poses.number(i, "y_m") - poses.number(k, "y_m"),
                    poses.number(i, "z_m") - poses.number(k, "z_m"));
}

// Distances between the poses do not depend on the frames that the description was given.
void expect_same_arm(const Folder& folder, const std::string& arm) {
  const Csv expected = positions_of(folder, "arm.yaml");
  const Csv imported = positions_of(folder, arm);
  ASSERT_EQ(imported.rows.size(), expected.rows.size());
  for (std::size_t i = 1; i < expected.rows.size(); ++i) {
    EXPECT_NEAR(distance_m(imported, i, i - 1), distance_m(expected, i, i - 1), kExportTolerance_m);
  }
}

// Exports the drawing itself in `format` and imports it again.
void expect_round_trip(const std::string& arm, const std::string& format,
                       const std::string& options) {
  SCOPED_TRACE(format);
  const Folder folder;
  make_individual(folder, arm, "");
  ASSERT_EQ(export_as(folder, format).status, 0);
  const Outcome imported =
      run_tool(folder, "import --out imported.yaml " + options + " export.out" +
                           (format == "urdf" ? " --base base_link --tip last_link" : ""));
  ASSERT_EQ(imported.status, 0) << imported.err;
  expect_same_arm(folder, "imported.yaml");
}

TEST(Import, takes_back_every_arm_that_was_exported) {
  for (const char* arm : {kPuma560, kStanfordArm}) {
    expect_round_trip(arm, "urdf", "--urdf");
    expect_round_trip(arm, "dh-csv", "--dh");
    expect_round_trip(arm, "mdh-csv", "--dh");
  }
}

TEST(Import, takes_back_a_coupling_from_a_mimic_joint) {
  expect_round_trip(kCoupledArm, "urdf", "--urdf");
}

TEST(Import, gives_the_rows_of_the_drawing_for_a_urdf_of_six_nested_right_angles) {
  const Folder folder;
  make_individual(folder, kPuma560, "");
  ASSERT_EQ(export_as(folder, "urdf").status, 0);
  ASSERT_EQ(
      run_tool(folder, "import --urdf export.out --base base_link --tip last_link --out i.yaml")
          .status,
      0);
  const std::string text = read_file(folder / "i.yaml");
  EXPECT_NE(text.find("alpha_rad: -1.5707963267948966"), std::string::npos) << text;
  EXPECT_NE(text.find("a_m: 0.4318"), std::string::npos) << text;
}

constexpr const char* kRobot =
    "<robot name=\"two\"><link name=\"base\"/><link name=\"one\"/><link name=\"tip\"/>\n"
    "<joint name=\"j1\" type=\"continuous\"><parent link=\"base\"/><child link=\"one\"/>\n"
    "<origin xyz=\"0 0 0.3\"/><axis xyz=\"0 0 1\"/></joint>\n"
    "<joint name=\"j2\" type=\"revolute\"><parent link=\"one\"/><child link=\"tip\"/>\n"
    "<origin xyz=\"0.5 0 0\" rpy=\"1.5708 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" "
    "upper=\"2\" "
    "effort=\"1\" velocity=\"1\"/></joint></robot>\n";

Outcome import_robot(const Folder& folder, const std::string& text,
                     const std::string& links = "--base base --tip tip") {
  write_file(folder / "r.urdf", text);
  return run_tool(folder, "import --urdf r.urdf --out a.yaml " + links);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Import, reads_continuous_joints_and_limits) {
  const Folder folder;
  const Outcome outcome = import_robot(folder, kRobot);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("1 is j1 and 2 is j2"), std::string::npos) << outcome.out;
  EXPECT_NE(read_file(folder / "a.yaml").find("limits_rad: [-1, 2]"), std::string::npos);
}

// A parser that looks each attribute up among those before it takes hours for these four megabytes.
TEST(Import, refuses_an_element_of_more_attributes_than_any_has) {
  const Folder folder;
  std::string attributes;
  for (int i = 0; attributes.size() < 4'000'000; ++i) {
    attributes += " a" + std::to_string(i) + "='>'";
  }
  const std::string text =
      "<!-- 'one quote --><robot name=\"r\">\n<link" + attributes + "/></robot>";
  const Outcome outcome = import_robot(folder, text, "--base base --tip tip");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("r.urdf:2: more than 64 attributes in one element"), std::string::npos)
      << outcome.err;
}

TEST(Import, says_that_a_chain_is_too_long_and_not_that_it_is_none) {
  const auto chain = [](int joints) {
    std::string text = "<robot name=\"r\"><link name=\"l0\"/>";
    for (int i = 1; i <= joints; ++i) {
      const std::string n = std::to_string(i);
      text += "<link name=\"l" + n + "\"/><joint name=\"j" + n + "\" type=\"" +
              (i == 1 ? "continuous" : "fixed") + "\"><parent link=\"l" + std::to_string(i - 1) +
              "\"/><child link=\"l" + n + "\"/></joint>";
    }
    return text + "</robot>";
  };
  const Folder folder;
  EXPECT_EQ(import_robot(folder, chain(256), "--base l0 --tip l256").status, 0);
  const Outcome longer = import_robot(folder, chain(257), "--base l0 --tip l257");
  EXPECT_EQ(longer.status, 2);
  EXPECT_NE(longer.err.find("more than 256 joints between link \"l257\" and link \"l0\""),
            std::string::npos)
      << longer.err;
}

TEST(Import, says_what_is_wrong_with_a_urdf) {
  const Folder folder;
  const auto expect = [&](const std::string& text, const std::string& what,
                          const std::string& links = "--base base --tip tip") {
    const Outcome outcome = import_robot(folder, text, links);
    EXPECT_EQ(outcome.status, 2) << what;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.yaml"));
  };
  expect("<robot", "r.urdf:1: not XML: an element has no end or no name; expected a URDF file");
  expect("", "r.urdf: not XML: nothing is in it");
  expect("no robot", "r.urdf:1: not XML: text that is in no element");
  expect("<robot>\n<link>\n</robot>", "not XML: an element is not closed, or under another name");
  expect("<robot name=x/>", "not XML: an attribute is not NAME=\"VALUE\"");
  expect("<robot><xacro:include filename=\"a\"/></robot>",
         "r.urdf:1: xacro that is not expanded; expected xacro FILE -o arm.urdf first");
  expect("<a/>", "there is no robot in the file");
  expect(kRobot, "there is no link \"hand\"; expected", "--base base --tip hand");
  expect(kRobot, "is not below link", "--base tip --tip base");
  expect(kRobot, "no joint moves between", "--base tip --tip tip");
  expect(with(kRobot, "revolute", "planar"), "joint \"j2\" is of type \"planar\"");
  expect(with(kRobot, "upper=\"2\"", "upper=\"-2\""), "is not below upper");
  expect(with(kRobot, "0.5 0 0", "0.5 0"), "xyz: nothing where a number should be");
  expect(with(kRobot, "0 0 0.3", "0 0 O.3"), "r.urdf:3: xyz: \"O.3\" is not a number");
  expect(with(kRobot, "<limit", "<mimic joint=\"j1\"/><limit"), "mimics another joint by itself");
  expect(with(kRobot, "<axis xyz=\"0 0 1\"/></joint>\n<joint",
              "<axis xyz=\"0 0 0\"/></joint>\n<joint"),
         "axis of joint \"j1\" has no length");
}

TEST(Import, says_what_is_wrong_with_denavit_hartenberg_rows) {
  const Folder folder;
  const auto expect = [&](const std::string& text, const std::string& what) {
    write_file(folder / "dh.csv", text);
    const Outcome outcome = run_tool(folder, "import --dh dh.csv --out a.yaml");
    EXPECT_EQ(outcome.status, 2) << what;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
  };
  expect("", "the file is empty");
  expect("theta_deg,d_mm,a_mm,alpha_deg\n", "the file ends after its header");
  expect("theta_deg,d_mm,a_mm\n0,0,0\n",
         "there is no column for alpha; expected alpha_deg or alpha_rad");
  expect("theta_deg,d_mm,a_mm,twist\n0,0,0,0\n", "unknown column \"twist\"");
  expect("theta_deg,d_mm,a_mm,alpha_deg\n0,0,0\n",
         "dh.csv:2:6: the row ends after 3 of 4 fields; expected alpha_deg next");
  expect("theta_deg,d_mm,a_mm,alpha_deg\n0,0,0,0,7\n", "\"7\" follows the last of 4 fields");
  expect("theta_deg,d_mm,a_mm,alpha_deg\n0,x,0,0\n", "dh.csv:2:3: d_mm: \"x\" is not a number");
  expect("theta_deg,d_mm,a_mm,alpha_deg,alpha_prev_deg,a_prev_mm\n0,0,0,0,0,0\n",
         "there are columns of standard rows (a, alpha) and of modified ones; expected one");
  expect("theta_deg,d_mm,a_mm,alpha_deg,lower_rad_or_m\n0,0,0,0,-1\n",
         "there is no column for upper_rad_or_m");
  expect("type,theta_deg,d_mm,a_mm,alpha_deg\nhinge,0,0,0,0\n", "type: \"hinge\"");
  expect("type,theta_deg,d_mm,a_mm,alpha_deg\nprismatic,0,0,0,0\n", "has no limits");
}

TEST(Import, reads_degrees_and_millimetres_and_says_that_limits_are_missing) {
  const Folder folder;
  write_file(folder / "dh.csv", "d_mm,theta_deg,alpha_deg,a_mm\n100,0,90,300\n0,0,0,250\n");
  const Outcome outcome = run_tool(folder, "import --dh dh.csv --name mine --out a.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("the file has no limits"), std::string::npos);
  const std::string text = read_file(folder / "a.yaml");
  EXPECT_NE(text.find("mine"), std::string::npos);
  EXPECT_NE(text.find("alpha_rad: 1.5707963267948966"), std::string::npos) << text;
}

TEST(Import, wants_one_source) {
  const Folder folder;
  EXPECT_EQ(run_tool(folder, "import --out a.yaml").status, 2);
  EXPECT_EQ(run_tool(folder, "import --urdf r.urdf --out a.yaml").status, 2);
}

}  // namespace
}  // namespace armsig::cli
