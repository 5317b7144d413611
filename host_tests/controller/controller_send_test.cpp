// SPDX-License-Identifier: MIT
// A signature from outside: what arrives damaged or does not belong here is refused by name, and
// what arrives well has to beat the active model on held-out poses as any other.
#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/receiving.hpp"
#include "host_tests/support/sent_signature.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::part_of;
using test::PumaCabinet;
using test::sent;

struct Identified {
  std::vector<std::uint8_t> memory;
  SignatureRecord record;  // as armsig connect ... send makes it
};

const Identified& identified() {
  static const Identified once = [] {
    PumaCabinet puma;
    EXPECT_TRUE(test::identify_and_accept(puma));
    Identified result{puma.memory.bytes, *puma.cabinet->state().active()};
    result.record.machine = {.drives = {}, .drawing_crc = told_drawing_crc(tool::puma560())};
    return result;
  }();
  return once;
}

// Link 2 longer by so much than it is: all that it carries is further out.
SignatureRecord with_longer_link(SignatureRecord record, double by_m) {
  Signature& signature = record.signature;
  const Vector3 by = by_m * signature.X_SL[2].R.col(0);
  for (std::size_t k = 2; k < signature.X_SL.size(); ++k) signature.X_SL[k].p += by;
  for (Target& target : signature.targets) target.p_S += by;
  return record;
}

TEST(Send, signature_that_fits_is_compared_accepted_and_in_use) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("compare").starts_with("error NO_CANDIDATE"));
  ASSERT_EQ(sent(puma, encode(identified().record)), "ok received=candidate");
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE")) << "not compared yet";
  EXPECT_TRUE(puma.ask("accept").starts_with("error NO_CANDIDATE"));
  EXPECT_EQ(puma.memory.stored, 0U);
  ASSERT_EQ(puma.ask("compare"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  EXPECT_TRUE(puma.ask("status").contains(" planned=8 "));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  EXPECT_TRUE(puma.ask("candidate").contains(" better=yes")) << puma.ask("candidate");
  EXPECT_EQ(puma.ask("log"), "ok rows=0 capacity=" + std::to_string(kMostLogged));
  ASSERT_EQ(puma.ask("accept"), "ok");
  const auto& active = puma.cabinet->state().active();
  ASSERT_TRUE(active);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_TRUE(active->signature.X_SL[k].p == identified().record.signature.X_SL[k].p);
  }
  EXPECT_TRUE(puma.ask("compare").starts_with("error NO_CANDIDATE"));
}

TEST(Send, names_the_sender_of_a_signature_that_was_measured) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const RecordImage image = encode(identified().record);
  for (std::size_t part = 1; part <= test::kParts; ++part) {
    std::string request = test::part_of(image, part);
    ASSERT_TRUE(puma.ask(request.insert(request.find(" hex="), " by=anna")).starts_with("ok"));
  }
  ASSERT_EQ(puma.ask("compare"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  ASSERT_EQ(puma.ask("accept"), "ok");
  const std::string signature = puma.ask("signature");
  EXPECT_NE(signature.find(" sent_by=anna "), std::string::npos) << signature;
  EXPECT_EQ(signature.find("confirmed_by"), std::string::npos);
}

TEST(Send, link_two_millimetres_off_is_refused_by_the_held_out_poses) {
  PumaCabinet puma;
  puma.memory.bytes = identified().memory;
  puma.start(test::puma_controller(), 3);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(sent(puma, encode(with_longer_link(identified().record, 2e-3))),
            "ok received=candidate");
  ASSERT_EQ(puma.ask("compare"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  EXPECT_TRUE(puma.ask("candidate").contains(" better=no")) << puma.ask("candidate");
  EXPECT_TRUE(puma.ask("accept").starts_with("error CANDIDATE_NO_BETTER"));
  EXPECT_EQ(puma.memory.bytes, identified().memory);
}

TEST(Send, what_is_damaged_or_not_of_this_arm_is_refused_by_name) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  const SignatureRecord& record = identified().record;
  for (const std::size_t byte : {0UL, 5UL, 100UL, kRecordBytes - 1}) {
    RecordImage image = encode(record);
    image[byte] ^= 0x10U;
    EXPECT_TRUE(sent(puma, image).starts_with("error RECORD_CORRUPT")) << byte;
  }
  SignatureRecord other = record;
  other.machine.drawing_crc ^= 1U;
  EXPECT_TRUE(sent(puma, encode(other)).starts_with("error RECORD_OTHER_MACHINE"));
  other = record;
  other.signature.types[2] = JointType::kPrismatic;
  EXPECT_TRUE(sent(puma, encode(other)).starts_with("error RECORD_UNSUITABLE"));
  other = record;
  other.signature.targets.clear();
  EXPECT_TRUE(sent(puma, encode(other)).starts_with("error RECORD_UNSUITABLE"));
  EXPECT_TRUE(puma.ask("candidate").starts_with("error NO_CANDIDATE"));
  EXPECT_EQ(sent(puma, encode(record)), "ok received=candidate");
}

TEST(Send, parts_come_whole_and_in_order) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  const RecordImage image = encode(identified().record);
  EXPECT_TRUE(puma.ask(part_of(image, 2)).starts_with("error OUT_OF_RANGE"));
  ASSERT_EQ(puma.ask(part_of(image, 1)), "ok");
  EXPECT_TRUE(puma.ask(part_of(image, 3)).starts_with("error OUT_OF_RANGE"));
  ASSERT_EQ(puma.ask(part_of(image, 1)), "ok") << "begins anew";
  ASSERT_EQ(puma.ask(part_of(image, 2)), "ok");
  EXPECT_TRUE(puma.ask(part_of(image, 2)).starts_with("error OUT_OF_RANGE"));
  std::string cut = part_of(image, 3);
  cut.pop_back();
  EXPECT_TRUE(puma.ask(cut).starts_with("error RECORD_CORRUPT"));
  cut += "g";
  EXPECT_TRUE(puma.ask(cut).starts_with("error UNKNOWN_REQUEST"));
  for (const char* request : {"send", "send part=1", "send part=1 bytes=x hex=00",
                              "send part=1 bytes=1412 hex=00 more=1", "send part=1 bytes=1412"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error UNKNOWN_REQUEST")) << request;
  }
  EXPECT_TRUE(puma.ask("send part=1 bytes=999999 hex=00").starts_with("error CAPACITY_EXCEEDED"));
  EXPECT_TRUE(puma.ask("send part=1 bytes=10 hex=00").starts_with("error RECORD_CORRUPT"));
  EXPECT_TRUE(puma.ask("send part=nan bytes=1412 hex=00").starts_with("error OUT_OF_RANGE"));
  EXPECT_TRUE(
      puma.ask("send part=one bytes=1412 hex=00").ends_with(" why=\"part needs a number\""));
}

TEST(Send, waits_for_a_sequence_to_be_over_and_survives_a_halt) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const RecordImage image = encode(identified().record);
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(1);
  EXPECT_TRUE(puma.ask(part_of(image, 1)).starts_with("error WRONG_MODE"));
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  ASSERT_EQ(sent(puma, image), "ok received=candidate");
  ASSERT_EQ(puma.ask("compare"), "ok");
  puma.run(2);
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  EXPECT_TRUE(puma.ask("accept").starts_with("error NO_CANDIDATE"));
  EXPECT_EQ(puma.ask("compare"), "ok") << "it need not be sent again";
}

}  // namespace
}  // namespace armsig::controller
