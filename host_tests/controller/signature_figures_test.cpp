// SPDX-License-Identifier: MIT
// Every accuracy that the controller reports is of the signature that the same reply names, through
// accepts, rollbacks, power cuts at every change of the memory, and restarts.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "host_tests/support/self_calibrating_puma.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

// The value under ` key=` of a reply; empty: none.
std::string value_of(const std::string& reply, const std::string& key) {
  const std::size_t at = reply.find(" " + key + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size() + 2;
  return reply.substr(begin, reply.find(' ', begin) - begin);
}

// The accuracy that a reply reports, as it is printed.
using Figures = std::map<std::string, std::string>;
Figures figures_in(const std::string& reply) {
  Figures figures;
  for (const char* key : {"predicted_tool_error_mm", "predicted_region", "validation_rms_mm",
                          "validation_poses", "air_c"}) {
    if (const std::string value = value_of(reply, key); !value.empty()) figures[key] = value;
  }
  return figures;
}

Configuration quick() {
  Configuration c = test::puma_controller();
  c.sweeps.points = c.sweeps.most_points = 8;
  c.sweeps.validation_poses = 3;
  return c;
}

struct Reports : PumaCabinet {
  Reports() : PumaCabinet(1, quick()) { EXPECT_TRUE(enable()); }

  // The figures of the candidate; all of those that there are.
  Figures identified() {
    EXPECT_EQ(ask("identify"), "ok");
    EXPECT_TRUE(run_until(Mode::kSweeping, 1) && run_until(Mode::kHolding, 3600));
    const std::string reply = ask("candidate");
    EXPECT_EQ(value_of(reply, "signature"), "candidate") << reply;
    EXPECT_EQ(figures_in(reply).size(), 5U) << reply;
    return figures_in(reply);
  }
  void restart(std::uint64_t seed) {
    start(quick(), seed);
    ASSERT_TRUE(enable());
  }
  // Nothing but the figures of signature `number`, 0: of the drawing.
  void expect_reported(int number) {
    for (const char* asking : {"status", "signature"}) {
      const std::string reply = ask(asking);
      EXPECT_EQ(value_of(reply, "model"), number == 0 ? "nominal" : "signature") << reply;
      EXPECT_EQ(value_of(reply, "signature"), number == 0 ? "" : std::to_string(number)) << reply;
      EXPECT_EQ(figures_in(reply), known[number]) << reply;
    }
  }

  std::map<int, Figures> known;  // by the number of the signature
};

TEST(SignatureFigures, are_of_the_signature_that_the_same_reply_names) {
  Reports puma;
  puma.expect_reported(0);
  puma.known[1] = puma.identified();
  puma.expect_reported(0);
  ASSERT_EQ(puma.ask("accept"), "ok");
  puma.expect_reported(1);
  puma.restart(2);
  puma.expect_reported(1);
  for (int tries = 0; tries < 20 && puma.known[2].empty(); ++tries) {
    const Figures found = puma.identified();
    puma.expect_reported(1);
    EXPECT_EQ(value_of(puma.ask("candidate"), "active"), "1");
    if (puma.ask("accept") == "ok") puma.known[2] = found;  // it was better by chance
  }
  ASSERT_NE(puma.known[1], puma.known[2]);
  puma.expect_reported(2);
  ASSERT_EQ(puma.ask("rollback"), "ok");
  puma.expect_reported(1);
  puma.restart(3);
  puma.expect_reported(1);
  ASSERT_EQ(puma.ask("rollback"), "ok");
  puma.expect_reported(0);
  puma.restart(4);
  puma.expect_reported(0);
}

// What was accepted, or nothing, and no figure of what is not stored.
TEST(SignatureFigures, are_of_what_is_stored_where_power_goes_while_it_is_stored) {
  bool stored = false;
  for (int ticks = 0; ticks < 400 && !stored; ticks += 7) {
    Reports puma;
    puma.known[1] = puma.identified();
    puma.console.requests.emplace_back("accept");
    for (int i = 0; i < ticks; ++i) puma.cabinet->step();
    puma.restart(2);
    const std::string reply = puma.ask("status");
    stored = value_of(reply, "model") == "signature";
    puma.expect_reported(stored ? 1 : 0);
    EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE"));
  }
  EXPECT_TRUE(stored);
}

TEST(SignatureFigures, of_a_self_calibration_are_of_its_region_and_go_with_a_rollback) {
  BentPuma puma;
  ASSERT_NE(puma.identified("identify accuracy_mm=0.15 minutes=60"), nullptr);
  const std::string outcome = puma.heard("# identify accuracy=");
  const std::string candidate = puma.ask("candidate");
  EXPECT_EQ(value_of(outcome, "signature"), "candidate") << outcome;
  EXPECT_EQ(value_of(candidate, "reached"), "yes") << candidate;
  EXPECT_EQ(value_of(candidate, "asked_mm"), "0.1500") << candidate;
  for (const char* key : {"predicted_tool_error_mm", "predicted_region"}) {
    EXPECT_EQ(value_of(candidate, key), value_of(outcome, key)) << key;
  }
  EXPECT_EQ(value_of(candidate, "predicted_region"), "limits");
  ASSERT_EQ(puma.ask("accept"), "ok");
  for (const char* asking : {"status", "signature"}) {
    EXPECT_EQ(figures_in(puma.ask(asking)), figures_in(candidate)) << asking;
  }
  EXPECT_EQ(puma.cabinet->state().active()->method, Method::kRefined);
  ASSERT_EQ(puma.ask("rollback"), "ok");
  for (const char* asking : {"status", "signature"}) {
    EXPECT_EQ(figures_in(puma.ask(asking)), Figures()) << asking;
  }
}

// Images of before there was a region: a predicted error of no region is none.
TEST(SignatureFigures, are_read_with_their_region_or_not_at_all) {
  SignatureRecord record;
  const KnownTarget known{1, 6, Vector3(0.15, 0, 0.05)};
  record.signature = signature_of(tool::table2_robot(1), JointVector(6, 0.1), Pose{}, {&known, 1});
  record.accuracy = {ToolAccuracy::Predicted{1e-4, PredictedRegion::kSignatureConfiguration},
                     ToolAccuracy::Validated{2e-4, 20}};
  RecordImage image = encode(record);
  const auto decoded = [&](std::size_t at, std::uint8_t byte) {
    image[at] = byte;
    const auto content = std::as_bytes(std::span(image).first(kRecordBytes - 4));
    const std::uint32_t crc = crc32(content);
    for (std::size_t i = 0; i < 4; ++i) {
      image[kRecordBytes - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    }
    SignatureRecord found;
    return decode(image, tool::puma560(), found) ? std::optional(found.accuracy) : std::nullopt;
  };
  EXPECT_EQ(decoded(4, 4), record.accuracy);
  EXPECT_EQ(decoded(1020, 3), std::nullopt) << "no such region";
  EXPECT_EQ(decoded(1020, 2)->predicted->region, PredictedRegion::kJointLimits);
  EXPECT_EQ(decoded(7, 4), std::nullopt) << "no such method";
}

// All that `status` can say at once has room in its line.
TEST(SignatureFigures, have_room_in_the_status) {
  Reports puma;
  puma.known[1] = puma.identified();
  ASSERT_EQ(puma.ask("accept"), "ok");
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(30);
  const std::string reply = puma.ask("status");
  EXPECT_FALSE(value_of(reply, "step_max_us").empty()) << reply;
  EXPECT_LT(reply.size() + 300, 1024U) << reply;
}

}  // namespace
}  // namespace armsig::controller
