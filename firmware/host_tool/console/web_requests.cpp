// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_requests.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware/formats/touches.hpp"

namespace armsig::tool {
namespace {

using PageJson = nlohmann::json;
using JointKinds = std::vector<bool>;  // of each joint whether it is revolute

constexpr std::size_t kLongestViewer = 64;
constexpr std::size_t kMostKeys = 2;

enum class Wanted : std::uint8_t {
  kPositive,
  kStep,
  kJoint,
  kRevoluteJoint,
  kPrismaticJoint,
  kPlace
};

struct PageKey {
  std::string_view name;  // empty: there is none
  Wanted wanted = Wanted::kPositive;
  double most = 0;  // of a number, or of the size of a step
};

// One form of a request. `line` has a {} for the value of each key.
struct PageForm {
  std::string_view verb;
  std::string_view line;
  std::array<PageKey, kMostKeys> keys{};
};

constexpr PageForm plain(std::string_view verb) { return {.verb = verb, .line = verb}; }

// The controller's own bounds; of steps those that an unreferenced arm may always take.
constexpr PageKey kAccuracyKey{"accuracy_mm", Wanted::kPositive, 100};
constexpr PageKey kMinutesKey{"minutes", Wanted::kPositive, 4320};
constexpr PageKey kAnyJointKey{"joint", Wanted::kJoint};
constexpr PageKey kRevoluteKey{"joint", Wanted::kRevoluteJoint};
constexpr PageKey kPrismaticKey{"joint", Wanted::kPrismaticJoint};
constexpr PageKey kAngleKey{"step_deg", Wanted::kStep, 5};
constexpr PageKey kLengthKey{"step_mm", Wanted::kStep, 5};
constexpr PageKey kPlaceKey{"place", Wanted::kPlace};

// All that a page may ask for. A request has exactly the keys of one form of its verb.
constexpr std::array kForms{
    PageForm{.verb = "take-over", .line = {}},
    plain("stop"),
    plain("enable"),
    plain("disable"),
    plain("halt"),
    plain("reset"),
    plain("identify"),
    PageForm{"identify", "identify accuracy_mm={}", {kAccuracyKey}},
    PageForm{"identify", "identify accuracy_mm={} minutes={}", {kAccuracyKey, kMinutesKey}},
    plain("pause"),
    plain("resume"),
    plain("check"),
    plain("accept"),
    plain("rollback"),
    plain("acknowledge"),
    PageForm{"touch", "touch place={}", {kPlaceKey}},
    plain("drop-touch"),
    PageForm{"home", "home joint={}", {kAnyJointKey}},
    PageForm{"move", "move dq{}_deg={} pace=0.1", {kRevoluteKey, kAngleKey}},
    PageForm{"move", "move dq{}_mm={} pace=0.1", {kPrismaticKey, kLengthKey}},
};

std::size_t count_of(const PageForm& form) {
  return static_cast<std::size_t>(
      std::ranges::count_if(form.keys, [](const PageKey& key) { return !key.name.empty(); }));
}

bool has_keys(const PageForm& form, const PageJson& json) {
  return json.size() == count_of(form) + 2 &&  // viewer and verb
         std::ranges::all_of(form.keys, [&](const PageKey& key) {
           return key.name.empty() || json.contains(key.name);
         });
}

bool is_joint(double number, Wanted wanted, const JointKinds& revolute) {
  if (!(number >= 1 && number <= static_cast<double>(revolute.size()))) return false;
  if (number != std::floor(number)) return false;
  const bool turns = revolute[static_cast<std::size_t>(number) - 1];
  return wanted == Wanted::kJoint || turns == (wanted == Wanted::kRevoluteJoint);
}

// As it stands in the line.
std::optional<std::string> value_of(const PageKey& key, const PageJson& value,
                                    const JointKinds& revolute) {
  if (key.wanted == Wanted::kPlace) {
    const auto* const name = value.get_ptr<const std::string*>();
    return name != nullptr && is_place_name(*name) ? std::optional(*name) : std::nullopt;
  }
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  const double size = key.wanted == Wanted::kStep ? std::abs(number) : number;
  const bool is_number = key.wanted == Wanted::kPositive || key.wanted == Wanted::kStep;
  // A number that is not finite is in no range.
  const bool good =
      is_number ? size > 0 && size <= key.most : is_joint(number, key.wanted, revolute);
  return good ? std::optional(fmt::format("{}", number)) : std::nullopt;
}

std::string needs(const PageKey& key, const JointKinds& revolute) {
  switch (key.wanted) {
    case Wanted::kPositive:
      return fmt::format("{} needs a number above 0, at most {}", key.name, key.most);
    case Wanted::kStep:
      return fmt::format("{0} needs a number from -{1} to {1}, other than 0", key.name, key.most);
    case Wanted::kRevoluteJoint:
      return fmt::format("{} needs the number of a revolute joint of the arm", key.name);
    case Wanted::kPrismaticJoint:
      return fmt::format("{} needs the number of a prismatic joint of the arm", key.name);
    case Wanted::kPlace:
      return fmt::format("{} needs {}", key.name, kPlaceExpected);
    default:
      return fmt::format("{} needs the number of a joint, 1 to {}", key.name, revolute.size());
  }
}

// The keys of each form of `verb`: "takes nothing, or accuracy_mm, or accuracy_mm and minutes".
std::string takes(std::string_view verb) {
  std::string words;
  for (const PageForm& form : kForms) {
    if (form.verb != verb) continue;
    words += words.empty() ? "" : ", or ";
    if (count_of(form) == 0) words += "nothing";
    for (std::size_t i = 0; i < count_of(form); ++i) {
      words += fmt::format("{}{}", i == 0 ? "" : " and ", form.keys[i].name);
    }
  }
  return "takes " + words;
}

std::expected<std::string, std::string> line_of(const PageForm& form, const PageJson& json,
                                                const JointKinds& revolute) {
  std::array<std::string, kMostKeys> values;
  for (std::size_t i = 0; i < count_of(form); ++i) {
    const PageKey& key = form.keys[i];
    auto value = value_of(key, json[key.name], revolute);
    if (!value) return std::unexpected(needs(key, revolute));
    values[i] = std::move(*value);
  }
  return fmt::format(fmt::runtime(form.line), values[0], values[1]);
}

// An object with no key twice: of two values another reader may take the other.
std::optional<PageJson> object_of(std::string_view body) {
  std::size_t keys = 0;
  const auto count = [&](int /*depth*/, PageJson::parse_event_t event, const PageJson& /*parsed*/) {
    if (event == PageJson::parse_event_t::key) ++keys;
    return true;
  };
  auto json = PageJson::parse(body, count, false);
  if (!json.is_object() || json.size() != keys) return std::nullopt;
  return json;
}

std::string word_of(const PageJson& json, std::string_view key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::expected<PageRequest, std::string> page_request(std::string_view body,
                                                     const std::vector<bool>& revolute) {
  const auto json = object_of(body);
  if (!json) return std::unexpected("not a request of the page");
  PageRequest request{
      .viewer = word_of(*json, "viewer"), .verb = word_of(*json, "verb"), .line = {}};
  if (!is_viewer(request.viewer)) return std::unexpected("viewer: digits and small letters");
  const auto of_verb = [&](const PageForm& form) { return form.verb == request.verb; };
  if (std::ranges::none_of(kForms, of_verb)) {
    return std::unexpected("verb: none that the page has");
  }
  for (const PageForm& form : kForms) {
    if (!of_verb(form) || !has_keys(form, *json)) continue;
    auto line = line_of(form, *json, revolute);
    if (!line) return std::unexpected(line.error());
    request.line = std::move(*line);
    return request;
  }
  return std::unexpected(takes(request.verb));
}

std::vector<std::string_view> page_verbs() {
  std::vector<std::string_view> verbs;
  for (const PageForm& form : kForms) {
    const bool first = std::ranges::find(verbs, form.verb) == verbs.end();
    if (first && !form.line.empty()) verbs.push_back(form.verb);
  }
  return verbs;
}

bool is_viewer(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z'); };
  return !name.empty() && name.size() <= kLongestViewer && std::ranges::all_of(name, is_letter);
}

}  // namespace armsig::tool
