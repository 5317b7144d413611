// SPDX-License-Identifier: MIT
#include "firmware/linux/touch_recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error_name.hpp"
#include "firmware/controller/verbs.hpp"

namespace armsig::daemon {
namespace {

using controller::Line;
using controller::Snapshot;

// Steps of the background without a tick: seconds, after which nobody waits for one.
constexpr unsigned kMostIdleSteps = 10'000;

constexpr controller::Modes kAtRest{controller::Mode::kIdle, controller::Mode::kHolding};
constexpr std::array kTouchVerbs{
    TouchVerb{.name = "touch",
              .help = "place=A1 keeps the readings of an arm that stands, with the ball in that "
                      "place",
              .modes = kAtRest},
    TouchVerb{.name = "drop-touch", .help = "takes the last touch back"},
    TouchVerb{.name = "touches",
              .help = "how many there are by place, and left of the plan",
              .only_asks = true},
};

std::size_t joint_of(unsigned bits) {
  std::size_t joint = 1;
  while (joint < kMaxJoints && (bits >> (joint - 1) & 1U) == 0) ++joint;
  return joint;
}

template <std::size_t kCapacity>
void append(FixedVector<char, kCapacity>& to, std::string_view text) {
  for (const char c : text) {
    if (!to.full()) to.push_back(c);
  }
}

}  // namespace

std::span<const TouchVerb> touch_verbs() { return kTouchVerbs; }

const TouchVerb* find_touch_verb(std::string_view name) {
  const auto* const verb = std::ranges::find(kTouchVerbs, name, &TouchVerb::name);
  return verb == kTouchVerbs.end() ? nullptr : verb;
}

TouchRecorder::TouchRecorder(const controller::Configuration& configuration,
                             const TouchFiles& files)
    : configuration_(configuration), file_(files, types_of(configuration.drawing.joints)) {}

void TouchRecorder::serve(const TouchVerb& verb, const controller::Request& request,
                          hal::Console& console, hal::ConsoleClient client) {
  const Client asks{&console, client};
  Line out;
  Result<void> begun;
  if (verb.modes.contains(controller::Mode::kFaulted)) {  // it does not matter how the arm stands
    const bool plain = request.arguments.empty() && request.subject.empty();
    begun = plain ? post({.client = asks, .verb = &verb, .place = {}, .readings = {}})
                  : std::unexpected(Error::kUnknownRequest);
  } else {
    begun = begin_look(verb, request, asks, out);
  }
  if (!begun) refuse(asks, begun.error(), out);
}

Result<void> TouchRecorder::may_touch(const TouchVerb& verb, Line& out) const {
  if (background_ == nullptr) return std::unexpected(Error::kWrongMode);
  const Snapshot& now = background_->snapshot();
  if (!verb.modes.contains(now.mode) || now.moving || now.fault) {
    out.text(" mode=").text(name(now.mode));
    controller::tell_modes(verb.modes, out);
    return std::unexpected(Error::kWrongMode);
  }
  const std::size_t joints = configuration_.drawing.joints.size();
  const unsigned unknown = ~unsigned{now.known} & ((1U << joints) - 1U);
  if (unknown != 0 || now.positions.size() != joints) {
    out.text(" joint=").integer(joint_of(unknown));
    return std::unexpected(Error::kFeedbackLost);
  }
  if (background_->unreferenced() == 0) return {};
  out.text(" unreferenced=").numbers(background_->unreferenced());
  return std::unexpected(Error::kUnreferenced);
}

Result<void> TouchRecorder::begin_look(const TouchVerb& verb, const controller::Request& request,
                                       const Client& client, Line& out) {
  const bool has_place = request.subject.empty() && request.arguments.size() == 1 &&
                         request.arguments[0].first == "place";
  if (!has_place) {
    out.text(" why=\"touch place=A1\"");
    return std::unexpected(Error::kUnknownRequest);
  }
  if (!is_place_name(request.arguments[0].second)) {
    out.text(" why=\"place needs ").text(kPlaceExpected).text("\"");
    return std::unexpected(Error::kOutOfRange);
  }
  if (auto may = may_touch(verb, out); !may) return may;
  if (look_) {
    out.text(" why=\"a touch is under way\"");
    return std::unexpected(Error::kWrongMode);
  }
  const Snapshot& now = background_->snapshot();
  look_.emplace(Look{.client = client,
                     .verb = &verb,
                     .place = {},
                     .began = now.now,
                     .last = now.now,
                     .first = now.positions,
                     .sum = now.positions,
                     .count = 1});
  append(look_->place, request.arguments[0].second);
  return {};
}

Result<bool> TouchRecorder::look(Line& out) {
  if (auto may = may_touch(*look_->verb, out); !may) return std::unexpected(may.error());
  const Snapshot& now = background_->snapshot();
  if (now.now == look_->last) {
    if (++look_->idle_steps > kMostIdleSteps) return std::unexpected(Error::kLateTick);
    return false;
  }
  look_->last = now.now;
  look_->idle_steps = 0;
  ++look_->count;
  for (std::size_t i = 0; i < now.positions.size(); ++i) {
    look_->sum[i] += now.positions[i];
    if (std::abs(now.positions[i] - look_->first[i]) <= configuration_.dwell.tolerance) continue;
    out.text(" joint=").integer(i + 1);
    return std::unexpected(Error::kArmMoved);
  }
  return now.now - look_->began >= configuration_.dwell.settle;
}

void TouchRecorder::step() {
  while (const auto reply = replies_.take()) {
    (void)reply->client.console->write_line(reply->client.id,
                                            {reply->text.data(), reply->text.size()});
  }
  if (!look_) return;
  Line out;
  const auto stood = look(out);
  if (stood && !*stood) return;
  Result<void> begun = stood ? Result<void>() : std::unexpected(stood.error());
  if (stood) {
    for (double& reading : look_->sum) reading /= look_->count;
    begun = post({.client = look_->client,
                  .verb = look_->verb,
                  .place = look_->place,
                  .readings = readings_for(configuration_.drawing.couplings, look_->sum)});
  }
  if (!begun) refuse(look_->client, begun.error(), out);
  look_.reset();
}

Result<void> TouchRecorder::post(const Job& job) {
  if (jobs_.post(job)) return {};
  return std::unexpected(Error::kCapacityExceeded);  // the disk does not keep up
}

void TouchRecorder::refuse(const Client& client, Error error, const Line& out) {
  Line line;
  line.text("error ").text(name(error)).text(" ").text(describe(error)).text(out.view());
  (void)client.console->write_line(client.id, line.view());
}

void TouchRecorder::write_if_due() {
  for (;;) {
    // A reply that finds no room waits here, and with it the next request: none goes astray.
    if (unposted_ && !replies_.post(*unposted_)) return;
    unposted_.reset();
    const auto job = jobs_.take();
    if (!job) return;
    Reply& reply = unposted_.emplace(Reply{.client = job->client, .text = {}});
    Told told;
    if (job->verb->only_asks) {
      told = file_.tell();
    } else if (!job->place.empty()) {
      told = file_.add({job->place.data(), job->place.size()}, job->readings);
    } else {
      told = file_.drop();
    }
    if (told) {
      append(reply.text, "ok");
      append(reply.text, *told);
      continue;
    }
    const TouchRefusal& refusal = told.error();
    for (const std::string_view part :
         {std::string_view("error "), name(refusal.error), std::string_view(" "),
          describe(refusal.error), std::string_view(" why=\""), std::string_view(refusal.why),
          std::string_view("\"")}) {
      append(reply.text, part);
    }
  }
}

}  // namespace armsig::daemon
