// SPDX-License-Identifier: MIT
// Joints that may stand elsewhere than they read: found so, told, kept from tool moves and
// sequences, confirmed; and histories of everything that can happen to a reference.
#include <array>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/record_store.hpp"
#include "firmware/controller/signature_store.hpp"
#include "host_tests/support/lying_drives.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kPumaJoints = 6;

// A signature of 0.1 mm of the Puma, as an identification without an error would have found it.
void store_signature(const Configuration& configuration, hal::NonvolatileMemory& memory,
                     const hal::JointDrives& drives) {
  SignatureRecord record;
  record.machine = *machine_of(configuration.drawing, drives);
  record.accuracy.predicted = {.rms_m = 1e-4};
  const KnownTarget target{1, kPumaJoints, {0.15, 0, 0.05}};
  record.signature =
      signature_of(configuration.drawing, configuration.sweeps.configuration, Pose(), {&target, 1});
  SignatureStore store(memory);
  SignatureRecord found;
  (void)store.load(configuration.drawing, found);
  store.begin_write(record);
  while (!store.step().value_or(true)) {
  }
}

struct Plant : test::LyingPlant {
  using LyingPlant::LyingPlant;
  void store_and_power_up() {
    store_signature(configuration, memory, drives);
    power_up();
  }
  [[nodiscard]] unsigned unreferenced() const { return controller->state().unreferenced(); }
};

TEST(References, of_an_arm_where_it_was_left_are_certain) {
  Plant plant;
  plant.store_and_power_up();
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 0U);
  EXPECT_FALSE(plant.told("# unreferenced"));
  EXPECT_EQ(plant.ask("status").find("unreferenced"), std::string::npos);
}

TEST(References, a_lost_count_is_told_and_keeps_the_arm_from_all_that_trusts_it) {
  Plant plant;
  plant.store_and_power_up();
  plant.drives.lost[0] = radians(40);
  plant.power_up();
  EXPECT_TRUE(plant.told(
      "# unreferenced joint=1 why=moved by_deg=-40.000 error=UNREFERENCED reason=\"a joint may "
      "stand elsewhere than it reads\" look at the joint, then confirm q1_deg=..."));
  EXPECT_NE(plant.ask("status").find(" unreferenced=1 "), std::string::npos);
  ASSERT_EQ(plant.ask("enable"), "ok");
  plant.run(3);
  for (const char* request :
       {"move dx_mm=1", "identify", "check", "compare", "touch-grid", "accept"}) {
    EXPECT_EQ(plant.ask(request),
              "error UNREFERENCED a joint may stand elsewhere than it reads joints=1")
        << request;
  }
}

TEST(References, an_unreferenced_arm_goes_slowly_and_a_little_at_a_time) {
  Plant plant;
  plant.store_and_power_up();
  plant.drives.lost[0] = radians(40);
  plant.power_up();
  ASSERT_EQ(plant.ask("enable"), "ok");
  plant.run(3);
  const double at_deg = degrees(plant.drives.readings[0]);
  const auto move = [&](double by_deg, const std::string& pace) {
    return plant.ask("move q1_deg=" + std::to_string(at_deg + by_deg) + pace);
  };
  const std::string refusal =
      "error UNREFERENCED a joint may stand elsewhere than it reads joints=1 at_most_deg=10 "
      "at_most_mm=50 pace=0.1";
  EXPECT_EQ(move(10.1, " pace=0.1"), refusal);
  EXPECT_EQ(move(1, ""), refusal);
  EXPECT_EQ(move(9.9, " pace=0.1"), "ok");
}

TEST(References, a_person_confirms_what_is_seen_and_nothing_else) {
  Plant plant;
  plant.store_and_power_up();
  plant.drives.lost[0] = radians(40);
  plant.drives.lost[2] = radians(-3);
  plant.power_up();
  const std::string start_deg = std::to_string(degrees(plant.drives.joints[0]));
  EXPECT_EQ(plant.ask("confirm q1_deg=" + start_deg),
            "error UNREFERENCED a joint may stand elsewhere than it reads joint=1");
  EXPECT_EQ(plant.ask("confirm"),
            "error UNKNOWN_REQUEST the request or one of its keys is unknown");
  EXPECT_EQ(plant.unreferenced(), 5U);
  EXPECT_EQ(plant.ask("confirm q1_deg=" + std::to_string(degrees(plant.drives.readings[0]) + 0.9)),
            "ok unreferenced=3");
  EXPECT_EQ(plant.ask("confirm q3_deg=" + std::to_string(degrees(plant.drives.readings[2]))), "ok");
  plant.run(600);
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 0U) << "what was confirmed is kept";
}

TEST(References, what_nobody_has_confirmed_stays_so_over_a_restart) {
  Plant plant;
  plant.store_and_power_up();
  plant.drives.lost[1] = radians(1);
  plant.power_up();
  ASSERT_EQ(plant.unreferenced(), 2U);
  plant.run(600);
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 2U);
  EXPECT_TRUE(plant.told("# unreferenced joint=2 why=not_confirmed"));
}

// 0.3 mm at the tool: Puma's reach of 1.5 m and a hand of 0.25 m make it 0.011 deg of joint 1.
TEST(References, differ_by_what_the_signature_is_accurate_to) {
  for (const auto& [by_deg, found] : {std::pair{0.005, 0U}, {0.05, 1U}, {0.45, 1U}}) {
    Plant plant;
    plant.store_and_power_up();
    plant.drives.lost[0] = radians(by_deg);
    plant.power_up();
    EXPECT_EQ(plant.unreferenced(), found) << by_deg;
  }
}

TEST(References, of_another_amplifier_are_to_be_confirmed_and_the_signature_stays) {
  Plant plant;
  plant.store_and_power_up();
  plant.drives.identities[3].device[hal::kSerial] = 4711;
  plant.power_up();
  EXPECT_TRUE(plant.told("# unreferenced joint=4 why=other_drive"));
  EXPECT_NE(plant.ask("status").find(" model=signature"), std::string::npos);
  EXPECT_EQ(plant.ask("confirm q4_deg=" + std::to_string(degrees(plant.drives.readings[3]))), "ok");
  plant.run(600);
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 0U);
}

TEST(References, of_a_counter_are_uncertain_after_every_set_up) {
  Configuration configuration = test::puma_controller();
  configuration.references = FixedVector<Reference, kMaxJoints>(kPumaJoints, Reference::kAbsolute);
  configuration.references[5] = Reference::kNone;
  Plant plant(configuration);
  EXPECT_TRUE(plant.told("# unreferenced joint=6 why=counts_from_power_up"));
  EXPECT_EQ(plant.ask("confirm q6_deg=" + std::to_string(degrees(plant.drives.readings[5]))), "ok");
  EXPECT_EQ(plant.unreferenced(), 0U);
  plant.run(600);
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 1U << 5);
}

TEST(References, a_reading_that_jumps_while_the_arm_is_watched_is_told) {
  Plant plant;
  plant.store_and_power_up();
  plant.run(600);
  plant.drives.lost[4] = radians(30);
  plant.run(3);
  EXPECT_TRUE(plant.told("# unreferenced joint=5 why=jumped by_deg=-30.0"));
}

// A drive that is silent for a while moves on: what it tells then is no jump.
TEST(References, a_reading_may_be_as_late_as_its_drive_may_be_silent) {
  Configuration patient = test::puma_controller();
  patient.feedback_age = std::chrono::milliseconds(100);
  const auto unreferenced_by = [](const Configuration& configuration, double moved_rad) {
    Plant plant(configuration);
    plant.store_and_power_up();
    plant.run(600);
    plant.drives.joints[2] += moved_rad;
    plant.run(3);
    return plant.unreferenced();
  };
  EXPECT_EQ(unreferenced_by(test::puma_controller(), 0.9), 1U << 2U);
  EXPECT_EQ(unreferenced_by(patient, 0.9), 0U);
  EXPECT_EQ(unreferenced_by(patient, 1.1), 1U << 2U);
}

TEST(References, an_arm_that_is_pushed_while_it_is_watched_stays_certain) {
  Plant plant;
  plant.store_and_power_up();
  for (int i = 0; i < 500; ++i) {
    plant.drives.joints[0] += radians(0.02);
    plant.step();
  }
  EXPECT_EQ(plant.unreferenced(), 0U);
  plant.run(600);  // it stands still, and is kept
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), 0U);
}

TEST(References, are_uncertain_where_a_signature_is_in_use_and_nothing_was_kept) {
  Plant plant;
  plant.store_and_power_up();
  ASSERT_TRUE(plant.memory.erase_sector(RecordStore(plant.memory).sectors()));
  plant.power_up();
  EXPECT_EQ(plant.unreferenced(), (1U << kPumaJoints) - 1);
}

// Whatever happens to power, encoders, drives, joints and memory: no move of the tool is taken with
// a joint that is elsewhere than it reads by more than a person sees or the model is accurate to.
class History {
 public:
  explicit History(unsigned long seed) : random_(seed), plant_(bent()) {
    for (const std::size_t joint : kHomed) plant_.drives.counts_anew[joint] = true;
    plant_.store_and_power_up();
  }

  void take(int events) {
    for (int i = 0; i < events && !testing::Test::HasFailure(); ++i) {
      happen();
      if (draw(2) == 0) look();
      try_to_move();
    }
  }
  [[nodiscard]] int moves() const { return moves_; }
  [[nodiscard]] int refusals() const { return refusals_; }
  [[nodiscard]] int homings() const { return homings_; }

 private:
  static constexpr std::array<std::size_t, 2> kHomed{1, 5};
  static constexpr double kTyped_rad = radians(1e-6);  // of six decimals

  // Where lines of the tool are free.
  static Configuration bent() {
    Configuration configuration = test::puma_controller();
    configuration.sweeps.configuration[2] = radians(10);
    configuration.sweeps.configuration[4] = radians(40);
    configuration.references =
        FixedVector<Reference, kMaxJoints>(kPumaJoints, Reference::kAbsolute);
    for (const std::size_t joint : kHomed) configuration.references[joint] = Reference::kHomed;
    return configuration;
  }
  unsigned draw(unsigned count) { return static_cast<unsigned>(random_() % count); }
  double sign() { return draw(2) == 0 ? 1 : -1; }
  // Joints move by multiples of half a degree, and encoders lose a quarter more: no loss is by
  // chance what a joint has moved since its place was kept, which nobody could tell.
  double push() { return sign() * radians(0.5 + 0.5 * draw(60)); }
  double loss() { return sign() * radians(1.25 + 0.5 * draw(100)); }

  void happen() {
    const std::size_t joint = draw(kPumaJoints);
    switch (draw(9)) {
      case 0:  // switched off and on
        plant_.power_up();
        break;
      case 1:  // an encoder whose battery is empty
        plant_.drives.lost[joint] = loss();
        plant_.power_up();
        break;
      case 2:  // pushed in the dark
        plant_.drives.joints[joint] += push();
        plant_.power_up();
        break;
      case 3:  // another amplifier, whose own zero is elsewhere or not
        plant_.drives.identities[joint].device[hal::kSerial] = 2000 + draw(100'000);
        if (draw(2) == 0) plant_.drives.lost[joint] = loss();
        plant_.power_up();
        break;
      case 4:  // the power goes within a write
        plant_.memory.bytes_left = draw(600);
        (void)plant_.ask("disable");
        plant_.run(static_cast<int>(draw(700)));
        plant_.memory.bytes_left.reset();
        plant_.power_up();
        break;
      case 5:
        plant_.drives.lost[joint] = 0;
        plant_.power_up();
        break;
      case 6:
        (void)plant_.ask("disable");
        plant_.run(static_cast<int>(draw(700)));
        break;
      case 7:  // a search that comes to its end, or to another
        if (!home(kHomed[draw(2)])) break;
        plant_.run(static_cast<int>(draw(100)));
        if (draw(3) == 0) plant_.power_up();
        if (draw(3) == 0) (void)plant_.ask(draw(2) == 0 ? "halt" : "disable");
        break;
      default:
        (void)plant_.rest_after(
            "move q" + std::to_string(joint + 1) +
            "_deg=" + std::to_string(degrees(plant_.drives.readings[joint]) + 0.5 * draw(20) - 5) +
            " pace=0.1");
    }
  }

  // A person goes by every joint and types the mark at which it stands; where that is refused, the
  // joint is homed by the tool of the drive's maker, or left.
  void look() {
    for (std::size_t i = 0; i < kPumaJoints; ++i) {
      if ((plant_.unreferenced() >> i & 1U) == 0) continue;
      if (confirm(i) || draw(2) == 0) continue;
      if (plant_.drives.counts_anew[i]) {
        if (home(i)) plant_.run(400);
        continue;
      }
      plant_.drives.lost[i] = 0;
      plant_.power_up();
      (void)confirm(i);
    }
  }
  bool home(std::size_t joint) {
    if (plant_.ask("enable") == "ok") plant_.run(3);
    const bool taken = plant_.ask("home joint=" + std::to_string(joint + 1)) == "ok";
    if (taken) ++homings_;
    return taken;
  }
  bool confirm(std::size_t joint) {
    return plant_
        .ask("confirm q" + std::to_string(joint + 1) +
             "_deg=" + std::to_string(degrees(plant_.drives.joints[joint])))
        .starts_with("ok");
  }

  void try_to_move() {
    if (plant_.ask("enable") == "ok") plant_.run(3);
    const std::string reply = plant_.ask("move dz_mm=0.01");
    if (reply.starts_with("error UNREFERENCED")) ++refusals_;
    if (reply != "ok") return;
    ++moves_;
    plant_.run(200);
    for (std::size_t i = 0; i < kPumaJoints; ++i) {
      EXPECT_LE(std::abs(plant_.drives.lost[i]), References::kSeen_rad + kTyped_rad)
          << "joint " << i + 1 << ": " << reply;
    }
  }

  std::mt19937_64 random_;
  Plant plant_;
  int moves_ = 0;
  int refusals_ = 0;
  int homings_ = 0;
};

// ARMSIG_HISTORIES makes it more of them (docs/trust.md).
TEST(References, no_history_moves_the_tool_with_a_joint_elsewhere) {
  const char* told = std::getenv("ARMSIG_HISTORIES");
  const unsigned long histories = told == nullptr ? 200 : std::strtoul(told, nullptr, 10);
  int moves = 0;
  int refusals = 0;
  int homings = 0;
  for (unsigned long seed = 1; seed <= histories && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    History history(seed);
    history.take(50);
    moves += history.moves();
    refusals += history.refusals();
    homings += history.homings();
  }
  EXPECT_GT(moves, 500);
  EXPECT_GT(refusals, 500);
  EXPECT_GT(homings, 500);
}

}  // namespace
}  // namespace armsig::controller
