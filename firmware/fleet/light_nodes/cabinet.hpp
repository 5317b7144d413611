// SPDX-License-Identifier: MIT
// One of the cabinets of armsig-light-nodes: what a real one has to report it.
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "firmware/fleet/journal/file_storage.hpp"
#include "firmware/fleet/node/mqtt_transport.hpp"

namespace armsig::fleet {

inline constexpr std::uint64_t kSlots = 2048;  // of each journal

[[nodiscard]] std::string name_of(int number);

// Throw where they cannot be had. `random` names a new journal.
[[nodiscard]] FileStorage storage_of(const std::string& folder, const std::string& name);
[[nodiscard]] Journal journal_of(Storage& storage, std::uint64_t random);

struct Cabinet {
  Cabinet(const std::string& folder, int port, const std::string& name, std::mt19937_64& random);

  FileStorage storage;
  Journal journal;
  MqttTransport transport;
  EdgeNode node;
  int watched = -1;  // descriptor in epoll
  bool watched_write = false;
  std::uint64_t misc_ms = 0;
  double owed = 0;  // rows
};

}  // namespace armsig::fleet
