// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/left_in_words.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace armsig::tool {
namespace {

constexpr std::size_t kFewOfOneReason = 3;  // up to so many are said one by one
constexpr std::size_t kMostRuns = 10;       // of lines in one message

using Group = std::vector<const LeftAsItIs*>;

// "P[1]: it is a register" has a name and a reason.
std::size_t end_of_name(const LeftAsItIs& one) {
  return std::min(one.what.find(": "), one.what.size());
}
std::string_view name_of(const LeftAsItIs& one) {
  return std::string_view(one.what).substr(0, end_of_name(one));
}
std::string_view reason_of(const LeftAsItIs& one) {
  return std::string_view(one.what).substr(end_of_name(one));
}

std::string alone(const LeftAsItIs& one, std::string_view place) {
  return fmt::format("{} {}: {}{}", place, one.line, one.what, one.remark ? "" : "; left as it is");
}

// Of one reason, in the order of their lines.
std::vector<Group> groups_of(const std::vector<LeftAsItIs>& left) {
  std::vector<Group> groups;
  for (const LeftAsItIs& one : left) {
    const auto group = std::ranges::find_if(groups, [&](const Group& with) {
      return with[0]->remark == one.remark && reason_of(*with[0]) == reason_of(one);
    });
    if (group == groups.end()) {
      groups.push_back({&one});
    } else {
      group->push_back(&one);
    }
  }
  return groups;
}

// "9 to 14, 20, 31"
std::string runs_in_words(const Group& group) {
  std::vector<std::string> runs;
  for (std::size_t begin = 0; begin < group.size();) {
    std::size_t end = begin + 1;
    while (end < group.size() && group[end]->line <= group[end - 1]->line + 1) ++end;
    const int first = group[begin]->line;
    const int last = group[end - 1]->line;
    runs.push_back(first == last ? std::to_string(first) : fmt::format("{} to {}", first, last));
    begin = end;
  }
  if (runs.size() <= kMostRuns) return fmt::format("{}", fmt::join(runs, ", "));
  const std::size_t more = runs.size() - kMostRuns;
  runs.resize(kMostRuns);
  return fmt::format("{} and {} more up to {}", fmt::join(runs, ", "), more, group.back()->line);
}

bool is_one_run(const Group& group) {
  return std::ranges::adjacent_find(group, [](const LeftAsItIs* one, const LeftAsItIs* next) {
           return next->line != one->line + 1 || name_of(*next) != name_of(*one);
         }) == group.end();
}

std::string together(const Group& group, std::string_view place) {
  const std::string_view first = name_of(*group.front());
  const std::string_view last = name_of(*group.back());
  return fmt::format("{}s {}: {}{}{}", place, runs_in_words(group),
                     first == last ? std::string(first) : fmt::format("{} to {}", first, last),
                     reason_of(*group.front()), group.front()->remark ? "" : "; left as they are");
}

std::vector<std::string> each_in_words(const std::vector<LeftAsItIs>& left, std::string_view place,
                                       bool remarks) {
  std::vector<std::string> words;
  for (const LeftAsItIs& one : left) {
    if (one.remark == remarks) words.push_back(alone(one, place));
  }
  return words;
}

}  // namespace

std::vector<std::string> left_in_words(const std::vector<LeftAsItIs>& left,
                                       std::string_view place) {
  return each_in_words(left, place, false);
}

std::vector<std::string> remarks_in_words(const std::vector<LeftAsItIs>& left,
                                          std::string_view place) {
  return each_in_words(left, place, true);
}

std::vector<std::string> left_in_runs(const std::vector<LeftAsItIs>& left, std::string_view place) {
  std::vector<std::string> words;
  for (const Group& group : groups_of(left)) {
    const bool run = group.size() == kFewOfOneReason && is_one_run(group);
    if (group.size() > kFewOfOneReason || run) {
      words.push_back(together(group, place));
      continue;
    }
    for (const LeftAsItIs* one : group) words.push_back(alone(*one, place));
  }
  return words;
}

std::size_t count_left(const std::vector<LeftAsItIs>& left) {
  return static_cast<std::size_t>(std::ranges::count(left, false, &LeftAsItIs::remark));
}

}  // namespace armsig::tool
