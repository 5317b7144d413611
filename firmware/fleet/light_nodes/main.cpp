// SPDX-License-Identifier: MIT
// armsig-light-nodes: many cabinets in one process, each with the journal, state machine, TLS
// connection and certificate of a real one, and rows that are made up. For toolchain/fleet.
//   armsig-light-nodes run FOLDER PORT FIRST COUNT ROWS_PER_SECOND UNTIL_UNIX_S DAY_ROWS
//     FOLDER has authority.crt, nodes/arm-N.crt and .key; journals are nodes/arm-N.journal.
//     A new journal begins with two signatures and DAY_ROWS rows of the last day, as if nobody had
//     listened. Ends when every row is acknowledged after that time; status 1 where that takes 120
//     s.
//   armsig-light-nodes list FOLDER FIRST COUNT
//     "node,journal,number" of every row that the journals hold; status 1 where one lost any.
#include <sys/epoll.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/fleet/light_nodes/cabinet.hpp"
#include "firmware/fleet/node/controller_lines.hpp"
#include "firmware/fleet/node/sha256.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kTick_ms = 20;
constexpr std::uint64_t kMisc_ms = 1'000;
constexpr std::uint64_t kDrain_ms = 120'000;
constexpr std::uint64_t kDay_ms = 86'400'000;

volatile std::sig_atomic_t stop_asked = 0;

Now now() {
  const auto ms = [](auto since) {
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
  };
  return {.steady_ms = ms(std::chrono::steady_clock::now().time_since_epoch()),
          .utc_ms = ms(std::chrono::system_clock::now().time_since_epoch())};
}

class Fleet {
 public:
  Fleet(const std::string& folder, int port, int first, int count, double rate,
        std::uint64_t day_rows)
      : rate_(rate), epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
    std::mt19937_64 random(std::random_device{}());
    for (int i = 0; i < count; ++i) {
      cabinets_.push_back(std::make_unique<Cabinet>(folder, port, name_of(first + i), random));
      cabinets_.back()->owed = -std::uniform_real_distribution<>(0, 1)(random);
      if (cabinets_.back()->journal.last() == 0) tell_past(*cabinets_.back(), day_rows);
    }
  }

  // True: all rows were acknowledged in time.
  bool run(std::uint64_t until_ms) {
    std::uint64_t before = now().steady_ms;
    for (;;) {
      const Now time = now();
      const bool making = time.utc_ms < until_ms && stop_asked == 0;
      wait();
      for (auto& cabinet : cabinets_) {
        if (making) make_rows(*cabinet, time, static_cast<double>(time.steady_ms - before) * 1e-3);
        attend(*cabinet, time);
      }
      before = time.steady_ms;
      if (making) continue;
      if (all_acknowledged()) return true;
      if (time.utc_ms > until_ms + kDrain_ms || stop_asked != 0) return false;
    }
  }

  void leave() {
    for (auto& cabinet : cabinets_) cabinet->node.leave(now());
  }

 private:
  double noise() { return std::normal_distribution<>(0, 0.02)(noise_); }

  void make_rows(Cabinet& cabinet, const Now& time, double seconds) {
    cabinet.owed += rate_ * seconds;
    while (cabinet.owed >= 1) {
      make_row(cabinet, time);
      cabinet.owed -= 1;
    }
  }

  // One in ten is a check, as a cabinet also tells temperatures and modes.
  void make_row(Cabinet& cabinet, const Now& time) {
    if (++made_ % 10 == 0) {
      keep(cabinet, time,
           std::array{Reading{Item::kVerdict, Text("as accepted")},
                      Reading{Item::kResidualX, noise()}, Reading{Item::kResidualY, noise()},
                      Reading{Item::kResidualZ, noise()}, Reading{Item::kCheckSigma, 0.02},
                      Reading{Item::kCheckPoses, 20UL}});
    } else {
      keep(cabinet, time,
           std::array{Reading{Item::kLatenessMax, 20 + noise()},
                      Reading{Item::kMode, Text("servoing")}});
    }
  }

  static void keep(Cabinet& cabinet, const Now& time, std::span<const Reading> readings) {
    if (!cabinet.node.record(time, readings)) throw std::runtime_error("a row was not kept");
  }

  // A signature of a day ago, rows of the day, and the signature of now.
  void tell_past(Cabinet& cabinet, std::uint64_t day_rows) {
    Now time = now();
    const std::uint64_t day_ago_ms = time.utc_ms - kDay_ms;
    tell_signature(cabinet, {.steady_ms = time.steady_ms, .utc_ms = day_ago_ms});
    for (std::uint64_t i = 0; i < day_rows; ++i) {
      make_row(cabinet, {.steady_ms = time.steady_ms,
                         .utc_ms = day_ago_ms + (i + 1) * kDay_ms / (day_rows + 1)});
    }
    tell_signature(cabinet, time);
  }

  // A PUMA 560 with errors of its own.
  void tell_signature(Cabinet& cabinet, const Now& time) {
    constexpr std::array<std::array<double, 4>, 6> kPuma{{{0, 0, 0, -90},
                                                          {0, 149.09, 431.8, 0},
                                                          {90, 0, -20.32, 90},
                                                          {0, 433.07, 0, -90},
                                                          {0, 0, 0, 90},
                                                          {0, 56.25, 0, 0}}};
    std::string document;
    for (std::size_t i = 0; i < kPuma.size(); ++i) {
      const auto& row = kPuma[i];
      const std::string n = std::to_string(i + 1);
      document += (i > 0 ? " theta" : "theta") + n + "_deg=" + std::to_string(row[0] + noise());
      document += " d" + n + "_mm=" + std::to_string(row[1] + 5 * noise());
      document += " a" + n + "_mm=" + std::to_string(row[2] + 5 * noise());
      document += " alpha" + n + "_deg=" + std::to_string(row[3] + noise());
    }
    for (const Readings& part : readings_of_document(document)) {
      keep(cabinet, time, {part.data(), part.size()});
    }
    keep(cabinet, time,
         std::array{Reading{Item::kModel, Text("signature")},
                    Reading{Item::kSignatureHash, Text(sha256(document))},
                    Reading{Item::kSignatureDate, time.utc_ms},
                    Reading{Item::kPredicted, 0.08 + std::abs(noise())},
                    Reading{Item::kPredictedRegion, Text("limits")},
                    Reading{Item::kValidation, 0.1 + std::abs(noise())},
                    Reading{Item::kValidationPoses, 20UL}, Reading{Item::kAir, 20 + 50 * noise()}});
  }

  void wait() {
    std::array<epoll_event, 256> events{};
    const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()),
                                   static_cast<int>(kTick_ms));
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = events[static_cast<std::size_t>(i)];
      auto* cabinet = static_cast<Cabinet*>(event.data.ptr);
      cabinet->transport.connection().service((event.events & ~EPOLLOUT) != 0,
                                              (event.events & EPOLLOUT) != 0);
    }
  }

  void attend(Cabinet& cabinet, const Now& time) {
    MqttConnection& connection = cabinet.transport.connection();
    if (time.steady_ms - cabinet.misc_ms >= kMisc_ms) {
      cabinet.misc_ms = time.steady_ms;
      connection.service(false, false);
    }
    cabinet.transport.deliver(cabinet.node, time);
    cabinet.node.tick(time);
    watch(cabinet);
  }

  void watch(Cabinet& cabinet) {
    const int descriptor = cabinet.transport.connection().descriptor();
    const bool write = cabinet.transport.connection().wants_write();
    epoll_event event{};
    event.events = write ? EPOLLIN | EPOLLOUT : EPOLLIN;
    event.data.ptr = &cabinet;
    // A descriptor that was closed is no longer watched, and its number may be another's by now.
    if (descriptor >= 0 && (descriptor != cabinet.watched || write != cabinet.watched_write)) {
      if (::epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, descriptor, &event) != 0) {
        (void)::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, descriptor, &event);
      }
    }
    cabinet.watched = descriptor;
    cabinet.watched_write = write;
  }

  [[nodiscard]] bool all_acknowledged() const {
    for (const auto& cabinet : cabinets_) {
      if (cabinet->journal.acknowledged() != cabinet->journal.last()) return false;
    }
    return true;
  }

  double rate_;
  linux_hal::FileDescriptor epoll_;
  std::vector<std::unique_ptr<Cabinet>> cabinets_;
  std::mt19937_64 noise_{1};
  std::uint64_t made_ = 0;
};

int list(const std::string& folder, int first, int count) {
  int status = 0;
  for (int i = first; i < first + count; ++i) {
    FileStorage storage = storage_of(folder, name_of(i));
    Journal journal = journal_of(storage, 1);
    if (journal.dropped() != 0) status = 1;
    std::uint64_t number = 0;
    for (std::uint64_t n = 0; n <= kSlots; ++n) {
      const auto row = journal.after(number);
      if (!row || !*row) break;
      number = (*row)->number;
      std::printf("%s,%lld,%llu\n", name_of(i).c_str(), static_cast<long long>(journal.name()),
                  static_cast<unsigned long long>(number));
    }
  }
  return status;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 4 && words[0] == "list") {
    return list(words[1], std::stoi(words[2]), std::stoi(words[3]));
  }
  if (words.size() != 8 || words[0] != "run") {
    std::fputs("see the head of firmware/fleet/light_nodes/main.cpp\n", stderr);
    return 2;
  }
  Fleet fleet(words[1], std::stoi(words[2]), std::stoi(words[3]), std::stoi(words[4]),
              std::stod(words[5]), std::stoull(words[7]));
  const bool all = fleet.run(1'000 * std::stoull(words[6]));
  fleet.leave();
  return all ? 0 : 1;
}

}  // namespace
}  // namespace armsig::fleet

int main(int argc, char** argv) {
  const auto ask = [](int) { armsig::fleet::stop_asked = 1; };
  std::signal(SIGTERM, ask);
  std::signal(SIGINT, ask);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return armsig::fleet::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "armsig-light-nodes: %s\n", error.what());
    return 1;
  }
}
