// SPDX-License-Identifier: MIT
// LinuxCNC settings evaluated by LinuxCNC: its own genserkins module, with the pins that the export
// sets.
#include <sstream>

#include "core/base/pose.hpp"
#include "host_tests/exports/exported_arm.hpp"
#include "host_tests/exports/linuxcnc_hal.hpp"

namespace armsig::cli {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

struct Settings {
  std::array<double, 6> offset_deg{};
  Pose X_S0;
  Pose X_6L;
};

Pose stated_pose(const std::string& text, const std::string& name) {
  std::map<std::string, double> value;
  const std::size_t start = text.find("# " + name + ": ") + name.size() + 4;
  for (const std::string& item : split(text.substr(start, text.find('\n', start) - start), ',')) {
    const std::size_t equals = item.find('=');
    value[item.substr(item.find_first_not_of(' '), equals - item.find_first_not_of(' '))] =
        std::stod(item.substr(equals + 1));
  }
  return {Eigen::Quaterniond(value.at("qw"), value.at("qx"), value.at("qy"), value.at("qz"))
              .toRotationMatrix(),
          Vector3(value.at("x_m"), value.at("y_m"), value.at("z_m"))};
}

// Sets the module's pins as LinuxCNC's `setp` does.
Settings load(const std::string& text) {
  for (auto& [name, pin] : linuxcnc::hal().pins) {
    if (name.starts_with("genserkins.unrotate-")) pin->whole = 0;
  }
  Settings settings{{}, stated_pose(text, "base"), stated_pose(text, "tool")};
  for (const std::string& line : split(text, '\n')) {
    if (!line.starts_with("setp ")) continue;  // what is not of genserkins: run_hal.py
    const Fields words = split(line, ' ');
    if (words[1].starts_with("joint-offset.")) {
      settings.offset_deg.at(static_cast<std::size_t>(words[1][13] - '0')) = std::stod(words[2]);
    } else if (words[1].starts_with("genserkins.unrotate-")) {
      linuxcnc::hal().pins.at(words[1])->whole = std::stoi(words[2]);
    } else {
      linuxcnc::hal().pins.at(words[1])->number = std::stod(words[2]);
    }
  }
  return settings;
}

Pose pose_of(const linuxcnc::EmcPose& pose) {
  const auto turn = [](double degrees, const Vector3& axis) {
    return Eigen::AngleAxisd(degrees * kDegree, axis).toRotationMatrix();
  };
  return {turn(pose.c, Vector3::UnitZ()) * turn(pose.b, Vector3::UnitY()) *
              turn(pose.a, Vector3::UnitX()),
          1e-3 * Vector3(pose.x, pose.y, pose.z)};
}

void expect_agreement(const Folder& folder) {
  const linuxcnc::Forward forward = linuxcnc::genserkins().forward;
  if (forward == nullptr) GTEST_SKIP() << "no genserkins module; toolchain/setup gets it";
  const Outcome exported = export_as(folder, "linuxcnc");
  ASSERT_EQ(exported.status, 0) << exported.err;
  const Settings settings = load(read_file(folder / "export.out"));
  const Csv joints = Csv::read(folder / "q.csv");
  const Csv expected = Csv::read(folder / "p.csv");
  for (std::size_t row = 0; row < joints.rows.size(); ++row) {
    // fb-out = fb-in - offset, says offset(9)
    std::array<double, 9> angles_deg{};
    for (std::size_t i = 0; i < 6; ++i) {
      angles_deg.at(i) = joints.number(row, joints.header[i]) - settings.offset_deg.at(i);
    }
    linuxcnc::EmcPose world{};
    long forward_flags = 0;
    long inverse_flags = 0;
    ASSERT_EQ(forward(angles_deg.data(), &world, &forward_flags, &inverse_flags), 0);
    const Pose X_SL = settings.X_S0 * pose_of(world) * settings.X_6L;
    const Vector3 p_S(expected.number(row, "x_m"), expected.number(row, "y_m"),
                      expected.number(row, "z_m"));
    EXPECT_LT((X_SL.p - p_S).norm(), kExportTolerance_m) << "row " << row;
  }
}

TEST(Genserkins, evaluates_the_settings_of_an_individual_puma) {
  const Folder folder;
  make_individual(folder, kPuma560);
  expect_agreement(folder);
}

TEST(Genserkins, evaluates_real_arms_with_d_of_hundreds_of_metres) {
  for (const char* name :
       {"ur10e-individual-a", "ur10e-individual-b", "puma560-stone1986-robot1"}) {
    SCOPED_TRACE(name);
    const std::string arm = shared_arm(name);
    if (arm.empty()) GTEST_SKIP() << "no arm descriptions in " << ARMSIG_SHARED_DATA;
    const Folder folder;
    make_individual(folder, arm, "");
    expect_agreement(folder);
  }
}

// The settings do not only state the offsets: joints that LinuxCNC moves reach the drives by them.
TEST(LinuxCncSettings, pass_commands_to_the_drives_and_readings_back) {
  const Folder folder;
  make_individual(folder, kPuma560);
  ASSERT_EQ(export_as(folder, "linuxcnc").status, 0);
  const std::string command = "cd '" + folder.path().string() +
                              "' && /usr/bin/python3 '" ARMSIG_RUN_HAL "' export.out >.ran 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  const std::string said = read_file(folder / ".ran");
  ASSERT_EQ(status, 0) << said;
  std::istringstream lines(said);
  for (int i = 0; i < 6; ++i) {
    double commanded = 1e9;
    double came_back = 1e9;
    double offset = 0;
    lines >> commanded >> came_back >> offset;
    EXPECT_NEAR(commanded, 10.0 * i + offset, 1e-9);
    EXPECT_NEAR(came_back, 10.0 * i, 1e-9);
    EXPECT_NE(offset, 0) << "an individual has offsets";
  }
}

TEST(LinuxCncSettings, say_the_units_and_limits_that_the_ini_file_needs) {
  const Folder folder;
  make_individual(folder, kPuma560, "");
  ASSERT_EQ(export_as(folder, "linuxcnc").status, 0);
  const std::string text = read_file(folder / "export.out");
  EXPECT_NE(text.find("LINEAR_UNITS = mm, ANGULAR_UNITS = degree"), std::string::npos);
  EXPECT_NE(text.find("[JOINT_0] TYPE = ANGULAR, MIN_LIMIT = -160.0000, MAX_LIMIT = 160.0000"),
            std::string::npos)
      << text;
}

TEST(Genserkins, takes_off_what_unrotate_stands_for) {
  const Folder folder;
  make_individual(folder, kCoupledArm);
  expect_agreement(folder);
}

}  // namespace
}  // namespace armsig::cli
