// SPDX-License-Identifier: MIT
// armsig connect: the controller's console, for a person and for a script.
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/fetch.hpp"
#include "firmware/host_tool/commands/send.hpp"
#include "firmware/host_tool/console/console_client.hpp"
#include "firmware/host_tool/console/line_editor.hpp"
#include "firmware/host_tool/console/web_start.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;

struct ConnectOptions {
  std::string path;
  double timeout_s = 60;
  std::string action;
  FetchOptions fetch;
  bool web = false;
  int port = 0;
  std::string token_file;

  [[nodiscard]] milliseconds longest() const {
    return milliseconds(static_cast<milliseconds::rep>(1e3 * timeout_s));
  }
};

// --- For a script: a request a line, its reply, the next ---------------------------------------

// Replies go to standard output, what the controller says unasked to standard error.
int talk_for_a_script(ConsoleClient& console, const ConnectOptions& options) {
  const milliseconds longest = options.longest();
  bool good = true;
  for (std::string request; std::getline(std::cin, request);) {
    if (request.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (!console.send(request)) break;
    for (bool replied = false; !replied;) {
      const auto line = console.receive(longest);
      if (!line && console.gone()) break;
      if (!line) {
        say(stderr, "armsig connect: no reply to \"{}\" within {} s\n", request, options.timeout_s);
        return kNoAnswer;
      }
      replied = is_reply(*line);
      say(replied ? stdout : stderr, "{}\n", *line);
      std::fflush(stdout);
      good = good && !is_error(*line);
    }
    if (console.gone()) break;
  }
  if (console.gone()) say(stderr, "armsig connect: the controller closed the console\n");
  return good && !console.gone() ? kDone : kNoAnswer;
}

// --- For a person: history, and what the controller says while one types -------------------------

class RawTerminal {
 public:
  RawTerminal() {
    ::tcgetattr(STDIN_FILENO, &former_);
    termios raw = former_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN);
    raw.c_iflag &= ~static_cast<tcflag_t>(IXON | ICRNL);
    raw.c_cc[VMIN] = 1;
    raw.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  ~RawTerminal() { ::tcsetattr(STDIN_FILENO, TCSANOW, &former_); }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

 private:
  termios former_{};
};

constexpr std::string_view kPrompt = "armsig> ";
constexpr std::string_view kClearLine = "\r\033[K";

void draw(const LineEditor& editor) {
  fmt::print("{}{}{}\r\033[{}C", kClearLine, kPrompt, editor.text(),
             kPrompt.size() + editor.cursor());
  std::fflush(stdout);
}

// False when the person wants to leave.
bool take_keys(ConsoleClient& console, LineEditor& editor) {
  constexpr char kEndOfInput = 0x04;  // Ctrl-D
  std::array<char, 256> keys{};
  const ssize_t count = ::read(STDIN_FILENO, keys.data(), keys.size());
  if (count <= 0) return false;
  for (ssize_t i = 0; i < count; ++i) {
    const char key = keys[static_cast<std::size_t>(i)];
    if (key == kEndOfInput && editor.text().empty()) return false;
    const auto line = editor.key(key);
    if (!line) continue;
    fmt::print("{}{}{}\n", kClearLine, kPrompt, shown(*line));
    if (*line == "quit" || *line == "exit") return false;
    if (!line->empty() && !console.send(*line)) return true;
  }
  return true;
}

int talk_to_a_person(ConsoleClient& console) {
  const RawTerminal raw;
  LineEditor editor;
  fmt::print("Connected. `help` lists the requests, `quit` or Ctrl-D leaves.\n");
  draw(editor);
  for (;;) {
    std::array<pollfd, 2> ready{pollfd{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0},
                                pollfd{.fd = console.descriptor(), .events = POLLIN, .revents = 0}};
    if (::poll(ready.data(), ready.size(), -1) < 0) continue;
    if (ready[0].revents != 0 && !take_keys(console, editor)) {
      fmt::print("{}", kClearLine);
      return kDone;
    }
    if (ready[1].revents != 0) {
      while (const auto line = console.receive(milliseconds(0))) {
        fmt::print("{}{}\n", kClearLine, shown(*line));
      }
    }
    if (console.gone()) {
      fmt::print("{}The controller closed the console.\n", kClearLine);
      return kNoAnswer;
    }
    draw(editor);
  }
}

int serve(const ConnectOptions& options) {
  const Problem problem = become_web_server(
      {.console = options.path, .port = options.port, .token_file = options.token_file},
      options.fetch.json);
  return fail(problem, kBadInput, options.fetch);
}

int run(const ConnectOptions& options) {
  if (options.web) return serve(options);
  auto console = ConsoleClient::open(options.path);
  if (!console) return fail(console.error(), kBadInput, options.fetch);
  if (!options.action.empty()) {
    FetchOptions what = options.fetch;
    what.console = options.path;
    what.longest = options.longest();
    return options.action == "send" ? send(*console, what) : fetch(*console, what);
  }
  return ::isatty(STDIN_FILENO) == 1 ? talk_to_a_person(*console)
                                     : talk_for_a_script(*console, options);
}

}  // namespace

void add_connect(CLI::App& app, int& status) {
  auto options = std::make_shared<ConnectOptions>();
  CLI::App* command = app.add_subcommand(
      "connect",
      "the controller's console; from a pipe: a request a line, status 1 if any reply is an error");
  command->add_option("console", options->path, "its Unix socket, or a serial device")->required();
  command->add_option("--timeout-s", options->timeout_s, "longest wait for a reply, for scripts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* action =
      command
          ->add_option("action", options->action,
                       "fetch: what the controller has, as a file; send: a signature file as a "
                       "candidate, for `compare`")
          ->check(CLI::IsMember({"fetch", "send"}));
  FetchOptions& fetch = options->fetch;
  CLI::Option* file =
      command->add_option("file", fetch.file,
                          "fetch: the file to write, FILE.yaml, or FILE.csv for the log; send: "
                          "the signature to read");
  action->needs(file);
  command
      ->add_option("--what", fetch.what,
                   "to fetch (default: the log of the last identification for FILE.csv, else the "
                   "signature in use)")
      ->check(CLI::IsMember({"signature", "candidate", "drawing", "log"}))
      ->needs(action);
  command->add_option("--name", fetch.name, "name of the arm, for the file fetched")
      ->capture_default_str()
      ->needs(action);
  command->add_option("--serial", fetch.serial, "its serial number")->needs(action);
  CLI::Option* web =
      command
          ->add_option("--web", options->port,
                       "a live page on this computer's loopback; PORT, or a free one")
          ->expected(0, 1)
          ->default_str("0")
          ->type_name("PORT")
          ->check(CLI::Range(0, 65535))
          ->excludes(action);
  command
      ->add_option("--token-file", options->token_file,
                   "keeps the key in the page's address from one start to the next")
      ->needs(web);
  add_common(*command, fetch);
  command->callback([options, web, &status] {
    options->web = web->count() > 0;
    status = run(*options);
  });
}

}  // namespace armsig::tool
