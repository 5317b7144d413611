// SPDX-License-Identifier: MIT
// armsig connect: the controller's console, for a person and for a script.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/fetch.hpp"
#include "firmware/host_tool/commands/send.hpp"
#include "firmware/host_tool/console/console_client.hpp"
#include "firmware/host_tool/console/person.hpp"
#include "firmware/host_tool/console/talking.hpp"
#include "firmware/host_tool/console/web_start.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;

struct ConnectOptions {
  std::string path;
  double timeout_s = 60;
  std::vector<std::string> request;
  bool wait = false;
  double wait_s = 3600;
  bool says_what_to_fetch = false;
  FetchOptions fetch;
  bool web = false;
  int port = 0;
  std::string token_file;

  [[nodiscard]] milliseconds longest() const {
    return milliseconds(static_cast<milliseconds::rep>(1e3 * timeout_s));
  }
  [[nodiscard]] milliseconds longest_wait() const {
    return milliseconds(static_cast<milliseconds::rep>(1e3 * wait_s));
  }
  [[nodiscard]] bool is_about_a_file() const {
    return !request.empty() && (request[0] == "fetch" || request[0] == "send");
  }
};

// Replies go to standard output, what the controller says unasked to standard error.
Talker talker_of(ConsoleClient& console) {
  return {console, [](std::string_view line) { say(stderr, "{}\n", line); }};
}

// Says the reply; false where the console is of no use any more.
bool pass_on(const std::string& request, const Reply& reply, const ConnectOptions& options) {
  if (!reply.text.empty()) say("{}\n", reply.text);
  (void)std::fflush(stdout);
  if (reply.how == Reply::How::kSilent) {
    complain("armsig connect: no reply to \"{}\" within {} s", request, options.timeout_s);
  } else if (reply.how == Reply::How::kGone) {
    complain("armsig connect: the controller closed the console");
  }
  return reply.how == Reply::How::kOk || reply.how == Reply::How::kError;
}

int talk_for_a_script(ConsoleClient& console, const ConnectOptions& options) {
  Talker talker = talker_of(console);
  bool good = true;
  for (std::string request; std::getline(std::cin, request);) {
    if (request.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Reply reply = talker.request(request, options.longest());
    good = good && reply.how == Reply::How::kOk;
    if (!pass_on(request, reply, options)) break;
  }
  return good ? kDone : kNoAnswer;
}

// The one request that the command line is.
int talk_once(ConsoleClient& console, const ConnectOptions& options) {
  std::string request;
  for (const std::string& word : options.request) request += (request.empty() ? "" : " ") + word;
  if (request.find_first_of("\r\n") != std::string::npos) {
    return fail({"", 0, 0, in_quotes(request) + " is no request", "one line"}, kBadInput,
                options.fetch);
  }
  Talker talker = talker_of(console);
  Reply reply = talker.request(request, options.longest());
  if (options.wait && reply.how == Reply::How::kOk) {
    reply = talker.wait_for(options.longest_wait(), options.longest());
  }
  const bool good = reply.how == Reply::How::kOk;
  if (options.fetch.json && !reply.text.empty()) {
    print_json({{"status", good ? 0 : 1}, {"request", request}, {"reply", reply.text}});
    return good ? kDone : kNoAnswer;
  }
  (void)pass_on(request, reply, options);
  return good ? kDone : kNoAnswer;
}

int serve(const ConnectOptions& options) {
  const Problem problem = become_web_server(
      {.console = options.path, .port = options.port, .token_file = options.token_file},
      options.fetch.json);
  return fail(problem, kBadInput, options.fetch);
}

// What the options do not go together with; empty: they do.
std::optional<Problem> contradiction(const ConnectOptions& options) {
  const auto mistake = [](std::string what, std::string expected) {
    return Problem{"", 0, 0, std::move(what), std::move(expected)};
  };
  if (options.is_about_a_file() && options.request.size() != 2) {
    return mistake(options.request[0] + " of one file",
                   fmt::format("{} FILE, and no other word", options.request[0]));
  }
  const bool fetches = options.is_about_a_file() && options.request[0] == "fetch";
  if (options.says_what_to_fetch && !fetches) {
    return mistake("--what, --name or --serial without fetch", "fetch FILE, of which they are");
  }
  if (!options.fetch.by.empty() && (options.request.empty() || options.request[0] != "send")) {
    return mistake("--by without send", "send FILE, whose sender it is");
  }
  if (options.wait && (options.request.empty() || options.is_about_a_file())) {
    return mistake("--wait without a request", "one that begins something, like identify");
  }
  return std::nullopt;
}

int run(const ConnectOptions& options) {
  if (const auto problem = contradiction(options)) return fail(*problem, kBadInput, options.fetch);
  if (options.web) return serve(options);
  auto console = ConsoleClient::open(options.path);
  if (!console) return fail(console.error(), kBadInput, options.fetch);
  if (options.is_about_a_file()) {
    FetchOptions what = options.fetch;
    what.console = options.path;
    what.file = options.request[1];
    what.longest = options.longest();
    return options.request[0] == "send" ? send(*console, what) : fetch(*console, what);
  }
  if (!options.request.empty()) return talk_once(*console, options);
  if (::isatty(STDIN_FILENO) != 1) return talk_for_a_script(*console, options);
  return talk_to_a_person(*console, options.longest()) ? kDone : kNoAnswer;
}

// Returns the request.
CLI::Option* add_request_options(CLI::App& command, ConnectOptions& options) {
  CLI::Option* request = command.add_option(
      "request", options.request,
      "one request, as the console takes it (help lists them), or: wait [timeout_s=3600], until "
      "what is under way has ended; fetch FILE, what the controller has, as a file; send FILE, a "
      "signature as a candidate, for compare. Status 1 where it is refused or ended badly");
  CLI::Option* wait = command.add_flag(
      "--wait", options.wait, "after the request, until what it began has ended; how it ended");
  command.add_option("--wait-s", options.wait_s, "longest wait for that")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str()
      ->needs(wait);
  command.add_option("--by", options.fetch.by,
                     "send: who sends it; somebody else may then accept it by=NAME, where the "
                     "controller's configuration lets them");
  return request;
}

// What they say is said of a fetch only: that they were given is to be known.
std::array<CLI::Option*, 3> add_fetch_options(CLI::App& command, FetchOptions& fetch) {
  return {
      command
          .add_option("--what", fetch.what,
                      "to fetch (default: the log of the last identification for FILE.csv, else "
                      "the signature in use)")
          ->transform(
              CLI::IsMember({"signature", "candidate", "nominal", "log"}, CLI::ignore_case)),
      command.add_option("--name", fetch.name, "name of the arm, for the file fetched")
          ->capture_default_str(),
      command.add_option("--serial", fetch.serial, "its serial number")};
}

// Returns --web, which goes without a request.
CLI::Option* add_web_options(CLI::App& command, ConnectOptions& options, CLI::Option* request) {
  CLI::Option* web = command
                         .add_option("--web", options.port,
                                     "a live page on this computer's loopback; PORT, or a free one")
                         ->expected(0, 1)
                         ->default_str("0")
                         ->type_name("PORT")
                         ->check(CLI::Range(0, 65535))
                         ->excludes(request);
  command
      .add_option("--token-file", options.token_file,
                  "keeps the key in the page's address from one start to the next")
      ->needs(web);
  return web;
}

}  // namespace

void add_connect(CLI::App& app, int& status) {
  auto options = std::make_shared<ConnectOptions>();
  CLI::App* command = app.add_subcommand(
      "connect",
      "the controller's console, or one request; from a pipe: a request a line, status 1 if any "
      "reply is an error");
  command->add_option("console", options->path, "its Unix socket, or a serial device")->required();
  command->add_option("--timeout-s", options->timeout_s, "longest wait for a reply, for scripts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* request = add_request_options(*command, *options);
  const auto of_fetch = add_fetch_options(*command, options->fetch);
  CLI::Option* web = add_web_options(*command, *options, request);
  add_common(*command, options->fetch);
  command->callback([options, web, of_fetch, &status] {
    options->web = web->count() > 0;
    options->says_what_to_fetch =
        std::ranges::any_of(of_fetch, [](const CLI::Option* one) { return one->count() > 0; });
    status = run(*options);
  });
}

}  // namespace armsig::tool
