// SPDX-License-Identifier: MIT
// What the kinematics module of LinuxCNC reads and computes, without LinuxCNC.
#include <cmath>
#include <limits>

#include "firmware/formats/poses.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/linuxcnc/kins.hpp"
#include "firmware/linuxcnc/kins_file.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"
#include "host_tests/exports/exported_arm.hpp"

namespace armsig::cli {
namespace {

using linuxcnc::Kins;
using linuxcnc::KinsModel;
using linuxcnc::WorldPose;

const std::string kBent = "--tolerances 1 --maps-deg 0.02 --deflection-mm 0.5";
// Half a step of a map's 16 bits turns the longest arm by this.
constexpr double kPacked_m = 2e-8;

std::string exported(const Folder& folder) {
  const Outcome outcome = export_as(folder, "linuxcnc-kins");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return read_file(folder / "export.out");
}

KinsModel model_in(const Folder& folder) {
  const std::string text = exported(folder);
  const auto model = linuxcnc::parse_kins(text);
  EXPECT_TRUE(model) << model.error().line << ": " << model.error().what;
  return model ? *model : KinsModel{};
}

Pose pose_of(const WorldPose& world) {
  const Vector3& abc = world.abc_deg;
  return {rotation_of({radians(abc.x()), radians(abc.y()), radians(abc.z())}), 1e-3 * world.p_mm};
}

std::vector<double> in_their_units(const Arm& arm, const JointVector& q) {
  std::vector<double> joints;
  for (std::size_t i = 0; i < q.size(); ++i) {
    joints.push_back(arm.joints[i].type == JointType::kRevolute ? degrees(q[i]) : 1e3 * q[i]);
  }
  return joints;
}

// The readings of q.csv by the module against what `armsig predict` says of them.
void expect_predicted_poses(const Folder& folder, double tolerance_m) {
  const KinsModel model = model_in(folder);
  const Kins kins(model, model.X_nL.p);
  const auto record = tool::read_signature_file((folder / "truth.yaml").string());
  ASSERT_TRUE(record);
  const auto q = tool::read_joint_poses((folder / "q.csv").string(), record->signature.types);
  const auto X_SL = tool::read_tool_poses((folder / "p.csv").string());
  ASSERT_TRUE(q && X_SL);
  ASSERT_EQ(q->size(), kPoses);
  for (std::size_t row = 0; row < q->size(); ++row) {
    const std::vector<double> joints = in_their_units(model.arm, (*q)[row]);
    WorldPose world;
    ASSERT_TRUE(kins.forward(joints, world));
    const Pose X_SL_here = record->signature.X_SL[0] * pose_of(world);
    EXPECT_LT((X_SL_here.p - (*X_SL)[row].p).norm(), tolerance_m) << "row " << row;
    EXPECT_LT((X_SL_here.R - (*X_SL)[row].R).norm(), 1e-7) << "row " << row;
    // And back, from a few degrees or millimetres away.
    std::vector<double> found = joints;
    for (double& joint : found) joint += 2;
    const auto answer = kins.inverse(world, found);
    if (!answer.refusal.empty()) {
      EXPECT_EQ(answer.refusal, "a joint limit is in the way") << "row " << row;
      continue;
    }
    WorldPose again;
    ASSERT_TRUE(kins.forward(found, again));
    EXPECT_LT((again.p_mm - world.p_mm).norm(), 1e-6) << "row " << row;
    EXPECT_LT((pose_of(again).R - pose_of(world).R).norm(), 1e-8) << "row " << row;
  }
}

TEST(LinuxCncKins, moves_an_individual_as_predict_says) {
  const Folder folder;
  make_individual(folder, kPuma560);
  expect_predicted_poses(folder, kExportTolerance_m);
}

TEST(LinuxCncKins, carries_gravity_maps_couplings_and_slides) {
  for (const char* arm : {kPuma560, kStanfordArm, kCoupledArm}) {
    const Folder folder;
    make_individual(folder, arm, kBent);
    expect_predicted_poses(folder, kPacked_m);
  }
}

TEST(LinuxCncKins, moves_a_target_of_the_signature_where_it_is_asked_to) {
  const Folder folder;
  make_individual(folder, kPuma560);
  const KinsModel model = model_in(folder);
  ASSERT_FALSE(model.tools.empty());
  const linuxcnc::ToolPoint& point = model.tools[0];
  const Outcome predicted =
      run_tool(folder, "predict --signature truth.yaml --joints q.csv --out t.csv --target " +
                           std::to_string(point.number));
  ASSERT_EQ(predicted.status, 0) << predicted.err;
  const auto record = tool::read_signature_file((folder / "truth.yaml").string());
  const auto q = tool::read_joint_poses((folder / "q.csv").string(), record->signature.types);
  const auto X_ST = tool::read_tool_poses((folder / "t.csv").string());
  ASSERT_TRUE(q && X_ST);
  const Kins kins(model, point.p_nT);
  WorldPose world;
  ASSERT_TRUE(kins.forward(in_their_units(model.arm, (*q)[0]), world));
  const Pose X_ST_here = record->signature.X_SL[0] * pose_of(world);
  EXPECT_LT((X_ST_here.p - (*X_ST)[0].p).norm(), kExportTolerance_m);
}

// The drawing's own wrist, straight: joints 4 and 6 turn about one line.
TEST(LinuxCncKins, leaves_a_singular_home_in_every_direction) {
  const Folder folder;
  make_individual(folder, kPuma560, "");
  const KinsModel model = model_in(folder);
  const Kins kins(model, model.X_nL.p);
  const std::vector<double> home{20, -70, 40, 35, 0, 25};
  WorldPose at_home;
  ASSERT_TRUE(kins.forward(home, at_home));
  for (const Vector3& direction : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1),
                                   Vector3(-1, 2, 3), Vector3(1, 1, -1)}) {
    std::vector<double> joints = home;
    WorldPose there = at_home;
    for (int step = 0; step < 100; ++step) {
      const auto answer = kins.inverse(there, joints);
      ASSERT_EQ(answer.refusal, "") << direction.transpose() << ", step " << step;
      if (step == 0) {
        EXPECT_LT(answer.regularity, 1e-9);
        for (std::size_t i = 0; i < home.size(); ++i) EXPECT_NEAR(joints[i], home[i], 1e-6);
      }
      WorldPose here;
      ASSERT_TRUE(kins.forward(joints, here));
      EXPECT_LT((here.p_mm - there.p_mm).norm(), 1e-5);
      there.p_mm += 0.1 * direction;
    }
  }
}

TEST(LinuxCncKins, refuses_what_cannot_be_met_and_leaves_the_joints_where_they_are) {
  const Folder folder;
  make_individual(folder, kPuma560);
  const KinsModel model = model_in(folder);
  const Kins kins(model, model.X_nL.p);
  const std::vector<double> home{0, -90, 90, 10, 20, 30};
  std::vector<double> at_a_limit = home;
  at_a_limit[0] = 155;  // of 160 degrees
  WorldPose at_home;
  ASSERT_TRUE(kins.forward(home, at_home));
  WorldPose far = at_home;
  far.p_mm.x() = 5000;
  WorldPose nowhere = at_home;
  nowhere.abc_deg.y() = std::numeric_limits<double>::quiet_NaN();
  WorldPose beyond;
  std::vector<double> past_it = at_a_limit;
  past_it[0] = 165;
  ASSERT_TRUE(kins.forward(past_it, beyond));
  const struct {
    WorldPose pose;
    std::vector<double> from;
    std::string_view words;
  } cases[] = {
      {far, home, "out of reach"},
      {nowhere, home, describe(Error::kNotFinite)},
      {beyond, at_a_limit, "a joint limit is in the way"},
  };
  for (const auto& [pose, from, words] : cases) {
    std::vector<double> joints = from;
    EXPECT_EQ(kins.inverse(pose, joints).refusal, words);
    EXPECT_EQ(joints, from);
  }
  WorldPose untouched = at_home;
  std::vector<double> not_finite = home;
  not_finite[2] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(kins.forward(not_finite, untouched));
  EXPECT_EQ(untouched.p_mm, at_home.p_mm);
}

TEST(LinuxCncKins, puts_an_arm_of_two_joints_where_it_is_asked_to_be) {
  const Folder folder;
  make_individual(folder, kTwoJointArm);
  const KinsModel model = model_in(folder);
  const Kins kins(model, model.X_nL.p);
  WorldPose there;
  ASSERT_TRUE(kins.forward(std::vector<double>{30, -40}, there));
  there.abc_deg += Vector3(5, 5, 5);  // which two joints can't turn to
  std::vector<double> joints{20, -30};
  ASSERT_EQ(kins.inverse(there, joints).refusal, "");
  EXPECT_NEAR(joints[0], 30, 1e-6);
  EXPECT_NEAR(joints[1], -40, 1e-6);
}

}  // namespace
}  // namespace armsig::cli
