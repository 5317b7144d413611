// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_page.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/core.h>

#include "firmware/host_tool/console/web_server.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::tool {
namespace {

bool is_token(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == 32 && std::ranges::all_of(text, is_digit);
}

Problem refused(const std::string& file, const char* what) {
  return {file, 0, 0, what, "a file of `--token-file`, which only you can read, or none yet"};
}

// The token that `file` keeps; a new one, kept there, where there is no such file.
Read<std::string> token_of(const std::string& file) {
  if (file.empty()) return random_token();
  constexpr mode_t kOwnerOnly = 0600;
  const linux_hal::FileDescriptor made(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly));
  if (made.valid()) {
    std::string token = random_token();
    const auto written = ::write(made.get(), token.data(), token.size());
    if (written == static_cast<ssize_t>(token.size())) return token;
    return std::unexpected(refused(file, std::strerror(errno)));
  }
  // What others may have written or read is no key; a device or a pipe would wait.
  const linux_hal::FileDescriptor kept(
      ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status{};
  if (!kept.valid() || ::fstat(kept.get(), &status) != 0) {
    return std::unexpected(refused(file, std::strerror(errno)));
  }
  if (!S_ISREG(status.st_mode)) return std::unexpected(refused(file, "no file"));
  if (status.st_uid != ::geteuid()) {
    return std::unexpected(refused(file, "it belongs to another user"));
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return std::unexpected(refused(file, "others may read or write it: remove it for a new key"));
  }
  std::array<char, 64> text{};
  const ssize_t size = ::read(kept.get(), text.data(), text.size());
  if (size < 0) return std::unexpected(refused(file, std::strerror(errno)));
  const std::string_view token(text.data(), static_cast<std::size_t>(size));
  if (!is_token(token)) return std::unexpected(refused(file, "no token"));
  return std::string(token);
}

}  // namespace

Problem serve_web_page(const WebPageOptions& options) {
  const auto token = token_of(options.token_file);
  if (!token) return token.error();
  WebBoard board;
  WebWatch watch(options.console, board);
  WebServer server(*token, board, watch);
  if (!server.bind(options.port)) {
    return {"--web", 0, 0, fmt::format("port {} of this computer is taken", options.port),
            "another port, or none"};
  }
  say("{}\nThe address is a key: who has it can move the arm. Ctrl-C ends.\n", server.address());
  (void)std::fflush(stdout);
  server.serve();
  return {"--web", 0, 0, "the server has ended", "a computer with a loopback"};
}

}  // namespace armsig::tool
