// SPDX-License-Identifier: MIT
#include "firmware/fleet/light_nodes/cabinet.hpp"

#include <stdexcept>
#include <utility>

namespace armsig::fleet {
namespace {

BrokerSettings broker_of(const std::string& folder, int port, const std::string& name) {
  const std::string own = folder + "/nodes/" + name;
  return {.address = "127.0.0.1",
          .port = port,
          .authority = folder + "/authority.crt",
          .certificate = own + ".crt",
          .key = own + ".key"};
}

}  // namespace

std::string name_of(int number) { return "arm-" + std::to_string(number); }

FileStorage storage_of(const std::string& folder, const std::string& name) {
  auto storage = FileStorage::open(folder + "/nodes/" + name + ".journal",
                                   Journal::kFirstSlotAt + kSlots * Journal::kSlotSize);
  if (!storage) throw std::runtime_error(name + ": no journal");
  return *std::move(storage);
}

Journal journal_of(Storage& storage, std::uint64_t random) {
  auto journal = Journal::open(storage, kSlots, random);
  if (!journal) throw std::runtime_error("a journal can't be read");
  return *std::move(journal);
}

Cabinet::Cabinet(const std::string& folder, int port, const std::string& name,
                 std::mt19937_64& random)
    : storage(storage_of(folder, name)),
      journal(journal_of(storage, random())),
      transport(broker_of(folder, port, name), name),
      node({.group = "plant",
            .node = name,
            .host = "fleet",
            .rows_per_second = 200,
            .answer_timeout_ms = 3'000,
            .longest_timeout_ms = 10'000,
            .longest_reconnect_ms = 5'000},
           journal, transport, random()) {}

}  // namespace armsig::fleet
