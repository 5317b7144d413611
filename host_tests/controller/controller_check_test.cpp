// SPDX-License-Identifier: MIT
// The check of the whole controller on an arm that stays, changes, or is looked at from elsewhere.
#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/check_image.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

constexpr double kLongest_s = 300;

bool heard(const PumaCabinet& puma, std::string_view words, std::size_t from = 0) {
  return std::ranges::any_of(puma.console.told.begin() + static_cast<std::ptrdiff_t>(from),
                             puma.console.told.end(),
                             [&](const std::string& line) { return line.contains(words); });
}

// Powered up with the signature that an identification has left in its store, and with torque.
struct Accepted : PumaCabinet {
  explicit Accepted(const Configuration& configuration = test::puma_controller())
      : PumaCabinet(1, configuration) {
    static const std::vector<std::uint8_t> stored = [] {
      PumaCabinet first;
      EXPECT_TRUE(test::identify_and_accept(first));
      return first.memory.bytes;
    }();
    memory.bytes = stored;
    start(configuration, 2);
    EXPECT_TRUE(enable());
  }
};

// Runs until a check has ended: its line for machines; empty if none came.
std::string verdict_of(PumaCabinet& puma) {
  const std::size_t before = puma.console.told.size();
  for (double s = 0; s < kLongest_s; s += 0.1) {
    puma.run(0.1);
    for (std::size_t i = before; i < puma.console.told.size(); ++i) {
      if (puma.console.told[i].starts_with("# check verdict=")) return puma.console.told[i];
    }
  }
  return "";
}

std::string checked(PumaCabinet& puma) {
  const std::string reply = puma.ask("check");
  return reply == "ok" ? verdict_of(puma) : reply;
}

TEST(Check, sound_arm_is_as_accepted_and_stands_where_it_stood) {
  Accepted puma;
  ASSERT_EQ(puma.ask("move q1_deg=20"), "ok");
  puma.run(3);
  const JointVector before = puma.now().commanded;
  for (int i = 1; i <= 3; ++i) {
    const std::string line = checked(puma);
    EXPECT_TRUE(line.starts_with("# check verdict=\"as accepted\" signature=1 dx_mm=")) << line;
    EXPECT_TRUE(line.contains(" poses=16 ")) << line;
    EXPECT_TRUE(line.contains(" learnt=" + std::to_string(i) + " of=20")) << line;
  }
  EXPECT_TRUE(heard(puma, "# check residuals r1_mm="));
  EXPECT_TRUE(heard(puma, "# the arm is as it was accepted"));
  EXPECT_TRUE(puma.ask("status").contains(" check=\"as accepted\""));
  puma.run(0.1);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(puma.now().commanded[i], before[i], 1e-12);
}

TEST(Check, link_that_grew_by_two_millimetres_is_named_at_once) {
  Accepted puma;
  puma.cabinet->arm().arm.joints[1].a_m += 2e-3;
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"stepped\""));
  EXPECT_TRUE(heard(puma, "# the arm changed at once"));
  puma.cabinet->arm().arm.joints[1].a_m -= 2e-3;
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"as accepted\""));
  puma.cabinet->arm().arm.joints[2].theta_rad += radians(0.15);  // a gear that slipped
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"stepped\""));
}

TEST(Check, sensor_that_was_pushed_is_told_apart_from_the_arm) {
  Accepted puma;
  ASSERT_TRUE(checked(puma).contains("as accepted"));
  Pose& X_S0 = puma.cabinet->arm().X_S0;
  X_S0 = Pose{rotation_z(radians(0.1)), Vector3(2e-3, -1e-3, 1e-3)} * X_S0;
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"the reference moved\""));
  EXPECT_TRUE(heard(puma, "# the sensor moved"));
}

// What stands after `key` in millimetres, a number or several between commas.
std::vector<double> millimetres(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(" " + key + "=");
  if (at == std::string::npos) return {};
  std::istringstream words(line.substr(at + key.size() + 2));
  std::vector<double> found;
  for (double value = 0; words >> value;) {
    found.push_back(value);
    if (words.get() != ',') break;
  }
  return found;
}

// The noise of a point is 0.1 mm; what is told of it has three digits, of the whole check four.
TEST(Check, tells_what_it_found_in_millimetres) {
  Accepted puma;
  puma.cabinet->arm().X_S0.p += Vector3(2e-3, -3e-3, 4e-3);
  const std::string line = checked(puma);
  const auto told = std::ranges::find_if(puma.console.told, [](const std::string& said) {
    return said.starts_with("# check residuals");
  });
  ASSERT_NE(told, puma.console.told.end());
  EXPECT_TRUE(std::regex_search(*told, std::regex(" r1_mm=(-?\\d+\\.\\d{3},?){3} "))) << *told;
  Vector3 sum = Vector3::Zero();
  double squares = 0;
  int poses = 0;
  for (int place = 1; place <= 99; ++place) {
    const auto residual = millimetres(*told, "r" + std::to_string(place) + "_mm");
    if (residual.empty()) continue;
    ASSERT_EQ(residual.size(), 3U) << *told;
    const Vector3 r(residual[0], residual[1], residual[2]);
    sum += r;
    squares += r.squaredNorm();
    ++poses;
  }
  ASSERT_EQ(poses, 16) << *told;
  EXPECT_LT((sum / poses - Vector3(2, -3, 4)).norm(), 0.5) << *told;
  const char* axes[] = {"dx_mm", "dy_mm", "dz_mm"};
  for (int axis = 0; axis < 3; ++axis) {
    ASSERT_EQ(millimetres(line, axes[axis]).size(), 1U) << line;
    EXPECT_NEAR(millimetres(line, axes[axis])[0], sum[axis] / poses, 1e-3) << line;
  }
  ASSERT_EQ(millimetres(line, "rms_mm").size(), 1U) << line;
  EXPECT_NEAR(millimetres(line, "rms_mm")[0], std::sqrt(squares / poses), 2e-3) << line;
}

// Powered up again behind amplifiers with other serial numbers.
void exchange_drives(Accepted& puma) {
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(3);
  puma.first_serial = 2001;
  puma.start(test::puma_controller(), 2);
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(heard(puma, "why=other_drive"));
  EXPECT_TRUE(heard(puma, " check, or look at the joint, then confirm q1_deg="));
  EXPECT_TRUE(puma.ask("identify").starts_with("error UNREFERENCED "));
}

TEST(Check, of_a_sound_arm_references_joints_whose_drives_were_exchanged) {
  Accepted puma;
  exchange_drives(puma);
  EXPECT_EQ(puma.cabinet->state().unreferenced(), 63U);
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"as accepted\""));
  puma.run(0.1);
  EXPECT_TRUE(heard(puma, "# referenced joints=1,2,3,4,5,6 by=check"));
  EXPECT_EQ(puma.cabinet->state().unreferenced(), 0U);
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(3);
  puma.start(test::puma_controller(), 2);
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.cabinet->state().unreferenced(), 0U) << "it is kept";
}

TEST(Check, of_an_arm_that_changed_leaves_its_joints_unreferenced) {
  Accepted puma;
  exchange_drives(puma);
  puma.cabinet->arm().arm.joints[2].theta_rad += radians(0.15);
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"stepped\""));
  puma.run(0.1);
  EXPECT_EQ(puma.cabinet->state().unreferenced(), 63U);
}

TEST(Check, is_refused_where_a_joint_was_also_found_elsewhere) {
  Accepted puma;
  ASSERT_EQ(puma.ask("move q2_deg=-80"), "ok");
  puma.run(3);
  exchange_drives(puma);  // the emulated arm begins where it began before
  EXPECT_TRUE(heard(puma, "# unreferenced joint=2 why=moved "));
  EXPECT_TRUE(puma.ask("check").starts_with("error UNREFERENCED "));
  puma.start(test::puma_controller(), 2);
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("check").starts_with("error UNREFERENCED ")) << "nor after a restart";
  EXPECT_TRUE(puma.ask("confirm q2_deg=-90").starts_with("ok"));
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"as accepted\""));
  puma.run(0.1);
  EXPECT_EQ(puma.cabinet->state().unreferenced(), 0U);
}

TEST(Check, needs_a_signature_a_sensor_and_torque) {
  PumaCabinet drawn;
  ASSERT_TRUE(drawn.run_until(Mode::kIdle));
  EXPECT_TRUE(drawn.ask("check").starts_with("error WRONG_MODE"));
  ASSERT_TRUE(drawn.enable());
  EXPECT_TRUE(drawn.ask("check").starts_with("error NO_SIGNATURE"));
  EXPECT_EQ(drawn.mode(), Mode::kHolding);
  Accepted puma;
  puma.cabinet->sensor().set_error(Error::kSensorSilent);
  puma.run(1);
  EXPECT_TRUE(puma.ask("check").starts_with("error SENSOR_SILENT"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Check, sensor_that_fails_on_the_way_is_named_and_the_arm_goes_back) {
  Accepted puma;
  const JointVector before = puma.now().commanded;
  ASSERT_EQ(puma.ask("check"), "ok");
  puma.run(10);
  EXPECT_TRUE(puma.ask("status").contains(" sequence=checking "));
  puma.cabinet->sensor().set_error(Error::kSensorStale);
  const std::string line = verdict_of(puma);
  EXPECT_TRUE(line.starts_with("# check verdict=\"could not measure\" error=SENSOR_STALE")) << line;
  EXPECT_FALSE(heard(puma, "# the arm is"));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(puma.now().commanded[i], before[i], 1e-12);
  puma.cabinet->sensor().set_error({});
  puma.run(1);
  EXPECT_TRUE(checked(puma).contains("as accepted"));
}

TEST(Check, halt_and_fault_end_it_with_their_names) {
  Accepted puma;
  ASSERT_EQ(puma.ask("check"), "ok");
  puma.run(5);
  EXPECT_TRUE(puma.ask("check").starts_with("error WRONG_MODE"));
  EXPECT_TRUE(puma.ask("identify").starts_with("error WRONG_MODE"));
  ASSERT_EQ(puma.ask("halt"), "ok");
  puma.run(3);
  EXPECT_TRUE(heard(puma, "# check verdict=\"could not measure\" error=SEQUENCE_STOPPED"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  ASSERT_EQ(puma.ask("check"), "ok");
  puma.run(5);
  ASSERT_EQ(puma.ask("stop"), "ok");
  puma.run(1);
  EXPECT_TRUE(heard(puma, "# check verdict=\"could not measure\" error=QUICK_STOP"));
  EXPECT_EQ(puma.mode(), Mode::kFaulted);
}

Configuration with_schedule() {
  Configuration c = test::puma_controller();
  c.check.every = std::chrono::minutes(2);
  c.check.poses = kFewestCheckPoses;
  return c;
}

TEST(Check, schedule_moves_the_arm_only_with_torque_at_rest_and_after_notice) {
  Accepted puma(with_schedule());
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(200);
  EXPECT_FALSE(heard(puma, "# check"));
  ASSERT_TRUE(puma.enable());
  puma.run(50);
  EXPECT_FALSE(heard(puma, "# check due"));
  puma.run(15);
  EXPECT_TRUE(heard(puma, "# check due begins_in_s=10"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  ASSERT_EQ(puma.ask("halt"), "ok");
  puma.run(110);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  EXPECT_FALSE(heard(puma, "# check verdict"));
  puma.run(100);
  EXPECT_TRUE(heard(puma, "# check verdict=\"as accepted\""));
}

// A place for one image, as a program has it.
struct OneImage final : CheckKeeper {
  std::optional<CheckImage> image;
  std::optional<Error> refusal;

 private:
  Result<Recalled> do_read(const CheckSubject& subject, CheckState& state) override {
    if (!image) return Recalled::kNothing;
    return decode(*image, subject, state);
  }
  Result<void> do_write(const CheckSubject& subject, const CheckState& state) override {
    if (refusal) return std::unexpected(*refusal);
    image = encode(subject, state);
    return {};
  }
};

struct Kept : Accepted {
  Kept() { restart(); }
  void restart(const Configuration& configuration = test::puma_controller()) {
    checks = &place;
    start(configuration, 3);
    console.told.clear();
    EXPECT_TRUE(enable());
  }
  OneImage place;
};

TEST(Check, goes_on_after_a_restart_with_what_it_had_learnt) {
  Kept puma;
  EXPECT_TRUE(checked(puma).contains(" learnt=1 of=20"));
  EXPECT_FALSE(heard(puma, "# check history"));
  EXPECT_TRUE(checked(puma).contains(" learnt=2 of=20"));
  puma.restart();
  EXPECT_TRUE(checked(puma).contains(" learnt=3 of=20"));
  EXPECT_TRUE(heard(puma, "# check history recalled learnt=2 of=20"));
  puma.restart();
  puma.cabinet->arm().arm.joints[1].a_m += 1e-3;  // while nobody looked
  EXPECT_TRUE(checked(puma).starts_with("# check verdict=\"stepped\""));
}

TEST(Check, what_was_kept_of_another_signature_or_other_poses_is_named_and_learnt_anew) {
  Kept puma;
  ASSERT_TRUE(checked(puma).contains(" learnt=1 of=20"));
  Configuration fewer = test::puma_controller();
  fewer.check.poses = 8;
  puma.restart(fewer);
  EXPECT_TRUE(checked(puma).contains(" poses=8 "));
  EXPECT_TRUE(
      heard(puma, "# check history unused of=\"other poses\"; the reference is learnt anew"));
  // Of the same number and date, by a store that was lost.
  std::ranges::fill(puma.memory.bytes, hal::kErasedByte);
  puma.start(fewer, 3);
  ASSERT_TRUE(test::identify_and_accept(puma));
  EXPECT_TRUE(checked(puma).contains(" learnt=1 of=20"));
  EXPECT_TRUE(heard(puma, "# check history unused of=\"another signature\""));
}

TEST(Check, says_when_what_was_kept_is_torn_and_when_nothing_can_be_kept) {
  Kept puma;
  ASSERT_TRUE(checked(puma).contains(" learnt=1 of=20"));
  puma.place.image->at(100) ^= 1;
  puma.restart();
  puma.place.refusal = Error::kStorageFull;
  EXPECT_TRUE(checked(puma).contains(" learnt=1 of=20"));
  EXPECT_TRUE(heard(puma, "# check history unused error=RECORD_CORRUPT reason=\""));
  EXPECT_TRUE(heard(puma, "# check history not kept error=STORAGE_FULL"));
}

TEST(Check, without_a_schedule_nothing_moves_by_itself) {
  Accepted puma;
  puma.run(200);
  EXPECT_FALSE(heard(puma, "# check"));
}

}  // namespace
}  // namespace armsig::controller
