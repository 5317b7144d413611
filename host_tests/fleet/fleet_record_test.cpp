// SPDX-License-Identifier: MIT
// The record on a real PostgreSQL; host_tests/fleet/with_record starts it.
#include <cstdlib>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/drift/cusum.hpp"
#include "firmware/fleet/host/database.hpp"
#include "firmware/fleet/node/controller_lines.hpp"
#include "firmware/fleet/node/sha256.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::fleet {
namespace {

constexpr DriftSettings kDrift{
    .sigma_mm = 0.02, .reference = 2.5, .threshold = 5.6, .baseline = 20};

class FleetRecord : public testing::Test {
 protected:
  void SetUp() override {
    const char* where = std::getenv("ARMSIG_RECORD");
    ASSERT_NE(where, nullptr) << "run by host_tests/fleet/with_record";
    database = Database::open(where, kDrift, problem);
    ASSERT_TRUE(database) << problem;
    ASSERT_TRUE(database->ask("TRUNCATE arm, row, signature CASCADE"));
  }
  std::string one(const std::string& question) {
    const auto table = database->ask(question.c_str());
    EXPECT_TRUE(table) << database->problem();
    if (!table || table->empty()) return "nothing";
    return (*table)[0][0].value_or("null");
  }
  void store(const Batch& batch) { ASSERT_TRUE(database->store(batch)) << database->problem(); }

  std::string problem;
  std::optional<Database> database;
};

StoredRow row(std::uint64_t number, const Reading& reading, std::uint64_t journal = 1) {
  StoredRow stored{.node = "arm-1",
                   .journal = journal,
                   .number = number,
                   .dropped = 0,
                   .time_ms = 1'700'000'000'000 + number,
                   .historical = false,
                   .readings = {}};
  stored.readings.push_back(reading);
  return stored;
}

StoredRow check(std::uint64_t number, const Vector3& e_mm) {
  StoredRow stored = row(number, {Item::kVerdict, Text("consistent")});
  stored.readings.push_back({Item::kResidualX, e_mm.x()});
  stored.readings.push_back({Item::kResidualY, e_mm.y()});
  stored.readings.push_back({Item::kResidualZ, e_mm.z()});
  return stored;
}

Batch born() {
  Batch batch;
  batch.states.push_back({"arm-1", true, {}});
  return batch;
}

TEST_F(FleetRecord, RowsAndHowFarTheyGoAreStoredTogether) {
  Batch batch = born();
  constexpr std::uint64_t kName = 0xFEDCBA9876543210;
  batch.rows.push_back(row(5, {Item::kMode, Text("idle \"quoted\" \\ {,}")}, kName));
  batch.rows.push_back(row(9, {Item::kLatenessMax, 20.5}, kName));
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM row"), "2");
  EXPECT_EQ(one("SELECT current ->> 'mode' FROM arm"), "idle \"quoted\" \\ {,}");
  EXPECT_EQ(one("SELECT current ->> 'late_max_us' FROM arm"), "20.5");
  const auto journals = database->journals();
  ASSERT_TRUE(journals);
  ASSERT_EQ(journals->size(), 1U);
  EXPECT_EQ((*journals)[0].journal, kName);
  EXPECT_EQ((*journals)[0].contiguous, 9U);
}

TEST_F(FleetRecord, BatchWithARowThatIsThereIsRefusedWhole) {
  Batch first = born();
  first.rows.push_back(row(1, {Item::kAir, 1.0}));
  store(first);
  Batch second;
  second.rows.push_back(row(2, {Item::kAir, 2.0}));
  second.rows.push_back(row(1, {Item::kAir, 1.0}));
  EXPECT_FALSE(database->store(second));
  EXPECT_NE(database->problem().find("row_pkey"), std::string::npos) << database->problem();
  EXPECT_EQ(one("SELECT count(*) FROM row"), "1");
  EXPECT_EQ(one("SELECT contiguous FROM journal"), "1");
}

TEST_F(FleetRecord, NoValueThatACabinetCanSendStopsIt) {
  Batch batch = born();
  const double infinite = std::numeric_limits<double>::infinity();
  const double largest = std::numeric_limits<double>::max();
  std::uint64_t number = 0;
  for (const std::string& text :
       {std::string("\xff\xfe"), std::string("\xed\xa0\x80"), std::string("a\x01\n\"\\'"),
        std::string("\xc3"), std::string("\xf4\x90\x80\x80")}) {
    batch.rows.push_back(row(++number, {Item::kFault, Text(text)}));
  }
  batch.rows.push_back(row(++number, {Item::kAir, infinite}));
  batch.rows.push_back(check(++number, {largest, -largest, 1e-320}));
  batch.rows.push_back(check(++number, {infinite, std::nan(""), 0}));
  batch.rows.push_back(row(++number, {Item::kSignatureDate, ~std::uint64_t{0}}));
  batch.rows.back().time_ms = 253'402'300'799'000;
  batch.rows.back().dropped = ~std::uint64_t{0} >> 1U;
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM row"), std::to_string(number));
}

StoredRow of(const std::string& node, StoredRow stored) {
  stored.node = node;
  return stored;
}

// Every other arm's rows are stored, in this batch and in the next ones; the row counts as arrived.
TEST_F(FleetRecord, RowThatItCannotTakeIsSetAsideAndStopsNoOther) {
  Batch batch = born();
  batch.states.push_back({"arm-2", true, {}});
  std::uint64_t number = 0;
  while (number < 20) batch.rows.push_back(check(++number, {0, 0, 0}));
  batch.rows.push_back(check(++number, {1e-200, 0, 0}));  // its square is none
  batch.rows.push_back(check(++number, {0.01, 0, 0}));
  batch.rows.push_back(of("arm-2", check(1, {0.01, 0, 0})));
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM row WHERE node = 'arm-1'"), "21");
  EXPECT_EQ(one("SELECT count(*) FROM row WHERE node = 'arm-2'"), "1");
  EXPECT_EQ(one("SELECT node || ' ' || number FROM row_refused"), "arm-1 21");
  EXPECT_NE(one("SELECT problem FROM row_refused").find("(SQLSTATE 22003)"), std::string::npos);
  EXPECT_NE(one("SELECT reading FROM row_refused").find("1e-200"), std::string::npos);
  EXPECT_EQ(one("SELECT contiguous FROM journal WHERE node = 'arm-1'"), "22");
  EXPECT_NE(database->set_aside().find("of arm-1 is set aside: number 21: "), std::string::npos);
  Batch next;
  next.rows.push_back(check(23, {0, 1e-200, 0}));
  next.rows.push_back(of("arm-2", check(2, {0.01, 0, 0})));
  store(next);
  EXPECT_EQ(one("SELECT contiguous FROM journal WHERE node = 'arm-1'"), "23");
  EXPECT_EQ(one("SELECT count(*) FROM row_refused"), "2");
  Batch sound;
  sound.rows.push_back(of("arm-2", check(3, {0.01, 0, 0})));
  store(sound);
  EXPECT_EQ(database->set_aside(), "");
}

// A birth that it cannot take leaves the arm known, without what it told.
TEST_F(FleetRecord, BirthThatItCannotTakeStopsNoRow) {
  Batch batch;
  ASSERT_TRUE(
      database->ask("ALTER TABLE arm ADD CONSTRAINT no_fault CHECK (NOT current ? 'fault')"));
  batch.states.push_back({"arm-1", true, {}});
  batch.states[0].current.push_back({Item::kFault, Text("hostile")});
  batch.states.push_back({"arm-2", true, {}});
  batch.rows.push_back(row(1, {Item::kMode, Text("idle")}));
  batch.rows.push_back(of("arm-2", row(1, {Item::kMode, Text("idle")})));
  store(batch);
  ASSERT_TRUE(database->ask("ALTER TABLE arm DROP CONSTRAINT no_fault"));
  EXPECT_EQ(one("SELECT count(*) FROM row"), "2");
  EXPECT_EQ(one("SELECT count(*) FROM arm WHERE online"), "2");
  EXPECT_EQ(one("SELECT current ->> 'fault' FROM arm WHERE node = 'arm-1'"), "null");
}

constexpr const char* kFigures =
    "SELECT concat_ws(' ', current ->> 'signature', current ->> 'signature_number', "
    "current ->> 'predicted_tool_error_mm', current ->> 'predicted_region', "
    "current ->> 'validation_rms_mm', current ->> 'validation_poses', current ->> 'air_c') FROM "
    "arm";

StoredRow signed_by(std::uint64_t number, const std::string& line) {
  StoredRow stored = row(number, {Item::kMode, Text("holding")});
  stored.readings = readings_of_signature(line);
  return stored;
}

// Whatever it is told, the record has no figure beside a signature that it is not of.
TEST_F(FleetRecord, FiguresOfASignatureGoWithIt) {
  const std::string first =
      "ok model=signature signature=1 predicted_tool_error_mm=0.1357 predicted_region=limits "
      "validation_rms_mm=0.1500 validation_poses=20 air_c=21.5 theta1_deg=1";
  const std::string second =
      "ok model=signature signature=2 predicted_tool_error_mm=0.0267 "
      "predicted_region=configuration air_c=22.5 theta1_deg=2";
  const std::string of_first = sha256("theta1_deg=1") + " 1 0.1357 limits 0.15 20 21.5";
  const std::string of_second = sha256("theta1_deg=2") + " 2 0.0267 configuration 22.5";
  Batch batch = born();
  batch.rows.push_back(signed_by(1, first));
  store(batch);
  EXPECT_EQ(one(kFigures), of_first);
  const auto then = [&](const StoredRow& told) {
    Batch next;
    next.rows.push_back(told);
    store(next);
    return one(kFigures);
  };
  EXPECT_EQ(then(signed_by(2, second)), of_second);
  EXPECT_EQ(then(row(3, {Item::kValidation, 0.001})), of_second) << "of no signature";
  EXPECT_EQ(then(signed_by(4, first)), of_first) << "rolled back";
  Batch away;
  away.states.push_back({"arm-1", false, {}});
  store(away);
  EXPECT_EQ(one(kFigures), of_first);
  Readings reborn;  // all that it has not heard yet is without a value
  for (const ItemInfo& item : kItems) reborn.push_back({item.item, {}});
  Batch birth;
  birth.states.push_back({"arm-1", true, reborn});
  store(birth);
  EXPECT_EQ(one(kFigures), of_first) << "nothing else is known";
  for (Reading& reading : reborn) {
    if (reading.item == Item::kModel) reading.value = Text("nominal");
  }
  birth.states[0].current = reborn;
  store(birth);
  EXPECT_EQ(one(kFigures), "") << "the nominal model";
  EXPECT_EQ(then(signed_by(5, first)), of_first);
  EXPECT_EQ(then(signed_by(6, "ok model=nominal")), "");
  EXPECT_EQ(one("SELECT string_agg(concat_ws(' ', number, predicted_tool_error_mm, "
                "predicted_region, validation_rms_mm, validation_poses), ', ' ORDER BY id) FROM "
                "worn"),
            "1 0.1357 limits 0.15 20, 2 0.0267 configuration, 1 0.1357 limits 0.15 20, ")
      << "the same is told once more and is no news; then the nominal model";
}

TEST_F(FleetRecord, SqlAggregateIsCoresSum) {
  simulated::Random random(11);
  ASSERT_TRUE(database->ask("CREATE TEMP TABLE z (n serial, x float8, y float8, z float8)"));
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < 500; ++i) {
    const Vector3 z = random.normal_vector() + (i > 400 ? 2.0 : 0.0) * Vector3::UnitY();
    sum = drift::crosier(sum, z, 1.4);
    char numbers[3][32];
    for (int axis = 0; axis < 3; ++axis) std::snprintf(numbers[axis], 32, "%.17g", z[axis]);
    ASSERT_TRUE(database->ask("INSERT INTO z (x, y, z) VALUES ($1::float8, $2::float8, $3::float8)",
                              {numbers[0], numbers[1], numbers[2]}));
    if (i % 50 != 49) continue;
    const auto table = database->ask(
        "WITH s AS (SELECT crosier(x, y, z, 1.4 ORDER BY n) AS s FROM z) SELECT s[1], s[2], s[3] "
        "FROM s");
    ASSERT_TRUE(table) << database->problem();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::stod(*(*table)[0][static_cast<std::size_t>(axis)]), sum[axis], 1e-12);
    }
  }
  EXPECT_GT(sum.norm(), 10);
}

TEST_F(FleetRecord, DriftIsNamedWithinTenChecksByTheHostAlike) {
  simulated::Random random(12);
  Batch batch = born();
  drift::State state;
  Vector3 baseline = Vector3::Zero();
  const drift::Settings settings{kDrift.sigma_mm, kDrift.reference, kDrift.threshold};
  for (std::uint64_t n = 1; n <= 60; ++n) {
    const Vector3 e =
        kDrift.sigma_mm * random.normal_vector() + (n > 50 ? 0.1 : 0.0) * Vector3(0.6, 0, 0.8);
    batch.rows.push_back(check(n, e));
    if (n <= 20) {
      baseline += e / 20;
    } else {
      state = drift::after_check(state, e - baseline, settings).value_or(state);
    }
    if (n == 50) {
      EXPECT_FALSE(state.named);
    }
  }
  store(batch);
  EXPECT_TRUE(state.named);
  EXPECT_EQ(one("SELECT checks FROM drift"), "60");
  EXPECT_EQ(one("SELECT named_at IS NOT NULL FROM drift"), "t");
  EXPECT_EQ(one("SELECT named_at > to_timestamp(1700000000.050) FROM drift"), "t");
  EXPECT_NEAR(std::stod(one("SELECT sqrt(sum[1]^2 + sum[2]^2 + sum[3]^2) FROM drift")),
              state.sum.norm(), 1e-9);
}

TEST_F(FleetRecord, NewSignatureBeginsANewBaseline) {
  Batch batch = born();
  for (std::uint64_t n = 1; n <= 30; ++n) batch.rows.push_back(check(n, {1, 1, 1}));
  store(batch);
  Batch next;
  next.rows.push_back(row(31, {Item::kSignatureHash, Text("abc")}));
  next.rows.push_back(check(32, {0, 0, 0}));
  store(next);
  EXPECT_EQ(one("SELECT checks FROM drift"), "1");
  EXPECT_EQ(one("SELECT signature FROM drift"), "abc");
}

constexpr std::string_view kParameters =
    "theta1_deg=-90.012345 d1_mm=0.1000 a1_mm=-0.2000 alpha1_deg=-90.001000 theta2_deg=0.020000 "
    "d2_mm=149.0900 a2_mm=431.8000 alpha2_deg=0.010000";

// The rows by which a cabinet tells a signature, from `number` on.
std::vector<StoredRow> told(std::string_view document, std::uint64_t number) {
  std::vector<StoredRow> rows;
  for (const Readings& part : readings_of_document(document)) {
    rows.push_back(row(number++, part[0]));
    rows.back().readings = part;
  }
  rows.push_back(row(number, {Item::kSignatureHash, Text(sha256(document))}));
  rows.back().readings.push_back({Item::kValidation, 0.12});
  return rows;
}

TEST_F(FleetRecord, DocumentOfASignatureIsPutTogetherUnderItsHash) {
  Batch batch = born();
  batch.rows = told(kParameters, 1);
  ASSERT_EQ(batch.rows.size(), 3U) << "two parts, and who goes by it";
  const StoredRow second = batch.rows[1];
  batch.rows.erase(batch.rows.begin() + 1);
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM signature"), "0") << "a part is missing";
  EXPECT_EQ(one("SELECT hash FROM worn"), sha256(kParameters));
  EXPECT_EQ(one("SELECT validation_rms_mm FROM worn"), "0.12");
  Batch rest;
  rest.rows.push_back(second);
  rest.rows[0].number = 9;
  store(rest);
  EXPECT_EQ(one("SELECT document FROM signature"), kParameters);
  EXPECT_EQ(one("SELECT hash FROM signature"), sha256(kParameters));
  EXPECT_EQ(one("SELECT count(*) FROM signature_part"), "0");
  EXPECT_EQ(one("SELECT current ? 'document_text' FROM arm"), "f") << "of rows, not of the arm";
}

// Two joints, the second a slide, with maps and gravity.
std::string bent(const std::string& a2_mm, int knot, const std::string& sag) {
  std::string document =
      "theta1_deg=0 d1_mm=1.5 a1_mm=0 alpha1_deg=-90 theta2_deg=0 d2_mm=2 a2_mm=" + a2_mm +
      " alpha2_deg=0 type2=prismatic";
  for (const char* const joint : {"1_rad", "2_m"}) {
    const std::string n(1, joint[0]);
    const std::string unit = joint + 1;
    document += " zero" + n + unit + "=0 map" + n + "_from" + unit + "=-3 map" + n + "_knots_per" +
                unit + "=19 map" + n + "_step" + unit + "=1e-06 map" + n + "=" +
                std::to_string(knot);
    for (int i = 1; i < 120; ++i) document += ",0";
  }
  return document + " gravity=1,1,0.001 gravity=1,2," + sag;
}

TEST_F(FleetRecord, SignaturesAreComparedJointByJointInSql) {
  const std::string former = bent("10", 0, "-1e-05");
  const std::string actual = bent("10.25", -100, "2e-05");
  Batch batch = born();
  batch.rows = told(former, 1);
  const std::uint64_t next = batch.rows.size() + 1;
  for (StoredRow& row : told(actual, next)) batch.rows.push_back(row);
  store(batch);
  ASSERT_EQ(one("SELECT count(*) FROM signature"), "2");
  EXPECT_EQ(one("SELECT count(*) FROM signature_joint"), "4");
  EXPECT_EQ(one("SELECT string_agg(type, ' ' ORDER BY joint) FROM signature_joint WHERE hash = '" +
                sha256(actual) + "'"),
            "revolute prismatic");
  const auto change = [&](const std::string& what, int joint) {
    return std::stod(one("SELECT " + what + " FROM signature_changes('" + sha256(former) + "', '" +
                         sha256(actual) + "') WHERE joint = " + std::to_string(joint)));
  };
  EXPECT_NEAR(change("a_mm", 2), 0.25, 1e-9);
  EXPECT_NEAR(change("d_mm", 1), 0, 1e-12);
  EXPECT_NEAR(change("map", 1), degrees(1e-4), 1e-9);  // of a hundred steps
  EXPECT_NEAR(change("map", 2), 0.1, 1e-9);            // mm
  EXPECT_NEAR(change("gravity", 1), degrees(3e-5), 1e-9);
  EXPECT_EQ(one("SELECT gravity IS NULL FROM signature_changes('" + sha256(former) + "', '" +
                sha256(actual) + "') WHERE joint = 2"),
            "t");
}

TEST_F(FleetRecord, DocumentThatIsNotWhatItsHashSaysIsRefusedAndCounted) {
  Batch batch = born();
  batch.rows = told(kParameters, 1);
  batch.rows[1].readings[3].value = Text("d2_mm=1");
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM signature"), "0");
  EXPECT_EQ(one("SELECT documents FROM signature_refused"), "1");
  Batch again;
  again.rows = told(kParameters, 10);
  store(again);
  EXPECT_EQ(one("SELECT count(*) FROM signature"), "1") << "and may be told rightly afterwards";
}

TEST_F(FleetRecord, PartsThatAreNoneStopNothing) {
  Batch batch = born();
  const std::uint64_t huge = ~std::uint64_t{0};
  std::uint64_t number = 0;
  for (const auto& [part, parts] :
       {std::pair{huge, huge}, {0UL, 1UL}, {2UL, 1UL}, {1UL, kMostDocumentParts + 1}}) {
    batch.rows.push_back(row(++number, {Item::kDocumentHash, Text(sha256("x"))}));
    batch.rows.back().readings.push_back({Item::kDocumentPart, part});
    batch.rows.back().readings.push_back({Item::kDocumentParts, parts});
    batch.rows.back().readings.push_back({Item::kDocumentText, Text("x")});
  }
  batch.rows.push_back(row(++number, {Item::kDocumentText, Text("alone")}));
  batch.rows.push_back(row(++number, {Item::kDocumentText, {}}));
  store(batch);
  EXPECT_EQ(one("SELECT count(*) FROM row"), std::to_string(number));
  EXPECT_EQ(one("SELECT count(*) FROM signature_part"), "0");
}

TEST_F(FleetRecord, EachChangeOfSignatureIsKeptOnce) {
  Batch batch = born();
  batch.rows = told(kParameters, 1);
  const auto tell = [&](std::uint64_t number, const Value& hash) {
    batch.rows.push_back(row(number, {Item::kSignatureHash, hash}));
  };
  tell(10, Text(sha256(kParameters)));  // the cabinet was restarted
  tell(11, Text("other"));
  tell(12, {});  // the drawing
  tell(13, Text(sha256(kParameters)));
  store(batch);
  EXPECT_EQ(one("SELECT string_agg(coalesce(left(hash, 5), 'none'), ' ' ORDER BY id) FROM worn"),
            sha256(kParameters).substr(0, 5) + " other none " + sha256(kParameters).substr(0, 5));
}

TEST_F(FleetRecord, SchemaIsBroughtUpToDateOnce) {
  std::string why;
  ASSERT_TRUE(Database::open(std::getenv("ARMSIG_RECORD"), kDrift, why)) << why;
  EXPECT_EQ(one("SELECT count(*) FROM migration"), "6");
  EXPECT_EQ(one("SELECT h FROM drift_setting"), "5.6");
}

TEST_F(FleetRecord, SignatureIsKeptUnderItsOwnHashOnly) {
  EXPECT_FALSE(database->ask("INSERT INTO signature VALUES ('00', 'theta1_deg=1')"));
  EXPECT_TRUE(
      database->ask("INSERT INTO signature VALUES (encode(sha256('theta1_deg=1'::bytea), 'hex'), "
                    "'theta1_deg=1')"));
}

TEST_F(FleetRecord, RecordThatIsNotThereIsSaid) {
  std::string why;
  EXPECT_FALSE(Database::open("host=/nowhere dbname=none", kDrift, why));
  EXPECT_FALSE(why.empty());
}

}  // namespace
}  // namespace armsig::fleet
