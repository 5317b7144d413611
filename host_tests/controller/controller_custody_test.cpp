// SPDX-License-Identifier: MIT
// Which signature is in use: that of this machine, or the drawing once an operator knows it.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "firmware/controller/machine.hpp"
#include "hal/linux/file_memory.hpp"
#include "host_tests/support/table_3_run.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::controller {
namespace {

using test::identify_and_accept;
using test::PumaCabinet;

Configuration quick() {
  Configuration configuration = test::puma_controller();
  configuration.sweeps.points = configuration.sweeps.most_points = 8;
  configuration.sweeps.validation_poses = 3;
  return configuration;
}

Configuration redrawn() {
  Configuration configuration = quick();
  configuration.drawing.joints[2].a_m += 1e-3;
  return configuration;
}

bool told(const PumaCabinet& puma, std::string_view begin) {
  return std::ranges::any_of(puma.console.told,
                             [&](const std::string& line) { return line.starts_with(begin); });
}

// Where lines of the tool are free.
bool bend(PumaCabinet& puma) {
  const bool begun =
      puma.ask("move q3_deg=10 q5_deg=40") == "ok" && puma.run_until(Mode::kServoing, 0.1);
  const bool bent = begun && puma.run_until(Mode::kHolding);
  puma.run(0.3);
  return bent;
}

TEST(Custody, tool_moves_by_the_drawing_want_an_acknowledgement_where_a_signature_is_stored) {
  PumaCabinet puma;
  std::ranges::fill(puma.memory.bytes, std::uint8_t{'A'});
  puma.start(test::puma_controller(), 1);
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(told(puma, "# signature unused error=RECORD_CORRUPT "));
  EXPECT_NE(puma.ask("status").find(" store=RECORD_CORRUPT acknowledge=needed"), std::string::npos);
  const JointVector before = puma.now().commanded;
  EXPECT_TRUE(puma.ask("move dx_mm=5").starts_with("error DRAWING_UNACKNOWLEDGED "));
  EXPECT_TRUE(puma.ask("touch-grid").starts_with("error DRAWING_UNACKNOWLEDGED "));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
  ASSERT_TRUE(bend(puma)) << "joints do not go by a model";
  EXPECT_EQ(puma.ask("acknowledge"), "ok model=nominal");
  EXPECT_EQ(puma.ask("move dx_mm=5"), "ok");
  EXPECT_TRUE(puma.ask("acknowledge").starts_with("error WRONG_MODE "));
}

TEST(Custody, a_new_controller_goes_by_the_drawing_unasked) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_TRUE(bend(puma));
  EXPECT_EQ(puma.ask("move dx_mm=5"), "ok");
  EXPECT_TRUE(puma.ask("acknowledge").starts_with("error WRONG_MODE "));
}

TEST(Custody, a_signature_of_another_zero_is_not_used_and_the_difference_is_named) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(identify_and_accept(puma));
  EXPECT_EQ(puma.cabinet->state().active()->machine.drives[2].device[hal::kSerial], 1003U);
  EXPECT_GT(puma.cabinet->state().active()->accuracy.predicted->rms_m, 1e-6);
  EXPECT_LT(puma.cabinet->state().active()->accuracy.predicted->rms_m, 1e-3);

  puma.start(redrawn(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  EXPECT_TRUE(
      told(puma,
           "# signature unused error=RECORD_OTHER_MACHINE reason=\"the stored record "
           "is of another gear, encoder zero or nominal model\" what=nominal_model found="));
  EXPECT_FALSE(puma.cabinet->state().active());
  EXPECT_NE(puma.ask("status").find(" model=nominal"), std::string::npos);
  EXPECT_TRUE(puma.ask("rollback").starts_with("ok")) << "it may be given up";
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");
}

TEST(Custody, a_signature_is_used_again_on_its_own_machine) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(identify_and_accept(puma));
  const auto image = encode(*puma.cabinet->state().active());
  puma.start(redrawn(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  EXPECT_FALSE(puma.cabinet->state().active());
  puma.first_serial = 2001;  // an amplifier is not what a signature is of
  puma.start(quick(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  ASSERT_TRUE(puma.cabinet->state().active());
  EXPECT_EQ(encode(*puma.cabinet->state().active()), image);
}

TEST(Custody, a_store_that_was_replaced_is_told_and_nothing_changes) {
  PumaCabinet puma(1, quick());
  ASSERT_TRUE(identify_and_accept(puma));
  puma.memory.refusal = Error::kStorageReplaced;
  EXPECT_TRUE(puma.ask("rollback").starts_with("error STORAGE_REPLACED "));
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=1 "));
}

TEST(Positions, are_kept_when_the_torque_goes_and_compared_at_the_next_start) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.memory.changed, 256U) << "one page, the first time";
  ASSERT_EQ(puma.ask("move q2_deg=-80"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 0.1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  puma.run(0.5);
  EXPECT_EQ(puma.memory.changed, 256U);
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(3);
  EXPECT_EQ(puma.memory.changed, 2 * 256U);
  EXPECT_FALSE(told(puma, "# unreferenced"));
  // The emulated arm begins where it began before: joint 2 at -90 deg.
  puma.start(test::puma_controller(), 1);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.run(0.1);
  EXPECT_TRUE(told(puma, "# unreferenced joint=2 why=moved by_deg=-10.0") ||
              told(puma, "# unreferenced joint=2 why=moved by_deg=-9.9"));
  EXPECT_FALSE(told(puma, "# unreferenced joint=1"));
}

TEST(Positions, are_kept_a_page_each_time_and_the_last_ones_count) {
  test::RamMemory memory;
  PositionKeeper keeper(memory, 6);
  EXPECT_FALSE(keeper.load(2));
  for (int i = 1; i <= 20; ++i) {
    keeper.begin({.positions = {0.1 * i, -0.2 * i}, .drives = {7, 0}});
    while (keeper.is_writing()) keeper.step();
    keeper.begin({.positions = {0.1 * i, -0.2 * i}, .drives = {7, 0}});
    EXPECT_FALSE(keeper.is_writing()) << "they are kept already";
    PositionKeeper later(memory, 6);
    const auto kept = later.load(2);
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->positions[1], -0.2 * i);
    EXPECT_FALSE(later.load(3)) << "of another arm";
  }
  EXPECT_EQ(memory.changed, 20U * 256 + 2 * 2048);
  for (std::size_t i = 0; i < 6 * 2048; ++i) ASSERT_EQ(memory.bytes[i], 0xFF) << i;
  memory.bytes[6 * 2048 + 3 * 256 + 20] ^= 1;  // the 20th
  PositionKeeper later(memory, 6);
  EXPECT_EQ(later.load(2)->positions[0], 0.1 * 19);
}

TEST(Custody, ok_is_never_said_to_a_store_whose_file_was_unlinked) {
  const std::filesystem::path folder = test::temporary("unlinked");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  auto file = linux_hal::FileMemory::open(folder / "store", test::RamMemory::kLayout);
  ASSERT_TRUE(file);
  PumaCabinet puma(1, quick());
  puma.device = &*file;
  puma.start(quick(), 1);
  ASSERT_TRUE(identify_and_accept(puma));
  std::filesystem::remove(folder / "store");
  EXPECT_TRUE(puma.ask("rollback").starts_with("error STORAGE_REPLACED "));
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=1 "));
  puma.cabinet.reset();
  std::filesystem::remove_all(folder);
}

Machine machine() {
  Machine machine{.drives = {}, .drawing_crc = 7};
  for (std::uint32_t i = 0; i < 2; ++i) {
    machine.drives.push_back({.device = {1, 2, 3, 4 + i},
                              .counts_per_revolution = 4000,
                              .gear_ratio = 100,
                              .lead_m = 0,
                              .zero_counts = 0,
                              .reversed = false});
  }
  return machine;
}

TEST(Machine, is_compared_in_everything_that_both_tell) {
  EXPECT_FALSE(difference(machine(), machine()));
  const auto differs = [](auto change, std::string_view what) {
    Machine other = machine();
    change(other);
    const auto found = difference(machine(), other);
    return found && found->what == what;
  };
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].device[hal::kVendor] = 9; }, "drive_vendor"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].device[hal::kProduct] = 9; }, "drive_product"));
  EXPECT_TRUE(
      differs([](Machine& m) { m.drives[1].device[hal::kRevision] = 9; }, "drive_revision"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].device[hal::kSerial] = 9; }, "drive_serial"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].counts_per_revolution = 4096; },
                      "counts_per_revolution"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].gear_ratio = 101; }, "gear_ratio"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].lead_m = 0.01; }, "lead_m"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].zero_counts = 5; }, "zero_counts"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives[1].reversed = true; }, "reversed"));
  EXPECT_TRUE(differs([](Machine& m) { m.drawing_crc = 8; }, "nominal_model"));
  EXPECT_TRUE(differs([](Machine& m) { m.drives.resize(1); }, "joints"));
  EXPECT_FALSE(differs([](Machine& m) { m.drives[1].device[hal::kSerial] = 0; }, "drive_serial"));
}

TEST(Machine, has_another_drawing_where_any_length_angle_or_type_differs) {
  const Arm drawing = tool::puma560();
  const std::uint32_t crc = drawing_crc(drawing);
  Arm other = drawing;
  other.joints[3].d_m += 1e-12;
  EXPECT_NE(drawing_crc(other), crc);
  other = drawing;
  other.joints[5].type = JointType::kPrismatic;
  EXPECT_NE(drawing_crc(other), crc);
  other = drawing;
  other.couplings.push_back({4, 3, 0.1});
  EXPECT_NE(drawing_crc(other), crc);
  other = drawing;
  other.limits[0].upper += 0.1;
  EXPECT_EQ(drawing_crc(other), crc) << "limits say nothing of the geometry";
}

}  // namespace
}  // namespace armsig::controller
