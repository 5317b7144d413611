// SPDX-License-Identifier: MIT
// Arms of fewer than six joints, as individuals with their signature in the store: lines of the
// tool and the grid, by the console, keep the position, and tell by how much the orientation is
// missed.
#include "host_tests/support/short_arms.hpp"

#include <array>
#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "firmware/controller/controller.hpp"
#include "firmware/controller/position_keeper.hpp"
#include "firmware/controller/record_store.hpp"
#include "firmware/controller/signature_store.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/set_drives.hpp"
#include "host_tests/support/silent_sensor.hpp"

namespace armsig::controller {
namespace {

using test::KnownArm;
using test::ShortArm;

constexpr double kSpeed = 1.5;         // rad/s or m/s of every joint
constexpr double kAcceleration = 4.5;  // rad/s2 or m/s2
constexpr int kIndividuals = 8;

// The line as the console is told it, in whole tenths of a millimetre.
Vector3 way_in_tenths(const Vector3& way) { return (way * 1e4).array().round().matrix() * 1e-4; }
std::string line_of(const Vector3& way) {
  std::string request = "move";
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto tenths = static_cast<long>(std::lround(way[axis] * 1e4));
    request += std::string(" d") + "xyz"[axis] + "_mm=" + std::to_string(tenths / 10) + "." +
               std::to_string(std::labs(tenths % 10));
  }
  return request;
}

Configuration configured(const ShortArm& arm) {
  Configuration c = test::puma_controller();
  const std::size_t joints = arm.at.size();
  c.drawing = arm.arm.drawing;
  c.limits.speed = JointVector(joints, kSpeed);
  c.limits.acceleration = JointVector(joints, kAcceleration);
  c.supervision.following_error = JointVector(joints, 0.05);
  c.sweeps.configuration = arm.at;
  return c;
}

// What an identification without an error would have found of `built`, in the base of the arm.
SignatureRecord signature_of(const ShortArm& arm, const KnownArm& built) {
  SignatureRecord record;
  record.machine = *machine_of(arm.arm.drawing, test::SetDrives(arm.at.size()));
  Signature& signature = record.signature;
  signature.types = types_of(built.joints);
  signature.configuration = arm.at;
  signature.X_SL = dh_frames(built.joints, arm.at);
  signature.targets.push_back({.number = 1,
                               .link = arm.at.size(),
                               .p_S = signature.X_SL.back() * arm.p_nT,
                               .covariance_m2 = Matrix3::Zero()});
  return record;
}

// The controller about drives that are where they were told to be, and its tool by the rows of the
// arm as it was built.
struct ShortCabinet {
  ShortCabinet(const ShortArm& arm, const KnownArm& built, const Configuration& configuration)
      : short_arm(arm), rows(built.joints), drives(arm.at.size()) {
    SignatureStore store(memory);
    SignatureRecord record;
    (void)store.load(configuration.drawing, record);
    store.begin_write(signature_of(arm, built));
    while (!store.step().value_or(true)) {
    }
    drives.actual = readings_for(configuration.drawing.couplings, arm.at);
    keep_rest();
    controller =
        std::make_unique<Controller>(configuration, drives, sensor, clock, memory, consoles);
    period = configuration.period;
  }
  // The arm was left where it is.
  void keep_rest() {
    PositionKeeper keeper(memory, RecordStore(memory).sectors());
    (void)keeper.load(drives.actual.size());
    keeper.begin({.positions = short_arm.at, .drives = DriveMarks(drives.actual.size(), 0)});
    keeper.step();
  }
  void step() {
    if (!drives.targets.empty()) drives.actual = drives.targets;
    controller->tick({});
    controller->background();
    clock.wait_until(next += period);
  }
  std::string ask(const std::string& request) {
    const std::size_t before = console.replies.size();
    console.requests.push_back(request);
    for (int i = 0; i < 500 && console.replies.size() == before; ++i) step();
    return console.replies.size() == before ? "" : console.replies.back();
  }
  void hold() {
    step();
    ASSERT_EQ(ask("enable"), "ok");
    drives.set_all(hal::DriveCondition::kEnabled);
    for (hal::DriveStatus& status : drives.statuses) status.has_torque = true;
    step();
    step();
    ASSERT_EQ(now().mode, Mode::kHolding);
  }
  [[nodiscard]] const Snapshot& now() const { return controller->state().snapshot(); }
  [[nodiscard]] Pose tool(const JointVector& q) const {
    const Pose X_0n = dh_frames(rows, q).back();
    return {X_0n.R, X_0n * short_arm.p_nT};
  }

  ShortArm short_arm;
  DhRows rows;
  test::SetDrives drives;
  test::RamMemory memory;
  test::SilentSensor sensor;
  simulated::VirtualClock clock;
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  std::unique_ptr<Controller> controller;
  hal::Duration period{};
  hal::Instant next;
};

constexpr std::string_view kMissed = " orientation_missed_deg=";

double missed_deg(const std::string& line) {
  const std::size_t at = line.find(kMissed);
  EXPECT_NE(at, std::string::npos) << line;
  if (at == std::string::npos) return -1;
  return std::strtod(line.c_str() + at + kMissed.size(), nullptr);
}

struct Travelled {
  double off_line_m = 0;  // the furthest
  double missed_rad = 0;  // the orientation, at most
  double speed = 0;       // of any joint, at most
  double acceleration = 0;
};

// Until the arm holds again.
Travelled travel(ShortCabinet& cabinet, const Pose& from, const Vector3& way) {
  Travelled seen;
  const Vector3 along = way.normalized();
  JointVector before = cabinet.now().commanded;
  JointVector speed_before(before.size(), 0.0);
  const double period_s = hal::seconds(cabinet.period);
  for (int i = 0; i < 10'000; ++i) {
    cabinet.step();
    const JointVector& q = cabinet.now().commanded;
    const Pose at = cabinet.tool(q);
    const Vector3 off = at.p - from.p;
    seen.off_line_m = std::max(seen.off_line_m, (off - along.dot(off) * along).norm());
    seen.missed_rad = std::max(seen.missed_rad, angle_between(from.R, at.R));
    for (std::size_t j = 0; j < q.size(); ++j) {
      const double speed = (q[j] - before[j]) / period_s;
      seen.speed = std::max(seen.speed, std::abs(speed));
      seen.acceleration = std::max(seen.acceleration, std::abs(speed - speed_before[j]) / period_s);
      speed_before[j] = speed;
    }
    before = q;
    if (cabinet.now().mode != Mode::kServoing) break;
  }
  return seen;
}

void expect_line(const ShortArm& arm, const KnownArm& built) {
  ShortCabinet cabinet(arm, built, configured(arm));
  cabinet.hold();
  ASSERT_TRUE(cabinet.controller->state().active());
  const Pose from = cabinet.tool(arm.at);
  const Vector3 way = way_in_tenths(arm.way);
  const std::string reply = cabinet.ask(line_of(way));
  ASSERT_TRUE(reply.starts_with("ok")) << built.name << ": " << reply;
  const Travelled seen = travel(cabinet, from, way);
  EXPECT_FALSE(cabinet.now().fault) << built.name << describe(cabinet.now().fault->error);
  EXPECT_EQ(cabinet.now().mode, Mode::kHolding) << built.name;
  const Pose to = cabinet.tool(cabinet.now().commanded);
  EXPECT_LT((to.p - from.p - way).norm(), 1e-8) << built.name;
  EXPECT_LT(seen.off_line_m, 1e-8) << built.name;
  // Between the samples of the plan, and to as many digits as are told.
  EXPECT_NEAR(degrees(seen.missed_rad), missed_deg(reply), 1e-4 + 1e-3 * missed_deg(reply))
      << built.name;
  EXPECT_LE(seen.speed, kSpeed) << built.name;
  EXPECT_LE(seen.acceleration, kAcceleration) << built.name;
}

TEST(ShortArms, carry_the_tool_along_a_line_and_tell_by_how_much_they_turn_it) {
  for (const ShortArm& arm : test::short_arms()) {
    std::mt19937_64 random(1);
    expect_line(arm, arm.arm);
    for (int k = 0; k < kIndividuals; ++k) expect_line(arm, test::individual(arm.arm, random));
  }
}

// The angles by hand: as drawn these arms keep the tool upright, and turn it back as they go.
TEST(ShortArms, as_drawn_miss_no_orientation_that_their_joints_can_keep) {
  for (const ShortArm& arm : test::short_arms()) {
    if (arm.arm.name != "cobra600" && arm.arm.name != "gantry") continue;
    ShortCabinet cabinet(arm, arm.arm, configured(arm));
    cabinet.hold();
    EXPECT_EQ(cabinet.ask(line_of(arm.way)), "ok orientation_missed_deg=0.0000") << arm.arm.name;
  }
}

// The elbow at 60 degrees, 10 mm: with the nominal axes it goes as well.
TEST(ShortArms, scara_with_its_signature_goes_where_its_nominal_model_goes) {
  const ShortArm arm{test::cobra600(), {0.06, 0, 0.08}, {0, radians(60), 0.1, 0}, {0.01, 0, 0}};
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937_64 random(seed);
    expect_line(arm, test::individual(arm.arm, random));
  }
}

TEST(ShortArms, slide_at_its_limit_refuses_the_line_for_its_joint_limit) {
  std::mt19937_64 random(2);
  ShortArm arm{test::cobra600(), {0.06, 0, 0.08}, {0.2, radians(60), 0.205, 0.3}, {0, 0, -0.02}};
  for (int k = 0; k < kIndividuals; ++k) {
    ShortCabinet cabinet(arm, test::individual(arm.arm, random), configured(arm));
    cabinet.hold();
    const std::string reply = cabinet.ask(line_of(arm.way));
    EXPECT_TRUE(reply.starts_with("error JOINT_LIMIT ")) << reply;
    EXPECT_EQ(reply.find(kMissed), std::string::npos) << reply;
  }
}

TEST(ShortArms, line_beyond_their_reach_or_through_a_straight_elbow_is_refused) {
  std::mt19937_64 random(3);
  const ShortArm arm{test::cobra600(), {0.06, 0, 0.08}, {0.2, radians(40), 0.1, 0.3}, {}};
  for (int k = 0; k < kIndividuals; ++k) {
    ShortCabinet cabinet(arm, test::individual(arm.arm, random), configured(arm));
    cabinet.hold();
    for (const char* line : {"move dx_mm=150", "move dx_mm=400"}) {
      const std::string reply = cabinet.ask(line);
      EXPECT_TRUE(reply.starts_with("error SINGULAR_PATH ") ||
                  reply.starts_with("error OUT_OF_REACH ") ||
                  reply.starts_with("error JOINT_LIMIT "))
          << reply;
    }
    EXPECT_EQ(cabinet.now().mode, Mode::kHolding);
  }
}

// Two vertices along each axis, where the nominal model reaches them.
Configuration with_grid(const ShortArm& arm) {
  Configuration configuration = configured(arm);
  configuration.dwell.settle = std::chrono::milliseconds(4);
  const evaluation::ToolModel drawing{kinematics::make_chain(arm.arm.joints, arm.arm.limits),
                                      arm.p_nT};
  const auto placed =
      evaluation::place_grid(drawing, {.size_m = {0.04, 0.04, 0.04}, .count = {2, 2, 2}});
  EXPECT_TRUE(placed) << arm.arm.name;
  configuration.grid.grid = placed->grid;
  configuration.grid.taught = placed->taught;
  return configuration;
}

TEST(ShortArms, touch_a_grid_and_tell_by_how_much_they_turn_the_tool) {
  for (const ShortArm& arm : test::short_arms()) {
    std::mt19937_64 random(4);
    const KnownArm built = test::individual(arm.arm, random);
    const Configuration configuration = with_grid(arm);
    const auto& taught = configuration.grid.taught;
    ShortCabinet cabinet(arm, built, configuration);
    cabinet.hold();
    const Pose origin = cabinet.tool(taught[0]);
    const Pose X_0W =
        evaluation::taught_frame(origin.p, cabinet.tool(taught[1]).p, cabinet.tool(taught[2]).p);
    ASSERT_EQ(cabinet.ask("touch-grid"), "ok") << arm.arm.name;
    std::size_t touched = 0;
    double most_deg = 0;
    std::string last;
    std::size_t heard = cabinet.console.told.size();
    for (int i = 0; i < 60'000 && !last.starts_with("# touch-grid "); ++i) {
      cabinet.step();
      for (; heard < cabinet.console.told.size(); ++heard) {
        last = cabinet.console.told[heard];
        if (!last.starts_with("# touched ")) continue;
        const Vector3 vertex =
            configuration.grid.grid.vertex(touched % 2, touched / 2 % 2, touched / 4);
        const Pose at = cabinet.tool(cabinet.now().commanded);
        EXPECT_LT((at.p - X_0W * vertex).norm(), 1e-8) << arm.arm.name;
        const double turned_deg = degrees(angle_between(at.R, origin.R));
        EXPECT_NEAR(turned_deg, missed_deg(last), 1e-4) << arm.arm.name;
        most_deg = std::max(most_deg, missed_deg(last));
        ++touched;
      }
    }
    EXPECT_EQ(touched, 8U) << arm.arm.name;
    EXPECT_TRUE(last.starts_with("# touch-grid done touched=8 ")) << last;
    EXPECT_EQ(missed_deg(last), most_deg) << arm.arm.name;
  }
}

}  // namespace
}  // namespace armsig::controller
