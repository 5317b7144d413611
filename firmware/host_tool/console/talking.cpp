// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/talking.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/formats/console_line.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;
using TalkClock = std::chrono::steady_clock;

constexpr std::string_view kWait = "wait";
constexpr std::string_view kBound = "timeout_s=";
constexpr double kUsualBound_s = 3600;  // an identification takes minutes
constexpr double kLargestBound_s = 1e6;
constexpr milliseconds kPause{200};  // from one status to the next
constexpr std::string_view kBlanks = " \t\r";

std::string_view first_word(std::string_view line) {
  const std::size_t begin = std::min(line.find_first_not_of(kBlanks), line.size());
  const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
  return line.substr(begin, end - begin);
}

// The bound that a `wait` asks for; nothing where it is no request of that form.
std::optional<double> bound_of(std::string_view request) {
  request.remove_prefix(static_cast<std::size_t>(first_word(request).end() - request.begin()));
  const std::string_view word = first_word(request);
  if (word.empty()) return kUsualBound_s;
  const std::string_view rest(word.end(), request.end());
  if (!word.starts_with(kBound) || !first_word(rest).empty()) return std::nullopt;
  const auto bound_s = parse_number(word.substr(kBound.size()));
  if (!bound_s || !(*bound_s > 0) || *bound_s > kLargestBound_s) return std::nullopt;
  return bound_s;
}

milliseconds milliseconds_of(double seconds) {
  return milliseconds(static_cast<milliseconds::rep>(std::ceil(1e3 * seconds)));
}

}  // namespace

void Ending::hear(std::string_view line) {
  if (!line.starts_with("# ")) return;
  line.remove_prefix(2);
  const bool ended_well = line.starts_with("identify done") ||
                          line.starts_with("touch-grid done") || line.starts_with("homed ") ||
                          line.starts_with("check verdict=\"as accepted\"");
  const bool ended_badly = line.starts_with("identify ended") ||
                           line.starts_with("touch-grid ended") ||
                           line.starts_with("check verdict=") || line.starts_with("mode faulted");
  const bool waits = line.starts_with("identify paused");
  if (!ended_well && !ended_badly && !waits) return;
  // The sequence ends because of the fault, which says more.
  if (is_bad_ && line_.starts_with("mode faulted")) return;
  line_ = line;
  is_bad_ = !ended_well;
}

void Ending::begun(std::string_view verb) {
  resets_ = verb == "reset";
  homes_ = verb == "home";
  if (verb == "enable") awaited_mode_ = "holding";
  if (verb == "disable" || resets_) awaited_mode_ = "idle";
}

std::string Ending::told(std::string_view status) const {
  const auto mode = value_in(status, "mode");
  const auto sequence = value_in(status, "sequence");
  const bool faulted = mode == "faulted" && (!resets_ || is_bad_);
  const bool paused = sequence == "paused";
  const bool awaited = awaited_mode_.empty() || mode == awaited_mode_;
  const bool under_way = sequence != "none" || value_in(status, "moving") == "yes" ||
                         mode == "starting" || mode == "homing" || !awaited;
  if (!faulted && !paused && under_way) return {};
  if (faulted && !is_bad_) return "error the controller is faulted: status tells why";
  if (paused && !is_bad_) return "error the sequence is paused: go on with resume";
  if (homes_ && line_.empty()) return "error the search has ended without a reference";
  if (line_.empty()) return "ok nothing is under way";
  return (is_bad_ ? "error " : "ok ") + line_;
}

void Talker::heard(std::string_view line) {
  ending_.hear(line);
  hear_(line);
}

Reply Talker::ask(const std::string& line, milliseconds longest) {
  using enum Reply::How;
  if (!console_.send(line)) return {kGone, {}};
  const auto until = TalkClock::now() + longest;
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(until - TalkClock::now());
    auto told = console_.receive(std::max(left, milliseconds(0)));
    if (!told) return {console_.gone() ? kGone : kSilent, {}};
    if (is_reply(*told)) return {is_error(*told) ? kError : kOk, std::move(*told)};
    heard(*told);
    if (TalkClock::now() >= until) return {kSilent, {}};
  }
}

Reply Talker::request(const std::string& request, milliseconds longest) {
  if (first_word(request) == kWait) return wait(request, longest);
  ending_.forget();
  Reply reply = ask(request, longest);
  if (reply.how == Reply::How::kOk) ending_.begun(first_word(request));
  return reply;
}

Reply Talker::wait(std::string_view request, milliseconds longest) {
  const auto bound_s = bound_of(request);
  if (!bound_s) {
    return {Reply::How::kError, "error wait takes timeout_s= above 0, up to 1000000, and no more"};
  }
  return wait_for(milliseconds_of(*bound_s), longest);
}

Reply Talker::wait_for(milliseconds bound, milliseconds longest) {
  const auto until = TalkClock::now() + bound;
  for (;;) {
    Reply status = ask("status", longest);
    if (status.how != Reply::How::kOk) return status;
    if (std::string told = ending_.told(status.text); !told.empty()) {
      const auto how = is_error(told) ? Reply::How::kError : Reply::How::kOk;
      return {how, std::move(told)};
    }
    if (TalkClock::now() >= until) {
      return {Reply::How::kError, "error it is still under way after timeout_s"};
    }
    const auto next = std::min(until, TalkClock::now() + kPause);
    while (TalkClock::now() < next && !console_.gone()) {
      const auto left = std::chrono::ceil<milliseconds>(next - TalkClock::now());
      if (const auto line = console_.receive(left)) heard(*line);
    }
    if (console_.gone()) return {Reply::How::kGone, {}};
  }
}

}  // namespace armsig::tool
