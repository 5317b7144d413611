// SPDX-License-Identifier: MIT
// A check of the real controller, from its console line to the broker: the line is the one that the
// controller writes, about an emulated arm.
#include <algorithm>
#include <optional>

#include "firmware/fleet/host/signature_comparison.hpp"
#include "firmware/fleet/node/controller_lines.hpp"
#include "firmware/fleet/wire/signature_document.hpp"
#include "host_tests/fleet/edge_case.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::fleet::test {
namespace {

using armsig::test::PumaCabinet;

// What the controller says at the end of a check, in which the sensor does that.
std::string verdict_of(PumaCabinet& puma, std::optional<Error> of_sensor = {}) {
  const std::size_t before = puma.console.told.size();
  EXPECT_EQ(puma.ask("check"), "ok");
  puma.cabinet->sensor().set_error(of_sensor);
  for (int i = 0; i < 3000; ++i) {
    puma.run(0.1);
    for (std::size_t k = before; k < puma.console.told.size(); ++k) {
      if (!readings_of_check(puma.console.told[k]).empty()) return puma.console.told[k];
    }
  }
  return "";
}

class FleetCheck : public EdgeCase {
 protected:
  // The report of the row that the node makes of the line.
  Report published(const std::string& line) {
    const Readings readings = readings_of_check(line);
    EXPECT_TRUE(node.record(now, {readings.data(), readings.size()}));
    wait_long(2);
    const auto reports = sent(kData);
    return reports.empty() ? Report{} : reports.back();
  }
  static std::string text(const Report& report, Item item) {
    for (const Reading& reading : report.readings) {
      const auto* value = std::get_if<Text>(&reading.value);
      if (reading.item == item && value != nullptr) return std::string(value->view());
    }
    return "";
  }
  static std::size_t numbers(const Report& report) {
    return static_cast<std::size_t>(std::ranges::count_if(
        report.readings,
        [](const Reading& reading) { return std::holds_alternative<double>(reading.value); }));
  }
};

TEST_F(FleetCheck, VerdictsOfTheRealControllerReachTheBroker) {
  be_born();
  PumaCabinet puma;
  ASSERT_TRUE(armsig::test::identify_and_accept(puma));
  const std::string sound = verdict_of(puma);
  Report report = published(sound);
  EXPECT_EQ(text(report, Item::kVerdict), "as accepted") << sound;
  EXPECT_EQ(report.integer(Item::kCheckPoses), 16U) << sound;
  EXPECT_EQ(numbers(report), 4U) << "dx, dy, dz and sigma of " << sound;

  puma.cabinet->arm().arm.joints[1].a_m += 2e-3;
  report = published(verdict_of(puma));
  EXPECT_EQ(text(report, Item::kVerdict), "stepped");

  const std::string failed = verdict_of(puma, Error::kSensorStale);
  report = published(failed);
  EXPECT_TRUE(text(report, Item::kVerdict).starts_with("could not measure: ")) << failed;
  EXPECT_EQ(numbers(report), 0U);
}

TEST_F(FleetCheck, SignatureOfTheRealControllerComesAsItsDocument) {
  be_born();
  PumaCabinet puma;
  ASSERT_TRUE(armsig::test::identify_and_accept(puma));
  const std::string line = puma.ask("signature");
  const std::string_view document = document_of_signature(line);
  for (const Readings& part : readings_of_document(document)) {
    ASSERT_TRUE(node.record(now, {part.data(), part.size()}));
  }
  wait_long(2);
  std::string together;
  for (const Report& report : sent(kData)) together += text(report, Item::kDocumentText);
  EXPECT_EQ(together, document);
  const auto read = read_signature_document(together);
  ASSERT_TRUE(read) << line;
  EXPECT_EQ(read->arm.joints.size(), 6U);
  const auto compared = compare_signatures(together, together);
  ASSERT_TRUE(compared);
  EXPECT_LT(compared->tool_rms_m, 1e-8);
}

}  // namespace
}  // namespace armsig::fleet::test
