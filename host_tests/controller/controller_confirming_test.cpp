// SPDX-License-Identifier: MIT
// A signature that was sent, and a second person who confirms it in place of a measurement.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/sent_signature.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

Configuration configured(Measures measures, SentNeeds needs) {
  Configuration c = test::puma_controller();
  c.sensor.measures = measures;
  c.sensor.point_sigma_m = 0.02e-3;
  c.sent_needs = needs;
  return c;
}

SignatureRecord record_for_sending() {
  static const SignatureRecord once = [] {
    PumaCabinet puma(1, configured(Measures::kPoints, SentNeeds::kMeasured));
    EXPECT_TRUE(test::identify_and_accept(puma));
    SignatureRecord record = *puma.cabinet->state().active();
    record.machine = {.drives = {}, .drawing_crc = told_drawing_crc(tool::puma560())};
    return record;
  }();
  return once;
}

// Nothing measures, a second person may confirm, and `sender` has sent a signature.
struct Sent {
  explicit Sent(const std::string& sender, SentNeeds needs = SentNeeds::kConfirmed)
      : puma(1, configured(Measures::kNothing, needs)) {
    EXPECT_TRUE(puma.enable());
    send(sender);
  }
  void send(const std::string& sender) {
    const RecordImage image = encode(record_for_sending());
    for (std::size_t part = 1; part <= test::kParts; ++part) {
      std::string request = test::part_of(image, part);
      if (!sender.empty()) request.insert(request.find(" hex="), " by=" + sender);
      reply = puma.ask(request);
    }
  }
  PumaCabinet puma;
  std::string reply;
};

TEST(Confirming, by_a_second_person_brings_a_signature_into_use_and_is_told) {
  Sent sent("anna");
  ASSERT_EQ(sent.reply, "ok received=candidate");
  EXPECT_TRUE(sent.puma.ask("accept").starts_with("error NO_CANDIDATE"));
  ASSERT_EQ(sent.puma.ask("accept by=ben"), "ok");
  const auto& active = sent.puma.cabinet->state().active();
  ASSERT_TRUE(active);
  EXPECT_TRUE(active->signature.X_SL[3].p == record_for_sending().signature.X_SL[3].p);
  bool told = false;
  for (const std::string& line : sent.puma.console.told) {
    told = told || line == "# candidate confirmed sent_by=anna confirmed_by=ben";
  }
  EXPECT_TRUE(told);
  EXPECT_NE(sent.puma.ask("signature").find(" sent_by=anna confirmed_by=ben "), std::string::npos);
  // It is of this machine, and so after a restart.
  ASSERT_EQ(sent.puma.ask("disable"), "ok");
  sent.puma.run(5);
  sent.puma.start(configured(Measures::kNothing, SentNeeds::kConfirmed), 1);
  ASSERT_TRUE(sent.puma.run_until(Mode::kIdle));
  EXPECT_TRUE(sent.puma.cabinet->state().active());
  EXPECT_NE(sent.puma.ask("signature").find(" sent_by=anna confirmed_by=ben "), std::string::npos);
}

TEST(Confirming, names_who_answers_for_the_signature_that_a_rollback_brings_back) {
  Sent sent("anna");
  ASSERT_EQ(sent.puma.ask("accept by=ben"), "ok");
  sent.send("carla");
  ASSERT_EQ(sent.puma.ask("accept by=dora"), "ok");
  EXPECT_NE(sent.puma.ask("signature").find(" sent_by=carla confirmed_by=dora "),
            std::string::npos);
  ASSERT_EQ(sent.puma.ask("rollback"), "ok");
  EXPECT_NE(sent.puma.ask("signature").find(" sent_by=anna confirmed_by=ben "), std::string::npos);
}

TEST(Confirming, is_said_of_no_signature_that_was_measured_here) {
  PumaCabinet puma(1, configured(Measures::kPoints, SentNeeds::kMeasured));
  ASSERT_TRUE(test::identify_and_accept(puma));
  EXPECT_EQ(puma.ask("signature").find("_by="), std::string::npos);
}

TEST(Confirming, by_the_sender_is_refused_however_the_name_is_written) {
  Sent sent("anna");
  for (const char* name : {"anna", "Anna", "ANNA"}) {
    EXPECT_EQ(sent.puma.ask(std::string("accept by=") + name),
              "error NOT_CONFIRMED no second person has confirmed it why=\"anna has sent it\"");
  }
  EXPECT_EQ(sent.puma.memory.stored, 0U);
}

TEST(Confirming, of_what_nobody_is_known_to_have_sent_is_refused) {
  Sent sent("");
  ASSERT_EQ(sent.reply, "ok received=candidate");
  EXPECT_TRUE(sent.puma.ask("accept by=ben").starts_with("error NOT_CONFIRMED"));
}

TEST(Confirming, where_the_configuration_wants_a_measurement_is_refused) {
  Sent sent("anna", SentNeeds::kMeasured);
  EXPECT_TRUE(sent.puma.ask("accept by=ben").starts_with("error UNSUPPORTED"));
}

TEST(Confirming, needs_a_candidate_and_a_name) {
  PumaCabinet puma(1, configured(Measures::kNothing, SentNeeds::kConfirmed));
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("accept by=ben").starts_with("error NO_CANDIDATE"));
  EXPECT_TRUE(puma.ask("accept by=").starts_with("error OUT_OF_RANGE"));
  EXPECT_TRUE(puma.ask("accept by=\"ben\"").starts_with("error OUT_OF_RANGE"));
  EXPECT_TRUE(puma.ask("accept by=" + std::string(33, 'b')).starts_with("error OUT_OF_RANGE"));
  EXPECT_TRUE(puma.ask("accept name=ben").starts_with("error UNKNOWN_REQUEST"));
}

TEST(Confirming, cannot_lift_what_a_measurement_has_found_worse) {
  PumaCabinet puma(1, configured(Measures::kPoints, SentNeeds::kConfirmed));
  ASSERT_TRUE(test::identify_and_accept(puma));
  SignatureRecord worse = record_for_sending();
  for (std::size_t k = 3; k < worse.signature.X_SL.size(); ++k)
    worse.signature.X_SL[k].p.x() += 2e-3;
  const RecordImage image = encode(worse);
  for (std::size_t part = 1; part <= test::kParts; ++part) {
    std::string request = test::part_of(image, part);
    ASSERT_TRUE(puma.ask(request.insert(request.find(" hex="), " by=anna")).starts_with("ok"));
  }
  ASSERT_EQ(puma.ask("compare"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  EXPECT_TRUE(puma.ask("accept").starts_with("error CANDIDATE_NO_BETTER"));
  EXPECT_TRUE(puma.ask("accept by=ben").starts_with("error NO_CANDIDATE"));
}

}  // namespace
}  // namespace armsig::controller
