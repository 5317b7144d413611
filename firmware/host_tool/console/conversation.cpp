// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/conversation.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/console_line.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/console/console_client.hpp"
#include "firmware/host_tool/console/status_words.hpp"
#include "firmware/host_tool/presentation/entries.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kBetweenWords = " \t\r";

// Words of this program's own, which the controller never sees, and what they do.
struct OwnWord {
  std::string_view name;
  std::string_view does;
};
constexpr std::array kOwnWords{
    OwnWord{"raw", "raw REQUEST: the reply as the controller writes it, for programs"},
    OwnWord{"quit", "leaves the console; the controller goes on"},
};

// The first word of `text`, and what follows it.
std::pair<std::string_view, std::string_view> split(std::string_view text) {
  const std::size_t end = std::min(text.find_first_of(kBetweenWords), text.size());
  return {text.substr(0, end), trimmed(text.substr(end))};
}

// "q3_deg" and "dq3_mm" are of a joint.
bool is_of_a_joint(std::string_view key) {
  if (key.starts_with('d')) key.remove_prefix(1);
  return key.size() > 2 && key[0] == 'q' && key[1] >= '1' && key[1] <= '9';
}

}  // namespace

void Conversation::learn_verbs(std::string_view reply) {
  verbs_.clear();
  std::string_view names = value_in(reply, "verbs").value_or("");
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(','), names.size());
    verbs_.push_back({.name = std::string(names.substr(0, end)), .does = {}, .modes = {}});
    names.remove_prefix(std::min(end + 1, names.size()));
  }
}

void Conversation::learn_verb(std::string_view reply) {
  const std::string_view name = value_in(reply, "verb").value_or("");
  const auto verb = std::ranges::find(verbs_, name, &ConsoleVerb::name);
  if (verb == verbs_.end()) return;
  verb->does = value_in(reply, "does").value_or("");
  verb->modes.clear();
  for (const char c : value_in(reply, "modes").value_or("")) {
    verb->modes += c == ',' ? ", " : std::string(1, c);
  }
  verb->alone = value_in(reply, "alone") == "yes";
}

void Conversation::learn_joints(std::string_view status) {
  joints_.clear();
  ConsoleLine words(status);
  while (const auto word = words.next()) {
    if (is_of_a_joint(word->key)) joints_.emplace_back(word->key);
  }
}

const ConsoleVerb* Conversation::find(std::string_view name) const {
  const auto verb = std::ranges::find(verbs_, name, &ConsoleVerb::name);
  return verb == verbs_.end() ? nullptr : &*verb;
}

Conversation::Step Conversation::no_verb(std::string_view word) const {
  std::vector<std::string> known;
  for (const ConsoleVerb& verb : verbs_) known.push_back(verb.name);
  for (const OwnWord& own : kOwnWords) known.emplace_back(own.name);
  const std::string near = nearest(word, known);
  const std::string meant =
      near.empty() ? "; `help` lists them." : fmt::format("; did you mean `{}`?", near);
  return {.send = {},
          .say = fmt::format("There is no request `{}`{} Nothing was sent.\n", shown(word), meant)};
}

Conversation::Step Conversation::help(std::string_view subject, std::size_t width) const {
  Entries entries(width);
  const auto told = [&] { return Step{.send = {}, .say = entries.lines()}; };
  if (subject.empty()) {
    for (const ConsoleVerb& verb : verbs_) entries.add(verb.name, verb.does);
    for (const OwnWord& own : kOwnWords) entries.add(own.name, own.does);
    entries.add("help VERB", "also the modes in which it is allowed; the Tab key completes words");
    return told();
  }
  const auto own = std::ranges::find(kOwnWords, subject, &OwnWord::name);
  if (own != kOwnWords.end()) {
    entries.add(own->name, own->does);
    return told();
  }
  const ConsoleVerb* verb = find(subject);
  if (verb == nullptr) return no_verb(subject);
  entries.add(verb->name, verb->does);
  entries.add("modes", verb->modes);
  if (verb->alone) entries.add("", "only while nothing else is under way");
  return told();
}

Conversation::Step Conversation::ask(std::string_view line, bool in_words) {
  if (line.size() > kLongestLine) {
    return {.send = {},
            .say = fmt::format("A request has {} characters at most. Nothing was sent.\n",
                               kLongestLine)};
  }
  asked_.push_back(in_words);
  return {.send = std::string(line), .say = {}};
}

Conversation::Step Conversation::take(std::string_view typed, std::size_t width) {
  const std::string_view line = trimmed(typed);
  const auto [word, rest] = split(line);
  if (word.empty()) return {};
  if (word == "quit" || word == "exit") return {.send = {}, .say = {}, .leaves = true};
  if (word == "raw") return rest.empty() ? help("raw", width) : ask(rest, false);
  if (verbs_.empty()) return ask(line, true);
  if (word == "help") return help(split(rest).first, width);
  if (find(word) == nullptr) return no_verb(word);
  return ask(line, true);
}

std::string Conversation::hear(std::string_view line, std::size_t width) {
  if (!is_reply(line)) return shown(line) + "\n";
  const bool in_words = !asked_.empty() && asked_.front();
  if (!asked_.empty()) asked_.pop_front();
  const bool is_status = line.starts_with("ok mode=") && value_in(line, "ticks");
  return in_words && is_status ? status_in_words(line, width) : shown(line) + "\n";
}

// Those that its help names; of joints, those of the arm.
std::vector<std::string> Conversation::keys_of(std::string_view verb) const {
  const ConsoleVerb* const known = find(verb);
  std::vector<std::string> keys;
  ConsoleLine words(known == nullptr ? "" : std::string_view(known->does));
  while (const auto word = words.next()) {
    if (word->key.empty() || !word->key.find_first_of("([,;:")) continue;
    const bool moves_by = word->key.starts_with('d');
    if (!is_of_a_joint(word->key) || joints_.empty()) {
      keys.push_back(std::string(word->key) + "=");
      continue;
    }
    for (const std::string& joint : joints_) {
      keys.push_back(fmt::format("{}{}=", moves_by ? "d" : "", joint));
    }
  }
  std::ranges::sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

std::vector<std::string> Conversation::completions(std::string_view before) const {
  before.remove_prefix(std::min(before.find_first_not_of(kBetweenWords), before.size()));
  if (before.starts_with("raw ")) before.remove_prefix(4);
  before.remove_prefix(std::min(before.find_first_not_of(kBetweenWords), before.size()));
  const std::size_t blank = before.find_last_of(kBetweenWords);
  const std::string_view begun =
      blank == std::string_view::npos ? before : before.substr(blank + 1);
  const std::string_view verb = split(before).first;
  const bool names_a_verb = blank == std::string_view::npos || verb == "help";
  std::vector<std::string> possible;
  if (names_a_verb) {
    for (const ConsoleVerb& known : verbs_) possible.push_back(known.name);
    for (const OwnWord& own : kOwnWords) possible.emplace_back(own.name);
  } else {
    possible = keys_of(verb);
    std::erase_if(possible, [&](const std::string& key) { return before.contains(" " + key); });
  }
  std::erase_if(possible, [&](const std::string& word) { return !word.starts_with(begun); });
  return possible;
}

}  // namespace armsig::tool
