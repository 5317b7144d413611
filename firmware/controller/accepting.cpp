// SPDX-License-Identifier: MIT
// `send` and `accept`: a signature from outside, and how it comes into use.
#include <algorithm>

#include "firmware/controller/verbs.hpp"

namespace armsig::controller {
namespace {

#ifndef ARMSIG_SMALL_IMAGE
constexpr std::string_view kBy = "by";

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_of_a_name(char c) {
  return (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-' || c == '@';
}

// Error: kOutOfRange, with the reason.
Result<PersonName> name_in(std::string_view text, Line& out) {
  if (text.empty() || text.size() > PersonName::capacity() ||
      !std::ranges::all_of(text, is_of_a_name)) {
    out.text(" why=\"by=NAME: at most 32 letters, digits, and . _ - @\"");
    return std::unexpected(Error::kOutOfRange);
  }
  PersonName name;
  for (const char c : text) name.push_back(c);
  return name;
}

// Takes the sender out of a request to send; the first part without one is of nobody.
Result<Request> take_sender(const Request& request, PersonName& sender, Line& out) {
  Request rest{.verb = request.verb, .subject = request.subject, .arguments = {}};
  PersonName told;
  bool first = false;
  for (const auto& argument : request.arguments) {
    if (argument.first == kBy) {
      ARMSIG_TRY(name, name_in(argument.second, out));
      told = name;
    } else {
      first = first || (argument.first == "part" && argument.second == "1");
      rest.arguments.push_back(argument);
    }
  }
  if (first || !told.empty()) sender = told;
  return rest;
}

// Whether `name` may confirm what `sender` has sent. Error: kNotConfirmed, with the reason.
Result<void> is_second_person(const PersonName& name, const PersonName& sender, Line& out) {
  if (sender.empty()) {
    out.text(" why=\"it was sent without by=NAME: nobody knows who the first person is\"");
    return std::unexpected(Error::kNotConfirmed);
  }
  const bool same =
      std::ranges::equal(name, sender, [](char a, char b) { return lower(a) == lower(b); });
  if (!same) return {};
  out.text(" why=\"").text(view(sender)).text(" has sent it\"");
  return std::unexpected(Error::kNotConfirmed);
}

// `accept by=NAME`.
Result<Answer> accept_confirmed(Controls& controls, const Request& request, Line& out) {
  const auto& [key, text] = request.arguments[0];
  if (request.arguments.size() != 1 || key != kBy) return std::unexpected(Error::kUnknownRequest);
  if (controls.configuration.sent_needs != SentNeeds::kConfirmed) {
    out.text(" why=\"the configuration does not say accept_sent: confirmed\"");
    return std::unexpected(Error::kUnsupported);
  }
  ARMSIG_TRY(name, name_in(text, out));
  if (!controls.identification.has_received()) return std::unexpected(Error::kNoCandidate);
  if (auto second = is_second_person(name, controls.sender, out); !second) {
    return std::unexpected(second.error());
  }
  if (!controls.custody.machine()) return std::unexpected(Error::kDrivesNotReady);
  controls.identification.confirm(conditions_of(controls),
                                  {.sender = controls.sender, .confirmer = name});
  return when_stored(controls.commit.begin_accept(true));
}
#endif

}  // namespace

Result<Answer> send(Controls& controls, const Request& request, Line& out) {
#ifdef ARMSIG_SMALL_IMAGE
  const Request& part = request;
#else
  ARMSIG_TRY(part, take_sender(request, controls.sender, out));
#endif
  ARMSIG_TRY(whole, controls.identification.receive(part, out));
#ifndef ARMSIG_SMALL_IMAGE
  if (whole) controls.identification.name_sender(controls.sender);
#endif
  if (whole) out.text(" received=candidate");
  return Answer();
}

Result<Answer> accept(Controls& controls, [[maybe_unused]] const Request& request,
                      [[maybe_unused]] Line& out) {
#ifndef ARMSIG_SMALL_IMAGE
  if (!request.arguments.empty()) return accept_confirmed(controls, request, out);
#endif
  return when_stored(controls.commit.begin_accept());
}

}  // namespace armsig::controller
