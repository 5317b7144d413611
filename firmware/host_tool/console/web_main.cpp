// SPDX-License-Identifier: MIT
// armsig-web: what `armsig connect CONSOLE --web` becomes. A program of its own, so that no other
// start of armsig loads an HTTP server.
#include <charconv>
#include <cstdio>
#include <exception>
#include <span>
#include <string_view>

#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/console/console_client.hpp"
#include "firmware/host_tool/console/web_page.hpp"
#include "firmware/host_tool/console/web_start.hpp"

namespace {

using namespace armsig::tool;

int run(std::span<char* const> words) {
  WebPageOptions options;
  const auto number = [&](std::string_view text) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), options.port);
    return error == std::errc{} && end == text.data() + text.size();
  };
  if (words.size() != kWebWords || !number(words[kPortWord])) {
    std::fputs("armsig-web is started by the option --web of `armsig connect`\n", stderr);
    return kBadInput;
  }
  options.console = words[kConsoleWord];
  options.token_file = words[kTokenFileWord];
  const CommonOptions common{.json = std::string_view(words[kFormWord]) == kJsonForm};
  // A console that can't be opened now is a mistake in the command; later ones are the page's.
  if (const auto tried = ConsoleClient::open(options.console); !tried) {
    return fail(tried.error(), kBadInput, common);
  }
  return fail(serve_web_page(options), kBadInput, common);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv, static_cast<std::size_t>(argc)});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "armsig: %s\n", error.what());
    return kNoAnswer;
  }
}
