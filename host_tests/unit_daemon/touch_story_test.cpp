// SPDX-License-Identifier: MIT
// An arm calibrated by a ball and sockets at its controller, from nothing to a signature in use:
// led into the sockets by hand, every touch by request, identified at a workstation, sent, accepted
// by a second person. The arm is an individual: geometry, gravity and joint error maps are wrong.
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/virtual_cabinet/bent_arm.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/tolerances.hpp"
#include "host_tests/unit_daemon/virtual_daemon.hpp"

namespace armsig::cli {
namespace {

constexpr int kSeed = 1;
constexpr int kTouches = 80;
constexpr int kSockets = 8;
constexpr cabinet::Bends kBends{.map_rad = radians(0.02), .sag_m = 1e-3};
const Vector3 kBall_m(0.012, -0.009, 0.154);  // the instrument says 0, 0, 150 mm

std::string place_name(int socket) {
  return std::string(1, static_cast<char>('A' + socket / 2)) + std::to_string(1 + socket % 2);
}

// The guide's files, with the touches in the folder.
void write_files(const Folder& folder) {
  const std::filesystem::path example = ARMSIG_EXAMPLE;
  std::string controller = read_file(example / "controller.yaml");
  const std::string file = "file: touches.csv";
  ASSERT_NE(controller.find(file), std::string::npos);
  controller.replace(controller.find(file), file.size(),
                     fmt::format("file: '{}'", (folder / "touches.csv").string()));
  write_file(folder / "controller.yaml", controller);
  write_file(folder / "instrument.yaml", read_file(example / "instrument.yaml"));
}

// armsigd about an arm whose geometry, gravity and joint error maps are wrong.
std::vector<std::string> individual() {
  return {"--seed",          std::to_string(kSeed),
          "--maps-deg",      std::to_string(degrees(kBends.map_rad)),
          "--deflection-mm", std::to_string(1e3 * kBends.sag_m)};
}

// Where the ball truly is, in frame 0 of the arm that armsigd draws.
class Truth {
 public:
  explicit Truth(const Arm& nominal) {
    simulated::Random random(kSeed);
    arm_.arm = simulated::drawn_arm(nominal, {}, random);
    simulated::Random bends(kSeed, 2);
    bent_ = cabinet::bent_model(nominal, kBends, bends);
  }
  [[nodiscard]] Vector3 ball(const JointVector& readings) const {
    return simulated::link_pose(arm_, cabinet::turned(bent_, readings), 6) * kBall_m;
  }

 private:
  simulated::SimulatedArm arm_;
  calibration::ArmModel bent_;
};

// RMS of the distances of `found` from `truth` after the best rigid motion.
double error_m(const Eigen::Matrix3Xd& found, const Eigen::Matrix3Xd& truth) {
  const Eigen::Matrix4d T = Eigen::umeyama(found, truth, false);
  const Eigen::Matrix3Xd turned = T.topLeftCorner<3, 3>() * found;
  const Vector3 shift = T.topRightCorner<3, 1>();
  const Eigen::Matrix3Xd left = turned.colwise() + shift - truth;
  return left.norm() / std::sqrt(static_cast<double>(found.cols()));
}

// Readings within the joint limits, as those of the touches are.
std::vector<JointVector> poses_anywhere() {
  simulated::Random random(7);
  std::vector<JointVector> poses;
  for (int k = 0; k < 400; ++k) {
    JointVector q(6);
    for (double& reading : q) reading = random.uniform(-kPi, kPi);
    poses.push_back(q);
  }
  return poses;
}

Eigen::Matrix3Xd true_balls(const Arm& nominal, const std::vector<JointVector>& poses) {
  const Truth truth(nominal);
  Eigen::Matrix3Xd balls(3, static_cast<Eigen::Index>(poses.size()));
  for (Eigen::Index k = 0; k < balls.cols(); ++k) {
    balls.col(k) = truth.ball(poses[static_cast<std::size_t>(k)]);
  }
  return balls;
}

Eigen::Matrix3Xd nominal_balls(const Arm& nominal, const std::vector<JointVector>& poses) {
  const simulated::SimulatedArm arm{.arm = nominal, .X_S0 = {}, .targets = {}};
  Eigen::Matrix3Xd balls(3, static_cast<Eigen::Index>(poses.size()));
  for (Eigen::Index k = 0; k < balls.cols(); ++k) {
    const Pose X_0F = simulated::link_pose(arm, poses[static_cast<std::size_t>(k)], 6);
    balls.col(k) = X_0F * Vector3(0, 0, 0.15);
  }
  return balls;
}

Eigen::Matrix3Xd predicted_balls(const Folder& folder, const std::string& signature,
                                 const std::vector<JointVector>& poses) {
  const JointTypes types(6, JointType::kRevolute);
  EXPECT_TRUE(tool::write_joint_poses((folder / "q.csv").string(), types, poses));
  const Outcome run = run_tool(
      folder, "predict --signature " + signature + " --joints q.csv --target 1 --out p.csv");
  EXPECT_EQ(run.status, 0) << run.err;
  const auto predicted = tool::read_tool_poses((folder / "p.csv").string());
  Eigen::Matrix3Xd balls = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(poses.size()));
  EXPECT_TRUE(predicted);
  if (!predicted) return balls;
  for (Eigen::Index k = 0; k < balls.cols(); ++k) {
    balls.col(k) = (*predicted)[static_cast<std::size_t>(k)].p;
  }
  return balls;
}

void lead_and_touch(VirtualDaemon& daemon, int touches) {
  for (int i = 0; i < touches; ++i) {
    const std::string place = place_name(i % kSockets);
    ASSERT_EQ(daemon.ask("emulate place=" + place), "ok");
    ASSERT_EQ(daemon.ask("touch place=" + place),
              fmt::format("ok place={} at_place={} touches={}", place, 1 + i / kSockets, i + 1));
  }
}

constexpr const char* kIdentify =
    "identify --arm nominal.yaml --instrument instrument.yaml --measurements touches.csv --out "
    "found.yaml";

bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

// The workstation's part, and the second person's.
void bring_into_use(const Folder& folder, VirtualDaemon& daemon) {
  const Outcome identified = run_tool(folder, kIdentify);
  ASSERT_EQ(identified.status, 0) << identified.err;
  EXPECT_TRUE(says(identified.out, "80 touches of 8 places: 0 rejected")) << identified.out;
  const Outcome sent = run_tool(folder, "connect console send found.yaml --by anna");
  ASSERT_EQ(sent.status, 0) << sent.err;
  EXPECT_TRUE(daemon.ask("accept by=anna").starts_with("error NOT_CONFIRMED "));
  ASSERT_EQ(daemon.ask("accept by=ben"), "ok");
  EXPECT_TRUE(says(daemon.ask("signature"), " sent_by=anna confirmed_by=ben "));
}

// Of six seeds the tool error is 0.109 to 0.137 mm, of this one 0.114 mm.
TEST(TouchStory, leads_from_nothing_to_a_signature_in_use) {
  const Folder folder;
  write_files(folder);
  VirtualDaemon daemon(folder, "0", individual(), (folder / "controller.yaml").string());
  ASSERT_TRUE(daemon.is_in("idle"));
  ASSERT_EQ(daemon.ask("signature"), "ok model=nominal");
  lead_and_touch(daemon, kTouches);
  // A ball that slipped, and a person who saw it.
  ASSERT_EQ(daemon.ask("emulate place=A1 slip_mm=3"), "ok");
  ASSERT_EQ(daemon.ask("touch place=A1"), "ok place=A1 at_place=11 touches=81");
  ASSERT_EQ(daemon.ask("drop-touch"), "ok place=A1 at_place=10 touches=80");
  EXPECT_EQ(daemon.ask("touches"),
            "ok touches=80 places=A1:10,A2:10,B1:10,B2:10,C1:10,C2:10,D1:10,D2:10");
  ASSERT_EQ(run_tool(folder, "connect console fetch nominal.yaml --what nominal").status, 0);
  bring_into_use(folder, daemon);

  ASSERT_EQ(run_tool(folder, "connect console fetch accepted.yaml").status, 0);
  const auto nominal = tool::read_arm_file((folder / "nominal.yaml").string());
  ASSERT_TRUE(nominal);
  const auto poses = poses_anywhere();
  const Eigen::Matrix3Xd truth = true_balls(nominal->arm, poses);
  EXPECT_GT(error_m(nominal_balls(nominal->arm, poses), truth), 2e-3);
  EXPECT_LT(error_m(predicted_balls(folder, "accepted.yaml", poses), truth), 0.14e-3);
}

TEST(TouchStory, ends_with_the_line_of_a_ball_that_slipped_where_nobody_saw_it) {
  const Folder folder;
  write_files(folder);
  VirtualDaemon daemon(folder, "0", individual(), (folder / "controller.yaml").string());
  ASSERT_TRUE(daemon.is_in("idle"));
  lead_and_touch(daemon, 40);
  ASSERT_EQ(daemon.ask("emulate place=B2 slip_mm=3"), "ok");
  ASSERT_TRUE(daemon.ask("touch place=B2").starts_with("ok "));
  ASSERT_EQ(run_tool(folder, "connect console fetch nominal.yaml --what nominal").status, 0);
  const Outcome identified = run_tool(folder, kIdentify);
  ASSERT_EQ(identified.status, 0) << identified.err;
  EXPECT_TRUE(says(identified.out, "41 touches of 8 places: 1 rejected")) << identified.out;
  EXPECT_TRUE(says(identified.err, "line 42: ") && says(identified.err, " mm off B2"))
      << identified.err;
}

}  // namespace
}  // namespace armsig::cli
