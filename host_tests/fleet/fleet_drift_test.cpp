// SPDX-License-Identifier: MIT
// The record's own drift sum over a fleet of simulated arms, on a real PostgreSQL: it names whom
// firmware/drift names, arm by arm. host_tests/fleet/with_record starts the record.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "firmware/fleet/host/database.hpp"
#include "firmware/fleet/host/row_text.hpp"
#include "host_tests/support/simulated_checks.hpp"

namespace armsig::fleet {
namespace {

using drift::test::SimulatedArm;

constexpr int kArms = 1000;
constexpr int kMonth = 30;  // daily checks
constexpr int kTen = 10;

std::string written(double number) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%.17g", number);
  return text.data();
}

// Checks of arms, and which of these core names.
struct Fleet {
  std::array<ArrayText, 5> columns;  // arm, check, z
  std::vector<bool> named;

  void add(SimulatedArm& arm, int checks, const Vector3& drift_m, const drift::Settings& settings) {
    drift::State state;
    for (int n = 1; n <= checks; ++n) {
      const Vector3 e_m = arm.check() + drift_m;
      const Vector3 z = e_m / settings.sigma_m;
      columns[0].add(std::to_string(named.size()));
      columns[1].add(std::to_string(n));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[2 + axis].add(written(z[static_cast<Eigen::Index>(axis)]));
      }
      state = drift::after_check(state, e_m, settings).value_or(state);
    }
    named.push_back(state.named);
  }
};

// The arms that the record names.
std::vector<bool> named_by_record(Database& database, const Fleet& fleet,
                                  const drift::Settings& settings) {
  std::vector<std::string> arguments;
  for (const ArrayText& column : fleet.columns) arguments.push_back(column.text());
  arguments.push_back(written(settings.reference));
  arguments.push_back(written(settings.threshold));
  const auto table = database.ask(
      "SELECT arm FROM (SELECT arm, crosier(x, y, z, $6::float8) OVER (PARTITION BY arm ORDER BY "
      "n) "
      "AS s FROM unnest($1::integer[], $2::integer[], $3::float8[], $4::float8[], $5::float8[]) "
      "AS e(arm, n, x, y, z)) AS sums GROUP BY arm "
      "HAVING bool_or(s[1] ^ 2 + s[2] ^ 2 + s[3] ^ 2 > $7::float8 ^ 2)",
      arguments);
  EXPECT_TRUE(table) << database.problem();
  std::vector<bool> named(fleet.named.size());
  if (!table) return named;
  for (const auto& row : *table) named.at(std::stoul(row[0].value_or("0"))) = true;
  return named;
}

TEST(FleetDrift, RecordNamesWhomCoreNamesAndHardlyAnybodyElse) {
  const char* where = std::getenv("ARMSIG_RECORD");
  ASSERT_NE(where, nullptr) << "run by host_tests/fleet/with_record";
  std::string problem;
  auto database = Database::open(
      where, {.sigma_mm = 0.02, .reference = 2.5, .threshold = 5.6, .baseline = 20}, problem);
  ASSERT_TRUE(database) << problem;
  const drift::Settings settings = drift::test::settings_for(365.25 / 12);
  simulated::Random random(2027);
  Fleet healthy;
  Fleet drifted;
  for (int i = 0; i < kArms; ++i) {
    SimulatedArm sound(random);
    healthy.add(sound, kMonth, Vector3::Zero(), settings);
    SimulatedArm moved(random);
    drifted.add(moved, kTen, 0.1e-3 * random.direction(), settings);
  }
  const std::vector<bool> alarms = named_by_record(*database, healthy, settings);
  const std::vector<bool> found = named_by_record(*database, drifted, settings);
  EXPECT_EQ(alarms, healthy.named);
  EXPECT_EQ(found, drifted.named);
  EXPECT_LE(std::ranges::count(alarms, true), 1) << "of 1,000 arm-months";
  EXPECT_GE(std::ranges::count(found, true), kArms * 99 / 100) << "within ten checks";
}

}  // namespace
}  // namespace armsig::fleet
