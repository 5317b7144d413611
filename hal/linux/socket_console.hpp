// SPDX-License-Identifier: MIT
// The console on a Unix stream socket.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/console.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::linux_hal {

// Owner and group may connect (0660). Clients are served in turns, a line each; one that does not
// take its replies is disconnected when its buffer is full; one that has said its last line is
// disconnected when each of its lines has its reply. Where every place is taken, a new client gets
// that of the one least missed, which is told so: nobody is kept from stopping an arm by consoles
// left open. Everything is allocated in open().
class SocketConsole final : public hal::Console {
 public:
  static constexpr std::size_t kMaxClients = 8;
  static constexpr std::size_t kReplyBytes = std::size_t{16} * 1024;

  // Listens at `path`, taking the place of a socket that nobody listens at any more. To be called
  // before other threads are started: the file creation mask changes meanwhile.
  // Errors: kAddressOutOfRange (a path too long for a socket), kSystemRefused (somebody listens
  // there, or it is not permitted, or it is not a socket).
  [[nodiscard]] static Result<std::unique_ptr<SocketConsole>> open(const std::string& path);

  ~SocketConsole();
  SocketConsole(const SocketConsole&) = delete;
  SocketConsole& operator=(const SocketConsole&) = delete;

 private:
  struct Client {
    FileDescriptor socket;
    hal::ConsoleClient name = 0;
    std::array<char, hal::kMaxConsoleLine> input{};
    std::size_t input_size = 0;
    bool discarding = false;     // to the end of a line that was too long
    bool ended = false;          // the client will send no more, but may wait for replies
    bool deaf = false;           // the client takes no replies, but what it said before counts
    unsigned unanswered = 0;     // lines handed out that were not replied to
    std::uint64_t spoke_at = 0;  // number of its last line among all lines; 0: it never said one
    std::array<char, kReplyBytes> output{};
    std::size_t output_size = 0;
  };

  SocketConsole(FileDescriptor listener, std::string path)
      : listener_(std::move(listener)), path_(std::move(path)) {}

  std::optional<hal::ConsoleLine> do_read_line() override;
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override;
  void do_broadcast(std::string_view text) override;

  void accept_one();
  [[nodiscard]] Client& place_for_another();
  static void flush(Client& client);
  static bool queue(Client& client, std::string_view text);
  static void close_if_done(Client& client);
  static void receive(Client& client);
  static std::optional<hal::ConsoleLine> extract(Client& client);

  FileDescriptor listener_;
  std::string path_;
  std::array<Client, kMaxClients> clients_;
  std::size_t turn_ = 0;
  hal::ConsoleClient next_name_ = 1;
  std::uint64_t lines_ = 0;
};

}  // namespace armsig::linux_hal
