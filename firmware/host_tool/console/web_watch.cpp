// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_watch.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/units.hpp"
#include "firmware/host_tool/console/fetching.hpp"

namespace armsig::tool {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using WatchClock = std::chrono::steady_clock;
using Json = WebBoard::Json;

constexpr milliseconds kRound = 125ms;     // from one status to the next
constexpr milliseconds kSlice = 20ms;      // a stop waits no longer than this
constexpr milliseconds kAnswer = 3s;       // to what only asks
constexpr milliseconds kCommand = 10s;     // the tick takes it, or the drives are set up
constexpr milliseconds kStored = 60s;      // flash is slow
constexpr milliseconds kRetry = 500ms;     // to open a console that has gone
constexpr std::size_t kRowsOfARound = 20;  // so that a status is never far away

// The words key=value and key="several words" of a reply.
WebBoard::Values values_of(std::string_view reply) {
  WebBoard::Values values;
  std::size_t at = 0;
  while (at < reply.size()) {
    const std::size_t equals = reply.find('=', at);
    if (equals == std::string_view::npos) break;
    const std::size_t space = reply.rfind(' ', equals);
    const std::size_t begin = space == std::string_view::npos ? 0 : space + 1;
    const bool quoted = equals + 1 < reply.size() && reply[equals + 1] == '"';
    const std::size_t from = equals + (quoted ? 2 : 1);
    const std::size_t end = std::min(reply.find(quoted ? '"' : ' ', from), reply.size());
    values.emplace(reply.substr(begin, equals - begin), reply.substr(from, end - from));
    at = end + 1;
  }
  return values;
}

Json words_between_commas(std::string_view text) {
  Json words = Json::array();
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

bool is_running(const WebBoard::Values& status) {
  const auto sequence = status.find("sequence");
  return sequence != status.end() &&
         (sequence->second == "identifying" || sequence->second == "paused");
}

Json json_of_drawing(const Arm& drawing) {
  Json joints = Json::array();
  for (std::size_t i = 0; i < drawing.joints.size(); ++i) {
    const DhJoint& row = drawing.joints[i];
    joints.push_back({{"revolute", row.type == JointType::kRevolute},
                      {"theta_rad", row.theta_rad},
                      {"d_m", row.d_m},
                      {"a_m", row.a_m},
                      {"alpha_rad", row.alpha_rad},
                      {"lower", drawing.limits[i].lower},
                      {"upper", drawing.limits[i].upper}});
  }
  return {{"joints", std::move(joints)}};
}

}  // namespace

WebWatch::WebWatch(std::string path, WebBoard& board)
    : path_(std::move(path)),
      board_(board),
      thread_([this](const std::stop_token& ending) { run(ending); }) {}

bool WebWatch::request(const PageRequest& request) {
  const std::lock_guard lock(mutex_);
  if (request.verb == "stop") {
    stop_wanted_ = true;
    return true;
  }
  if (wanted_) return false;
  wanted_ = request;
  return true;
}

bool WebWatch::take_stop() {
  const std::lock_guard lock(mutex_);
  return std::exchange(stop_wanted_, false);
}

void WebWatch::run(const std::stop_token& ending) {
  while (!ending.stop_requested()) {
    auto console = ConsoleClient::open(path_);
    if (console) {
      converse(*console, ending);
      board_.gone(lost_ ? "the controller does not answer" : "the controller closed its console");
    } else {
      board_.gone(fmt::format("{}: {}", path_, console.error().what));
    }
    {
      // What was asked of a controller that is not there is not done when it comes back.
      const std::lock_guard lock(mutex_);
      if (wanted_) board_.answered(wanted_->verb, false, "the controller is not there");
      if (stop_wanted_) board_.answered("stop", false, "the controller is not there");
      wanted_.reset();
      stop_wanted_ = false;
    }
    const auto until = WatchClock::now() + kRetry;
    while (!ending.stop_requested() && WatchClock::now() < until) {
      std::this_thread::sleep_for(kSlice);
    }
  }
}

void WebWatch::converse(ConsoleClient& console, const std::stop_token& ending) {
  lost_ = false;
  candidate_due_ = true;
  was_running_ = false;
  rounds_ = 0;
  Fetcher fetcher(console, path_, kAnswer);
  const auto drawing = fetcher.drawing();
  if (!drawing) {
    lost_ = !console.gone();
    return;
  }
  Json arm = json_of_drawing(*drawing);
  arm["verbs"] = learn_verbs(console);
  if (lost_ || console.gone()) return;
  board_.begin_run();
  board_.connected(arm);
  while (!ending.stop_requested() && !console.gone() && !lost_) {
    if (!pass_on(console) || !look(console)) return;
    hear(console, ending);
  }
}

// A verb that the controller refuses to explain is none of its own.
Json WebWatch::learn_verbs(ConsoleClient& console) {
  Json verbs = Json::object();
  for (const std::string_view verb : page_verbs()) {
    std::optional<std::string> reply;
    while (!reply && !lost_ && !console.gone()) {  // a stop in between takes a reply away
      reply = ask(console, fmt::format("help {}", verb), kAnswer);
    }
    if (!reply || is_error(*reply)) continue;
    const auto values = values_of(*reply);
    const auto modes = values.find("modes");
    const auto alone = values.find("alone");
    if (modes == values.end() || alone == values.end()) continue;
    verbs[verb] = {{"modes", words_between_commas(modes->second)},
                   {"alone", alone->second == "yes"}};
  }
  return verbs;
}

// One round: the status, and what it says is new.
bool WebWatch::look(ConsoleClient& console) {
  const auto reply = ask(console, "status", kAnswer);
  if (!reply) return !lost_ && !console.gone();
  const auto values = values_of(*reply);
  const bool running = is_running(values);
  if (running && !was_running_) board_.begin_run();
  const bool ended = was_running_ && !running;
  was_running_ = running;
  candidate_due_ = candidate_due_ || ended;
  board_.status(values);
  tell_axis(values, "sweep");
  constexpr unsigned kSeldom = 8;
  if (running || ended || rounds_++ % kSeldom == 0) {
    candidate_due_ = candidate_due_ || !running;  // others accept or measure, too
    if (!look_at_log(console)) return false;
  }
  return !candidate_due_ || look_at_candidate(console);
}

bool WebWatch::look_at_log(ConsoleClient& console) {
  const auto counted = ask(console, "log", kAnswer);
  if (!counted) return !lost_ && !console.gone();
  const auto values = values_of(*counted);
  const auto found = values.find("rows");
  const std::size_t rows =
      found == values.end() ? 0 : std::strtoul(found->second.c_str(), nullptr, 10);
  if (rows < board_.points()) board_.begin_run();
  const std::size_t last = std::min(rows, board_.points() + kRowsOfARound);
  for (std::size_t row = board_.points() + 1; row <= last; ++row) {
    const auto told = ask(console, fmt::format("log row={}", row), kAnswer);
    if (!told) return !lost_ && !console.gone();
    if (is_error(*told)) return true;  // the log was begun anew in between
    board_.point(values_of(*told));
  }
  return true;
}

bool WebWatch::look_at_candidate(ConsoleClient& console) {
  const auto candidate = ask(console, "candidate", kAnswer);
  if (!candidate) return !lost_ && !console.gone();
  candidate_due_ = false;
  board_.candidate(is_error(*candidate) ? std::nullopt : std::optional(values_of(*candidate)));
  return true;
}

// What a viewer wants. False if the controller has gone.
bool WebWatch::pass_on(ConsoleClient& console) {
  std::optional<PageRequest> wanted;
  {
    const std::lock_guard lock(mutex_);
    if (!stop_wanted_) wanted = wanted_;
  }
  if (take_stop()) {
    tell("stop", ask(console, "stop", kCommand));
    return !lost_ && !console.gone();
  }
  if (!wanted) return true;
  board_.busy(wanted->verb);
  const bool stores = wanted->verb == "accept" || wanted->verb == "rollback";
  const auto reply = ask(console, wanted->line, stores ? kStored : kCommand);
  {
    const std::lock_guard lock(mutex_);
    wanted_.reset();
  }
  board_.busy("");
  tell(wanted->verb, reply);
  candidate_due_ = true;
  return !lost_ && !console.gone();
}

void WebWatch::tell(std::string_view verb, const std::optional<std::string>& reply) {
  if (!reply) {
    board_.answered(verb, false, "no answer that is surely its own: see what the controller shows");
  } else {
    board_.answered(verb, !is_error(*reply), *reply);
  }
}

void WebWatch::tell_axis(const WebBoard::Values& values, std::string_view joint_key) {
  const auto joint = values.find(joint_key);
  const auto points = values.find("points");
  const auto sigma = values.find("axis_sigma_deg");
  const auto end = values.end();
  if (joint == end || points == end || sigma == end) return;
  board_.axis_sigma(joint->second, points->second, sigma->second);
}

void WebWatch::said(std::string line) {
  if (line.starts_with("# identify swept")) tell_axis(values_of(line), "joint");
  if (line.starts_with("# candidate") || line.starts_with("# signature") ||
      line.starts_with("# mode") || line.starts_with("# identify")) {
    candidate_due_ = true;
  }
  board_.say(std::move(line));
}

// What comes unasked until the next round is due, or a request.
void WebWatch::hear(ConsoleClient& console, const std::stop_token& ending) {
  const auto until = WatchClock::now() + kRound;
  while (!ending.stop_requested() && !console.gone() && WatchClock::now() < until) {
    if (auto line = console.receive(kSlice)) said(std::move(*line));
    const std::lock_guard lock(mutex_);
    if (stop_wanted_ || wanted_) return;
  }
}

std::optional<std::string> WebWatch::ask(ConsoleClient& console, const std::string& line,
                                         milliseconds longest) {
  if (!console.send(line)) return std::nullopt;
  auto until = WatchClock::now() + longest;
  std::size_t awaited = 1;
  const bool is_stop = line == "stop";
  bool stopped = false;  // in between
  std::optional<std::string> reply;
  while (awaited > 0 && WatchClock::now() < until) {
    if (!is_stop && !stopped && take_stop()) {
      if (!console.send("stop")) return std::nullopt;
      ++awaited;
      stopped = true;
      until = std::max(until, WatchClock::now() + kCommand);
    }
    auto heard = console.receive(kSlice);
    if (!heard && console.gone()) return std::nullopt;
    if (!heard) continue;
    if (!is_reply(*heard)) {
      said(std::move(*heard));
      continue;
    }
    --awaited;
    // A reply with values is no stop's.
    if (!stopped || heard->starts_with("ok ")) {
      reply = std::move(*heard);
    } else {
      board_.answered("stop", !is_error(*heard), *heard);
    }
  }
  lost_ = awaited > 0;
  if (lost_) return std::nullopt;
  return reply;
}

}  // namespace armsig::tool
