// SPDX-License-Identifier: MIT
// What the console says and does, word for word: status, lines with an orientation, disable, and
// the grid's ends.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using cia402::State;
using test::PumaCabinet;

// The word behind ` key=` of a line; empty if there is none.
std::string word(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(" " + key + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size() + 2;
  return line.substr(begin, line.find(' ', begin) - begin);
}

// With the wrist bent, so that the tool can move along lines.
struct Bent : PumaCabinet {
  explicit Bent(const Configuration& configuration = test::puma_controller())
      : PumaCabinet(1, configuration) {
    EXPECT_TRUE(bend_wrist());
    run(0.5);
  }
  void expect_refused(const std::string& request, const std::string& error) {
    EXPECT_TRUE(ask(request).starts_with("error " + error + " "))
        << request << ": " << console.replies.back();
    EXPECT_EQ(mode(), Mode::kHolding) << request;
  }
  bool told(const std::string& beginning) const {
    for (const std::string& line : console.told) {
      if (line.starts_with(beginning)) return true;
    }
    return false;
  }
};

TEST(StatusLine, tells_readings_in_degrees_and_the_tool_in_millimetres) {
  Bent puma;
  const std::string line = puma.ask("status");
  const Snapshot& now = puma.now();
  EXPECT_TRUE(line.starts_with("ok mode=holding moving=no q1_deg=")) << line;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::stod(word(line, "q" + std::to_string(i + 1) + "_deg")),
                degrees(now.positions[i]), 1e-3);
  }
  const Vector3 p = tool_pose(model_of(test::puma_controller().drawing), now.positions)->p;
  EXPECT_NEAR(std::stod(word(line, "x_mm")), 1e3 * p.x(), 0.02);
  EXPECT_NEAR(std::stod(word(line, "y_mm")), 1e3 * p.y(), 0.02);
  EXPECT_NEAR(std::stod(word(line, "z_mm")), 1e3 * p.z(), 0.02);
  EXPECT_EQ(word(line, "model"), "nominal");
  EXPECT_EQ(word(line, "sensor"), "well");
  EXPECT_EQ(word(line, "sequence"), "none");
  EXPECT_EQ(word(line, "late_bins"), word(line, "ticks") + ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0");
  EXPECT_EQ(line.find("fault"), std::string::npos);
  EXPECT_EQ(line.find("limits_active"), std::string::npos);
  EXPECT_EQ(line.find("store="), std::string::npos);
}

TEST(StatusLine, tells_how_far_an_identification_is_and_the_fault_that_ended_it) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  std::string line = puma.ask("status");
  EXPECT_EQ(word(line, "sequence"), "identifying");
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  EXPECT_EQ(word(line, "points"), std::to_string(sequence.points_done()));
  EXPECT_EQ(word(line, "planned"), std::to_string(sequence.points_planned()));
  EXPECT_GT(std::stod(word(line, "left_s")), 60);
  EXPECT_EQ(puma.ask("pause"), "ok");
  EXPECT_EQ(word(puma.ask("status"), "sequence"), "paused");
  EXPECT_EQ(puma.ask("resume"), "ok");
  EXPECT_EQ(word(puma.ask("status"), "sequence"), "identifying");
  const std::string log = puma.ask("log");
  const std::string rows = word(log, "rows");
  EXPECT_EQ(puma.ask("log row=0").substr(0, 18), "error OUT_OF_RANGE");
  EXPECT_EQ(puma.ask("log row=" + std::to_string(std::stoi(rows) + 9)).substr(0, 18),
            "error OUT_OF_RANGE");
  EXPECT_EQ(puma.ask("log line=1").substr(0, 21), "error UNKNOWN_REQUEST");
  puma.cabinet->drive(3).inject(simulated::DriveFault::kEmergency, 0x2310);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  puma.run(0.1);
  line = puma.ask("status");
  EXPECT_TRUE(
      line.starts_with("ok mode=faulted fault=DRIVE_EMERGENCY fault_joint=4 "
                       "fault_code=0x2310 fault_says=\""))
      << line;
  EXPECT_EQ(word(line, "sequence"), "none");
}

// What is shown is what was measured and computed: a factor of two or a unit would be seen here.
TEST(ShownFigures, are_those_of_the_log_the_report_and_the_record) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE "));
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  EXPECT_EQ(word(puma.ask("status"), "axis_sigma_deg"), "");
  for (int i = 0; i < 300 && !sequence.axis_sigma_rad(); ++i) puma.run(1);
  const std::string sigma_deg = word(puma.ask("status"), "axis_sigma_deg");
  ASSERT_NE(sigma_deg, "");
  EXPECT_NEAR(std::stod(sigma_deg), degrees(*sequence.axis_sigma_rad()), 1e-5);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  const LogEntry& row = sequence.log()[41];
  const std::string logged = puma.ask("log row=42");
  EXPECT_EQ(word(logged, "sweep"), std::to_string(row.sweep()));
  EXPECT_EQ(word(logged, "pings"), std::to_string(row.pings()));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::stod(word(logged, "q" + std::to_string(i + 1) + "_deg")),
                degrees(row.readings()[i]), 1e-5);
  }
  const char* axes[] = {"x_mm", "y_mm", "z_mm"};
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::stod(word(logged, axes[axis])), 1e3 * row.p_S()(axis), 1e-4);
  }
  EXPECT_NEAR(std::stod(word(logged, "sigma_mm")), 1e3 * row.sigma_m(), 1e-4);
  EXPECT_GT(row.sigma_m(), 1e-6);
  const HeldOutReport report = sequence.report();
  const std::string candidate = puma.ask("candidate");
  EXPECT_EQ(word(candidate, "validation_poses"), std::to_string(report.poses));
  EXPECT_NEAR(std::stod(word(candidate, "validation_rms_mm")), 1e3 * report.candidate_rms_m, 1e-4);
  EXPECT_NEAR(std::stod(word(candidate, "active_rms_mm")), 1e3 * report.active_rms_m, 1e-4);
  EXPECT_EQ(word(candidate, "active"), "nominal");
  const std::string figures = candidate.substr(3);
  EXPECT_EQ(std::ranges::count(puma.console.told, "# candidate " + figures), 1) << figures;
  EXPECT_EQ(word(candidate, "better"), "yes");
  ASSERT_EQ(puma.ask("accept"), "ok");
  const SignatureRecord& record = *puma.cabinet->state().active();
  EXPECT_EQ(validation_rms_m(record), report.candidate_rms_m);
  const std::string shown = puma.ask("signature");
  EXPECT_NEAR(std::stod(word(shown, "validation_rms_mm")), 1e3 * validation_rms_m(record), 1e-4);
  EXPECT_NEAR(std::stod(word(shown, "predicted_tool_error_mm")),
              1e3 * record.accuracy.predicted->rms_m, 1e-4);
  EXPECT_EQ(word(shown, "predicted_region"), "configuration");
  EXPECT_NEAR(std::stod(word(shown, "air_c")), record.air_celsius, 0.05);
  for (std::size_t i = 0; i < 6; ++i) {
    const DhJoint& dh = record.signature.pseudo_dh[i];
    const std::string joint = std::to_string(i + 1);
    EXPECT_NEAR(std::stod(word(shown, "theta" + joint + "_deg")), degrees(dh.theta_rad), 1e-6);
    EXPECT_NEAR(std::stod(word(shown, "d" + joint + "_mm")), 1e3 * dh.d_m, 1e-4);
    EXPECT_NEAR(std::stod(word(shown, "a" + joint + "_mm")), 1e3 * dh.a_m, 1e-4);
    EXPECT_NEAR(std::stod(word(shown, "alpha" + joint + "_deg")), degrees(dh.alpha_rad), 1e-6);
  }
}

TEST(Disable, takes_the_torque_off_and_is_answered) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.cabinet->drive(5).state(), State::kOperationEnabled);
  EXPECT_EQ(puma.ask("disable"), "ok");
  EXPECT_TRUE(puma.run_until(Mode::kIdle, 1));
  puma.run(2);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NE(puma.cabinet->drive(i).state(), State::kOperationEnabled) << i;
  }
  EXPECT_TRUE(puma.enable()) << "again";
}

// 10 degrees about the base's z axis, to where the tool is.
TEST(Quaternion, turns_the_tool_in_its_place) {
  Bent puma;
  const Pose from = *puma.now().X_RT;
  const Matrix3 wanted = rotation_about(Vector3::UnitZ(), radians(10)) * from.R;
  const Eigen::Quaterniond q(wanted);
  const auto part = [](const char* key, double value) {
    return std::string(" ") + key + "=" + std::to_string(value);
  };
  ASSERT_EQ(puma.ask("move dx_mm=0" + part("qw", q.w()) + part("qx", q.x()) + part("qy", q.y()) +
                     part("qz", q.z())),
            "ok")
      << puma.console.replies.back();
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.5));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  puma.run(0.5);
  EXPECT_LT(angle_between(puma.now().X_RT->R, wanted), 2e-4);
  EXPECT_GT(angle_between(puma.now().X_RT->R, from.R), radians(9.9));
  EXPECT_LT((puma.now().X_RT->p - from.p).norm(), 2e-4);
}

TEST(Quaternion, is_refused_in_part_of_another_length_and_beside_joints) {
  Bent puma;
  puma.expect_refused("move qw=1 qx=0 qy=0", "OUT_OF_RANGE");
  puma.expect_refused("move qw=1.0011 qx=0 qy=0 qz=0", "OUT_OF_RANGE");
  puma.expect_refused("move qw=0.9989 qx=0 qy=0 qz=0", "OUT_OF_RANGE");
  puma.expect_refused("move qw=0 qx=0 qy=0 qz=0", "OUT_OF_RANGE");
  puma.expect_refused("move qw=one qx=0 qy=0 qz=0", "UNKNOWN_REQUEST");
  puma.expect_refused("move qw=1 qx=0 qy=0 qv=0", "UNKNOWN_REQUEST");
  puma.expect_refused("move qw_m=1 qx=0 qy=0 qz=0", "UNKNOWN_REQUEST");
  puma.expect_refused("move q1_deg=1 qx=0", "UNKNOWN_REQUEST");
  puma.expect_refused("move x_mm=nothing", "UNKNOWN_REQUEST");
  puma.expect_refused("move x_deg=1", "UNKNOWN_REQUEST");
  puma.expect_refused("move x=1", "UNKNOWN_REQUEST");
}

TEST(Places, of_the_tool_are_millimetres_and_metres_absolute_and_by) {
  Bent puma;
  const Vector3 from = puma.now().X_RT->p;
  ASSERT_EQ(puma.ask("move y_m=" + std::to_string(from.y() + 0.03) + " dz_m=-0.02"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.5));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 30));
  puma.run(0.5);
  EXPECT_LT((puma.now().X_RT->p - from - Vector3(0, 0.03, -0.02)).norm(), 2e-4);
}

// A small grid before the bent arm.
Configuration with_small_grid() {
  Configuration c = test::puma_controller();
  const JointVector at{radians(0), radians(-90), radians(10), radians(30), radians(40), radians(0)};
  c.grid.taught = {at, at, at};
  c.grid.taught[1][0] += 0.1;
  c.grid.taught[2][2] += 0.1;
  c.grid.grid.size_m = {0.02, 0.02, 0.02};
  c.grid.grid.count = {2, 2, 2};
  EXPECT_TRUE(check(c));
  return c;
}

TEST(GridEnds, well_at_its_last_vertex) {
  Bent puma(with_small_grid());
  ASSERT_EQ(puma.ask("touch-grid"), "ok");
  puma.run(1);
  EXPECT_EQ(word(puma.ask("status"), "sequence"), "touching");
  EXPECT_TRUE(puma.ask("touch-grid").starts_with("error WRONG_MODE "));
  for (int i = 0; i < 600 && puma.cabinet->state().grid().is_running(); ++i) puma.run(0.1);
  ASSERT_FALSE(puma.cabinet->state().grid().is_running());
  EXPECT_TRUE(puma.told("# touched vertex=1 of=8"));
  EXPECT_TRUE(puma.told("# touched vertex=8 of=8"));
  EXPECT_FALSE(puma.told("# touched vertex=9"));
  EXPECT_TRUE(puma.told("# touch-grid done touched=8"));
  EXPECT_FALSE(puma.told("# touch-grid ended"));
  puma.run(0.1);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(GridEnds, by_the_operators_halt) {
  Bent puma(with_small_grid());
  ASSERT_EQ(puma.ask("touch-grid"), "ok");
  while (puma.cabinet->state().grid().touched() < 2) puma.cabinet->step();
  ASSERT_EQ(puma.ask("halt"), "ok");
  puma.run(1);
  EXPECT_FALSE(puma.cabinet->state().grid().is_running());
  EXPECT_TRUE(puma.told("# touch-grid ended touched=2 error=SEQUENCE_STOPPED"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(GridEnds, by_the_fault_of_a_drive_with_its_joint) {
  Bent puma(with_small_grid());
  ASSERT_EQ(puma.ask("touch-grid"), "ok");
  puma.run(1);
  puma.cabinet->drive(4).inject(simulated::DriveFault::kEmergency, 0x2310);
  puma.run(1);
  std::string ended;
  for (const std::string& line : puma.console.told) {
    if (line.starts_with("# touch-grid ended")) ended = line;
  }
  EXPECT_EQ(word(ended, "error"), "DRIVE_EMERGENCY") << ended;
  EXPECT_EQ(word(ended, "joint"), "5") << ended;
}

TEST(GridEnds, before_the_arm_moves_where_a_vertex_is_out_of_reach) {
  Configuration configuration = with_small_grid();
  configuration.grid.grid.size_m = {5, 5, 5};
  Bent puma(configuration);
  const JointVector before = puma.now().commanded;
  ASSERT_EQ(puma.ask("touch-grid"), "ok");
  puma.run(2);
  EXPECT_TRUE(puma.told("# touch-grid ended touched=0 error=OUT_OF_REACH"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
}

TEST(GridEnds, where_a_joint_does_not_settle_with_that_joint) {
  Configuration configuration = with_small_grid();
  configuration.dwell.settle_timeout = std::chrono::milliseconds(500);
  Bent puma(configuration);
  ASSERT_EQ(puma.ask("touch-grid"), "ok");
  // Hunts by twelve tolerances about its target.
  for (int i = 0; i < 10'000 && puma.cabinet->state().grid().is_running(); ++i) {
    puma.cabinet->drive(2).push((i % 2 == 0 ? 12e-4 : -12e-4) * test::kPumaCountsPerRadian);
    puma.run(0.002);
  }
  ASSERT_FALSE(puma.cabinet->state().grid().is_running());
  EXPECT_TRUE(puma.told("# touch-grid ended touched=0 error=NOT_SETTLED"));
  EXPECT_EQ(word(puma.console.told.back(), "joint"), "3") << puma.console.told.back();
}

}  // namespace
}  // namespace armsig::controller
