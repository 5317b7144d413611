// SPDX-License-Identifier: MIT
#include "firmware/linux/places.hpp"

#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "firmware/formats/wrapping.hpp"
#include "firmware/linux/daemon.hpp"

namespace armsig::daemon {
namespace {

enum class Kind : std::uint8_t { kFile, kSocket };

// What the file system tells of `path` now, after it was refused with `error`; `error` in words
// where that tells nothing.
std::string why_not_opened(const std::string& path, Kind as, Error error) {
  namespace fs = std::filesystem;
  constexpr std::size_t kLongestSocket = sizeof(sockaddr_un::sun_path) - 1;
  if (as == Kind::kSocket && path.size() > kLongestSocket) {
    return fmt::format("the path of a socket has at most {} bytes, this one {}", kLongestSocket,
                       path.size());
  }
  std::error_code failed;
  const fs::path folder = fs::path(path).parent_path();
  const std::string in = folder.empty() ? "." : folder.string();
  if (!fs::is_directory(in, failed)) return fmt::format("the folder {} is not there", in);
  const fs::file_status there = fs::status(path, failed);
  if (fs::is_directory(there)) return "a folder is there";
  if (!fs::exists(there)) {
    return ::access(in.c_str(), W_OK | X_OK) == 0
               ? std::string(describe(error))
               : fmt::format("this user may not write in the folder {}", in);
  }
  if (as == Kind::kSocket && !fs::is_socket(there)) return "what is there is no socket";
  if (::access(path.c_str(), R_OK | W_OK) != 0) return "this user may not read and write it";
  if (error == Error::kSystemRefused) return "in use: is another armsigd running?";
  return std::string(describe(error));
}

void complain(const std::string& path, Kind as, Error error) {
  fmt::print(stderr, "{}",
             tool::for_standard_error(
                 fmt::format("armsigd: {}: {}", path, why_not_opened(path, as, error))));
}

}  // namespace

std::optional<Places> open_places(const DaemonConfiguration& configuration) {
  auto store = linux_hal::FileMemory::open(configuration.store, kStoreLayout, kStoreSpread);
  if (!store) {
    complain(configuration.store, Kind::kFile, store.error());
    return std::nullopt;
  }
  auto console = linux_hal::SocketConsole::open(configuration.console);
  if (!console) {
    complain(configuration.console, Kind::kSocket, console.error());
    return std::nullopt;
  }
  Places places{std::move(*store), std::move(*console), nullptr};
  if (configuration.reporting_console.empty()) return places;
  auto reporting = linux_hal::SocketConsole::open(configuration.reporting_console);
  if (!reporting) {
    complain(configuration.reporting_console, Kind::kSocket, reporting.error());
    return std::nullopt;
  }
  places.reporting = std::move(*reporting);
  return places;
}

}  // namespace armsig::daemon
