// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/person.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/console/conversation.hpp"
#include "firmware/host_tool/console/talking.hpp"
#include "firmware/host_tool/console/terminal.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;

// Asks the controller what it can be asked; what it says meanwhile goes to `unasked`.
void learn(ConsoleClient& console, milliseconds longest, Conversation& conversation,
           std::string& unasked) {
  constexpr milliseconds kLongest{2000};
  const milliseconds bound = std::min(longest, kLongest);
  Talker talker(console, [&](std::string_view line) { unasked += shown(line) + "\n"; });
  const Reply verbs = talker.request("help", bound);
  if (verbs.how != Reply::How::kOk) return;
  conversation.learn_verbs(verbs.text);
  for (std::size_t i = 0; i < conversation.verbs().size(); ++i) {
    const Reply verb = talker.request("help " + conversation.verbs()[i].name, bound);
    if (verb.how != Reply::How::kOk) return;
    conversation.learn_verb(verb.text);
  }
  const Reply status = talker.request("status", bound);
  if (status.how == Reply::How::kOk) conversation.learn_joints(status.text);
}

}  // namespace

bool talk_to_a_person(ConsoleClient& console, milliseconds longest) {
  Conversation conversation;
  std::string told;
  learn(console, longest, conversation, told);
  const auto hear = [&]() -> std::optional<std::string> {
    std::string said;
    while (const auto line = console.receive(milliseconds(0))) {
      said += conversation.hear(*line, output_width());
    }
    if (console.gone() && said.empty()) return std::nullopt;
    return said;
  };
  Terminal terminal(
      "armsig> ", console.descriptor(),
      [&](std::string_view before) { return conversation.completions(before); }, hear,
      console_history_file());
  Terminal::print("Connected. `help` lists the requests, `quit` or Ctrl-D leaves.\n" + told);
  while (const auto line = terminal.read_line()) {
    const Conversation::Step step = conversation.take(*line, output_width());
    if (step.leaves) return true;
    Terminal::print(step.say);
    if (!step.send.empty() && !console.send(step.send)) break;
  }
  if (console.gone()) Terminal::print("The controller closed the console.\n");
  return !console.gone();
}

}  // namespace armsig::tool
