// SPDX-License-Identifier: MIT
// What an identification does with the poses that a refinement asks for.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

// One pose, and the same once more to be compared with the first.
class Twice final : public Refinement {
 public:
  explicit Twice(JointVector pose) { visit_.approach = visit_.pose = std::move(pose); }

  std::vector<KeptPoint> kept;
  std::vector<JointVector> taken;  // where poses were measured

 private:
  std::span<LogEntry> do_further_log() override { return {}; }
  Result<std::size_t> do_begin(const Aim& /*aim*/, const Machine& /*machine*/) override {
    return 0;
  }
  std::optional<KeptPoint> do_recall(std::size_t /*sweep*/,
                                     const JointVector& /*wanted*/) override {
    return std::nullopt;
  }
  Result<void> do_keep(const KeptPoint& point) override {
    kept.push_back(point);
    return {};
  }
  Result<void> do_forget() override { return {}; }
  void do_take(std::size_t sweep, const JointVector& readings,
               const MeasuredPoint& /*point*/) override {
    if (sweep > 0) return;
    taken.push_back(readings);
    visit_.again = true;
  }
  void do_lose() override {}
  void do_refine(const Signature& /*signature*/) override {}
  Next do_step(hal::Instant /*now*/) override {
    return taken.size() < 2 ? Next::kVisits : Next::kDone;
  }
  [[nodiscard]] const Visit& do_visit() const override { return visit_; }
  void do_tell(Line& /*line*/) const override {}
  void do_tell_state(Line& /*line*/) const override {}
  [[nodiscard]] std::size_t do_planned() const override { return 2; }
  Result<void> do_write(SignatureRecord& /*record*/) const override { return {}; }

  Visit visit_;
};

Configuration short_sweeps() {
  Configuration c = test::puma_controller();
  c.sweeps.points = c.sweeps.most_points = 8;
  c.sweeps.validation_poses = 3;
  return c;
}

TEST(Refining, keeps_every_point_but_those_that_are_measured_again) {
  const Configuration c = short_sweeps();
  const JointVector pose = spread_pose(c, 70);
  Twice twice(pose);
  test::PumaCabinet puma(1, c);
  puma.cabinet = std::make_unique<cabinet::VirtualCabinet>(
      c, test::puma_bus(), test::puma_world(), puma.memory, puma.consoles, nullptr, &twice);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify accuracy_mm=1"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  EXPECT_TRUE(sequence.has_verdict());
  ASSERT_EQ(twice.taken.size(), 2U);
  // Of the log, which has all of them, the one that was compared and the held-out ones are not
  // kept.
  ASSERT_EQ(twice.kept.size(), sequence.log().size() - 1 - c.sweeps.validation_poses);
  for (std::size_t i = 0; i < twice.kept.size(); ++i) {
    EXPECT_EQ(twice.kept[i].sweep, sequence.log()[i].sweep());
    EXPECT_TRUE(twice.kept[i].point);
  }
  EXPECT_EQ(twice.kept.back().sweep, 0U);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    EXPECT_EQ(twice.kept.back().wanted[i], pose[i]) << i;
  }
}

}  // namespace
}  // namespace armsig::controller
