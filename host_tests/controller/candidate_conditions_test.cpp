// SPDX-License-Identifier: MIT
// A candidate is of the machine that it was measured on, and was compared with the model that was
// in use then: where either is another by the time of `accept`, there is no candidate any more.
#include <algorithm>

#include <gtest/gtest.h>

#include "firmware/controller/receiving.hpp"
#include "host_tests/support/sent_signature.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

Configuration quick() {
  Configuration configuration = test::puma_controller();
  configuration.sweeps.points = configuration.sweeps.most_points = 8;
  configuration.sweeps.validation_poses = 3;
  return configuration;
}

bool identify(PumaCabinet& puma) {
  if (puma.ask("identify") != "ok" || !puma.run_until(Mode::kSweeping, 1)) return false;
  return puma.run_until(Mode::kHolding, test::kLongestIdentification_s);
}

bool told(const PumaCabinet& puma, const std::string& line) {
  return std::ranges::find(puma.console.told, line) != puma.console.told.end();
}

// Joint 3 has another drive, whose zero is 10 degrees elsewhere, from its next power-up on.
void exchange_drive_3(PumaCabinet& puma) {
  simulated::Drive& drive = puma.cabinet->drive(2);
  drive.set_object(0x1018, 4, 2003);
  drive.inject(simulated::DriveFault::kReboot);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  drive.inject(simulated::DriveFault::kPositionJump,
               static_cast<std::int32_t>(radians(10) * test::kPumaCountsPerRadian));
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
}

const std::string kDropped =
    "# candidate dropped what=drive_serial joint=3 found=2003.000 expected=1003.000";

// Nor is any in use after a restart.
void expect_no_candidate(PumaCabinet& puma) {
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE "));
  puma.confirm();
  EXPECT_TRUE(puma.ask("accept").starts_with("error NO_CANDIDATE "));
  puma.start(quick(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  EXPECT_FALSE(puma.cabinet->state().active());
}

TEST(Candidate, that_was_measured_with_another_drive_is_dropped_and_the_drive_named) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(puma.enable());
  ASSERT_TRUE(identify(puma));
  ASSERT_TRUE(puma.ask("candidate").contains(" better=yes"));
  exchange_drive_3(puma);
  EXPECT_TRUE(told(puma, kDropped)) << puma.console.told.back();
  EXPECT_TRUE(puma.ask("accept").starts_with("error UNREFERENCED "));
  expect_no_candidate(puma);
}

TEST(Candidate, that_was_sent_and_compared_with_another_drive_is_dropped_as_well) {
  SignatureRecord record;
  {
    PumaCabinet at_the_desk(1, quick());
    ASSERT_TRUE(test::identify_and_accept(at_the_desk));
    record = *at_the_desk.cabinet->state().active();
    record.machine = {.drives = {}, .drawing_crc = told_drawing_crc(tool::puma560())};
  }
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(test::sent(puma, encode(record)), "ok received=candidate");
  ASSERT_EQ(puma.ask("compare"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  ASSERT_TRUE(puma.ask("candidate").contains(" better=yes"));
  exchange_drive_3(puma);
  EXPECT_TRUE(told(puma, kDropped)) << puma.console.told.back();
  expect_no_candidate(puma);
}

TEST(Candidate, of_the_same_drives_outlives_a_fault_and_is_stored_as_theirs) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(puma.enable());
  ASSERT_TRUE(identify(puma));
  ASSERT_EQ(puma.ask("stop"), "ok");
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  ASSERT_EQ(puma.ask("accept"), "ok");
  ASSERT_TRUE(puma.cabinet->state().active());
  EXPECT_EQ(puma.cabinet->state().active()->machine.drives[2].device[hal::kSerial], 1003U);
}

TEST(Candidate, that_was_compared_with_a_model_no_longer_in_use_is_dropped) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(test::identify_and_accept(puma));
  const std::uint32_t number = puma.cabinet->state().active()->sequence;
  ASSERT_TRUE(identify(puma));
  ASSERT_TRUE(puma.ask("candidate").starts_with("ok "));
  ASSERT_EQ(puma.ask("rollback"), "ok");
  EXPECT_TRUE(told(puma, "# candidate dropped what=model found=0.000 expected=" +
                             std::to_string(number) + ".000"))
      << puma.console.told.back();
  expect_no_candidate(puma);
}

}  // namespace
}  // namespace armsig::controller
