// SPDX-License-Identifier: MIT
// armsig-node: reports one cabinet to the plant's host. It reads the controller's console and
// speaks MQTT; nothing leads from there to the servo.
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error_name.hpp"
#include "firmware/fleet/journal/file_storage.hpp"
#include "firmware/fleet/node/configuration.hpp"
#include "firmware/fleet/node/console_link.hpp"
#include "firmware/fleet/node/controller_lines.hpp"
#include "firmware/fleet/node/mqtt_transport.hpp"
#include "firmware/fleet/node/record_fetch.hpp"
#include "firmware/fleet/node/resident_memory.hpp"
#include "firmware/fleet/program.hpp"
#include "firmware/formats/wrapping.hpp"

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kSignatureEvery = 60;  // looks at the controller
constexpr std::uint64_t kAnswer_ms = 5'000;    // within which it answers, or is told to be silent
constexpr int kBusy_ms = 50;
constexpr int kQuiet_ms = 250;
constexpr std::uint64_t kSettled_ms = 3'000;  // after a birth; then what led to it is let go of

Now now() {
  const auto ms = [](auto since) {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
  };
  return {.steady_ms = ms(std::chrono::steady_clock::now().time_since_epoch()),
          .utc_ms = ms(std::chrono::system_clock::now().time_since_epoch())};
}

std::uint64_t random_bits() {
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

class Reporter {
 public:
  Reporter(const NodeConfiguration& configuration, Journal& journal)
      : configuration_(configuration),
        journal_(journal),
        transport_(configuration.broker, configuration.edge.node),
        node_(configuration.edge, journal, transport_, random_bits()),
        console_(configuration.console) {}

  void run() {
    tell_identity();
    let_go_of_start();
    while (stop_asked == 0) step();
    node_.leave(now());
  }

 private:
  void step() {
    MqttConnection& connection = transport_.connection();
    // A line of the controller or of the broker ends the wait anyway; rows under way are timed.
    const bool idle =
        node_.state() != EdgeNode::State::kBorn || journal_.acknowledged() == journal_.last();
    std::array<pollfd, 2> ready{
        pollfd{.fd = connection.descriptor(), .events = POLLIN, .revents = 0},
        pollfd{.fd = console_.descriptor(), .events = POLLIN, .revents = 0}};
    if (connection.wants_write()) ready[0].events |= POLLOUT;
    (void)::poll(ready.data(), ready.size(), idle ? kQuiet_ms : kBusy_ms);
    connection.service((ready[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0,
                       (ready[0].revents & POLLOUT) != 0);
    const Now time = now();
    transport_.deliver(node_, time);
    look(time);
    node_.tick(time);
    transport_.deliver(node_, time);
    settle(time);
  }

  // After each step on the way to a birth, and once more when what follows one is over.
  void settle(const Now& time) {
    if (node_.state() != state_) {
      state_ = node_.state();
      settled_ = false;
      born_ms_ = time.steady_ms;
      let_go_of_start();
    } else if (state_ == EdgeNode::State::kBorn && !settled_ &&
               time.steady_ms - born_ms_ >= kSettled_ms) {
      settled_ = true;
      let_go_of_start();
    }
  }

  void keep(const Readings& readings, const Now& time) {
    const auto kept = node_.report(time, {readings.data(), readings.size()});
    if (!kept) tell_once(kept.error());
  }

  void keep_together(const Readings& readings, const Now& time) {
    const auto kept = node_.report_together(time, {readings.data(), readings.size()});
    if (!kept) tell_once(kept.error());
  }

  // Another signature is told whole, its document before it, once that is there; what is as before
  // only if it changed.
  void take_signature(std::string_view line, const Readings& signature, const Now& time) {
    const std::string_view rows = document_of_signature(line);
    if (rows.empty()) {
      told_signature_.clear();
      keep_together(signature, time);
    } else if (line == told_signature_) {
      keep_together(with_hash(signature, fetch_.document()), time);
    } else {
      told_signature_.clear();
      asked_signature_ = line;
      fetch_.begin(rows, number_of(signature));
      console_.ask_record(fetch_.part());
    }
  }

  static std::uint64_t number_of(const Readings& signature) {
    const auto* const found = std::ranges::find(signature.begin(), signature.end(),
                                                Item::kSignatureNumber, &Reading::item);
    const auto* const number =
        found != signature.end() ? std::get_if<std::uint64_t>(&found->value) : nullptr;
    return number != nullptr ? *number : 0;
  }

  void take_record(const Now& time) {
    if (fetch_.state() == RecordFetch::State::kAsks) return console_.ask_record(fetch_.part());
    if (fetch_.state() == RecordFetch::State::kOther) {
      changed_ = true;  // asked for at the next look
      return;
    }
    std::vector<Readings> rows = readings_of_document(fetch_.document());
    rows.push_back(with_hash(readings_of_signature(asked_signature_), fetch_.document()));
    for (const Readings& row : rows) {
      const auto kept = node_.record(time, {row.data(), row.size()});
      if (!kept) return tell_once(kept.error());
    }
    told_signature_ = asked_signature_;
  }

  // A disk that is full is told once, not every ten seconds for a month.
  void tell_once(Error error) {
    if (told_ == error) return;
    told_ = error;
    std::fprintf(stderr, "armsig-node: the journal takes no row: %.*s\n",
                 static_cast<int>(describe(error).size()), describe(error).data());
  }

  void tell_identity() {
    Readings readings;
    readings.push_back({Item::kArm, Text(configuration_.edge.node)});
    if (!configuration_.serial.empty()) {
      readings.push_back({Item::kSerial, Text(configuration_.serial)});
    }
    readings.push_back({Item::kFirmware, Text(ARMSIG_VERSION)});
    keep(readings, now());
  }

  void look(const Now& time) {
    while (auto line = console_.take_line()) take(*line, time);
    if (time.steady_ms >= due_ms_) {
      due_ms_ = time.steady_ms + configuration_.period_ms;
      if (console_.open()) {
        console_.ask(ConsoleLink::Request::kStatus);
        if (looks_++ % kSignatureEvery == 0 || changed_) {
          console_.ask(ConsoleLink::Request::kSignature);
          changed_ = false;
        }
      }
    }
    if (time.steady_ms >= heard_ms_ + configuration_.period_ms + kAnswer_ms) {
      heard_ms_ = time.steady_ms;
      looks_ = 0;
      Readings silent;
      silent.push_back({Item::kMode, Text("silent")});
      keep(silent, time);
    }
  }

  void take(std::string_view line, const Now& time) {
    if (const Readings status = readings_of_status(line); !status.empty()) {
      heard_ms_ = time.steady_ms;
      keep(status, time);
    } else if (const Readings signature = readings_of_signature(line); !signature.empty()) {
      take_signature(line, signature, time);
    } else if (fetch_.take(line)) {
      take_record(time);
    } else if (const Readings check = readings_of_check(line); !check.empty()) {
      const auto kept = node_.record(time, {check.data(), check.size()});
      if (!kept) tell_once(kept.error());
    } else if (line.starts_with("# mode")) {
      due_ms_ = time.steady_ms;  // at once, and the signature may be another one
      changed_ = true;
    }
  }

  const NodeConfiguration& configuration_;
  Journal& journal_;
  MqttTransport transport_;
  EdgeNode node_;
  ConsoleLink console_;
  std::uint64_t due_ms_ = 0;
  std::uint64_t heard_ms_ = now().steady_ms;
  std::uint64_t looks_ = 0;
  bool changed_ = false;
  EdgeNode::State state_ = EdgeNode::State::kApart;
  bool settled_ = false;
  std::uint64_t born_ms_ = 0;
  RecordFetch fetch_;
  std::string asked_signature_;  // the reply that fetch_ is of
  std::string told_signature_;   // the one that was told last
  Error told_ = Error::kNotFinite;
};

int run(const char* path, bool check_only) {
  const auto configuration = read_node_configuration(path);
  if (!configuration) {
    std::fputs(
        tool::for_standard_error("armsig-node: " + tool::render(configuration.error())).c_str(),
        stderr);
    return kWrongUsage;
  }
  if (check_only) {
    std::printf("%s/%s reports to %s by %s:%d\n", configuration->edge.group.c_str(),
                configuration->edge.node.c_str(), configuration->edge.host.c_str(),
                configuration->broker.address.c_str(), configuration->broker.port);
    return 0;
  }
  auto storage = FileStorage::open(
      configuration->journal, Journal::kFirstSlotAt + configuration->slots * Journal::kSlotSize);
  if (!storage) {
    std::fprintf(stderr, "armsig-node: %s: %s\n", configuration->journal.c_str(),
                 std::string(describe(storage.error())).c_str());
    return 1;
  }
  auto journal = Journal::open(*storage, configuration->slots, random_bits());
  if (!journal) {
    std::fprintf(stderr, "armsig-node: %s: %s\n", configuration->journal.c_str(),
                 std::string(describe(journal.error())).c_str());
    return 1;
  }
  Reporter(*configuration, *journal).run();
  return 0;
}

}  // namespace
}  // namespace armsig::fleet

int main(int argc, char** argv) {
  return armsig::fleet::run_program("armsig-node", ARMSIG_VERSION, argc, argv, armsig::fleet::run);
}
