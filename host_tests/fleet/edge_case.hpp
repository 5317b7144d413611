// SPDX-License-Identifier: MIT
// An edge node on a broker that is a list of what it was asked.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/fleet/node/edge_node.hpp"

namespace armsig::fleet::test {

struct RamStorage final : Storage {
  std::vector<std::byte> bytes;
  bool full = false;

 private:
  Result<void> do_read(std::uint64_t at, std::span<std::byte> to) override {
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = at + i < bytes.size() ? bytes[at + i] : std::byte{0};
    }
    return {};
  }
  Result<void> do_write(std::uint64_t at, std::span<const std::byte> from) override {
    if (full) return std::unexpected(Error::kStorageFull);
    if (bytes.size() < at + from.size()) bytes.resize(at + from.size());
    std::memcpy(bytes.data() + at, from.data(), from.size());
    return {};
  }
  Result<void> do_sync() override { return {}; }
};

struct Published {
  std::string topic;
  std::vector<std::byte> payload;
  int qos = 0;
};

struct Broker final : Transport {
  std::vector<std::string> calls;  // in their order: "connect", "subscribe TOPIC", the topic, ...
  std::vector<Published> published;
  std::vector<Published> wills;
  bool takes = true;

 private:
  void do_connect(const Will& will) override {
    calls.emplace_back("connect");
    wills.push_back({std::string(will.topic), {will.payload.begin(), will.payload.end()}, 1});
  }
  void do_subscribe(std::string_view topic, int qos) override {
    calls.push_back("subscribe " + std::string(topic) + " at " + std::to_string(qos));
  }
  bool do_publish(std::string_view topic, std::span<const std::byte> payload, int qos) override {
    if (!takes) return false;
    calls.emplace_back(topic);
    published.push_back({std::string(topic), {payload.begin(), payload.end()}, qos});
    return true;
  }
  void do_disconnect() override { calls.emplace_back("disconnect"); }
};

class EdgeCase : public testing::Test {
 protected:
  static constexpr std::uint64_t kName = 0xFEDCBA9876543210;
  static constexpr const char* kBirth = "spBv1.0/plant/NBIRTH/arm-1";
  static constexpr const char* kData = "spBv1.0/plant/NDATA/arm-1";
  static constexpr const char* kDeath = "spBv1.0/plant/NDEATH/arm-1";
  static constexpr const char* kCommand = "spBv1.0/plant/NCMD/arm-1";
  static constexpr const char* kState = "spBv1.0/STATE/fleet";

  EdgeSettings settings{.group = "plant", .node = "arm-1", .host = "fleet"};
  RamStorage storage;
  Journal journal = *Journal::open(storage, 1024, kName);
  Broker broker;
  EdgeNode node{settings, journal, broker, 1};
  Now now{.steady_ms = 1'000'000, .utc_ms = 1'700'000'000'000};

  void wait(std::uint64_t ms) {
    now.steady_ms += ms;
    now.utc_ms += ms;
    node.tick(now);
  }
  void wait_long(int seconds) {
    for (int i = 0; i < 10 * seconds; ++i) wait(100);
  }
  void tell(const char* topic, std::span<const std::byte> payload) {
    node.message(now, topic, payload);
  }
  void host(const std::string& state) { tell(kState, std::as_bytes(std::span(state))); }
  void online() { host(R"({"online":true,"timestamp":)" + std::to_string(now.utc_ms) + "}"); }
  void offline() { host(R"({"online":false,"timestamp":)" + std::to_string(now.utc_ms) + "}"); }
  void acknowledge(std::uint64_t number, std::uint64_t name = kName) {
    const Payload payload = encode_acknowledgement(now.utc_ms, name, number);
    tell(kCommand, {payload.data(), payload.size()});
  }
  void ask_rebirth() {
    const Payload payload = encode_rebirth(now.utc_ms);
    tell(kCommand, {payload.data(), payload.size()});
  }
  void connect() {
    for (int i = 0; i < 2'000 && node.state() == EdgeNode::State::kApart; ++i) wait(100);
    ASSERT_EQ(node.state(), EdgeNode::State::kConnecting);
    node.connected(now, true);
  }
  void be_born() {
    connect();
    online();
    ASSERT_EQ(node.state(), EdgeNode::State::kBorn);
  }
  void row(double x) {
    const Reading reading{Item::kResidualX, x};
    ASSERT_TRUE(node.record(now, {&reading, 1}));
  }
  std::vector<Report> sent(const std::string& topic) const {
    std::vector<Report> reports;
    for (const Published& message : broker.published) {
      if (message.topic != topic) continue;
      const auto report = decode_report(message.payload);
      EXPECT_TRUE(report);
      if (report) reports.push_back(*report);
    }
    return reports;
  }
  std::vector<std::uint64_t> numbers_sent() const {
    std::vector<std::uint64_t> numbers;
    for (const Report& report : sent(kData)) {
      numbers.push_back(report.integer(Item::kNumber).value_or(0));
    }
    return numbers;
  }
};

}  // namespace armsig::fleet::test
