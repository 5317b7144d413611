// SPDX-License-Identifier: MIT
// One drive's node by itself: which faults it is set up anew after, and what it says of them.
#include "hal/canopen/drive_node.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "hal/canopen/identity.hpp"
#include "hal/cia402/standstill.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::canopen {
namespace {

using std::chrono::milliseconds;
using test::frame;

struct Running {
  AxisConfiguration axis = test::puma_axis(1);
  DriveNode node{axis, *cia402::Scaling::make(axis.scaling)};
  hal::Instant now{milliseconds(10)};

  Running() {
    node.enter(Phase::kStarted, now);
    EXPECT_TRUE(node.take_feedback({frame("181#500200000000"), now}));  // switch on disabled
    EXPECT_EQ(node.state().phase, Phase::kRunning);
  }
};

Phase phase_after(Error fault) {
  Running running;
  running.node.drive().latch(fault);
  running.node.reset(running.now);
  running.node.release(running.now);
  return running.node.state().phase;
}

// What a drive has lost by itself it is set up again with; what was only in its way it is not.
TEST(DriveNode, is_set_up_anew_after_faults_of_its_link_alone) {
  for (const Error fault : {Error::kDriveEmergency, Error::kDriveFault, Error::kDriveDroppedOut,
                            Error::kTransitionTimeout, Error::kFeedbackImplausible, Error::kBusBusy,
                            Error::kTargetsIgnored, Error::kDriveLimited, Error::kDriveLags,
                            Error::kDriveWarning, Error::kVoltageLost, Error::kStopTimeout}) {
    EXPECT_EQ(phase_after(fault), Phase::kRunning) << describe(fault);
  }
  for (const Error fault : {Error::kHeartbeatLost, Error::kFeedbackLost, Error::kDriveRebooted,
                            Error::kDriveNotOperational}) {
    EXPECT_EQ(phase_after(fault), Phase::kUnreset) << describe(fault);
  }
}

// 2310h, continuous over-current: the state of fault came before the message that explains it.
TEST(DriveNode, explains_a_fault_by_the_emergency_that_follows) {
  Running running;
  running.node.drive().latch(Error::kDriveFault);
  EXPECT_TRUE(running.node.status().words.empty());
  EXPECT_TRUE(running.node.take_emergency(frame("081#1023010000000000")));
  EXPECT_EQ(running.node.status().fault, Error::kDriveFault);
  EXPECT_EQ(running.node.status().fault_code, 0x2310U);
  EXPECT_FALSE(running.node.status().words.empty());
  EXPECT_TRUE(running.node.take_emergency(frame("081#2032010000000000")));
  EXPECT_EQ(running.node.status().fault_code, 0x2310U) << "the first reason is the reason";
}

TEST(DriveNode, does_not_explain_what_is_no_fault_of_the_drive) {
  Running running;
  running.node.drive().latch(Error::kHeartbeatLost);
  EXPECT_TRUE(running.node.take_emergency(frame("081#1023010000000000")));
  EXPECT_EQ(running.node.status().fault_code, 0U);
}

// Pre-operational may be a heartbeat from before the start; stopped is not.
TEST(DriveNode, that_says_it_is_stopped_is_not_operational) {
  for (const auto& [heartbeat, fault] :
       {std::pair{"701#7F", false}, {"701#04", true}, {"701#05", false}}) {
    Running running;
    EXPECT_TRUE(running.node.take_heartbeat(frame(heartbeat), running.now));
    EXPECT_EQ(running.node.drive().state().fault == Error::kDriveNotOperational, fault)
        << heartbeat;
  }
}

TEST(Identity, is_of_the_numbers_of_its_object_alone) {
  hal::DriveIdentity identity;
  const hal::DriveIdentity before = identity;
  for (const cia402::ObjectRequest& other : {cia402::ObjectRequest{0x1018, 0, 0, 0},
                                             {0x1018, hal::kDeviceNumbers + 1, 0, 0},
                                             {0x1017, 1, 0, 0}}) {
    take_identity(other, 77, identity);
  }
  EXPECT_EQ(identity.device, before.device);
  take_identity({0x1018, 1, 0, 0}, 77, identity);
  EXPECT_EQ(identity.device[0], 77U);
  take_identity({0x1018, 2, 0, 0}, std::unexpected(cia402::ObjectFailure{}), identity);
  EXPECT_EQ(identity.device[1], 0U);
}

TEST(RestTolerance, is_of_a_slide_a_length) {
  const auto scaling = cia402::Scaling::make({.type = JointType::kPrismatic,
                                              .counts_per_revolution = 1e6,
                                              .gear_ratio = 1,
                                              .lead_m = 0.01});
  ASSERT_TRUE(scaling);
  EXPECT_NEAR(cia402::rest_tolerance(JointType::kPrismatic, *scaling), 1e-3 * 0.05 + 2e-8, 1e-9);
  EXPECT_NEAR(cia402::rest_tolerance(JointType::kRevolute, *scaling), 8.7e-3 * 0.05 + 2e-8, 1e-9);
}

}  // namespace
}  // namespace armsig::canopen
