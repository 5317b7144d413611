// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_board.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/core.h>

namespace armsig::tool {
namespace {

using Json = WebBoard::Json;

std::string event(std::string_view name, const Json& data) {
  // Bytes that are no UTF-8, as a broken console may send them, are replaced.
  const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  return fmt::format("event: {}\ndata: {}\n\n", name, text);
}

Json json_of(const WebBoard::Values& values) {
  Json json = Json::object();
  for (const auto& [key, value] : values) json[key] = value;
  return json;
}

std::string value_or_empty(const WebBoard::Values& values, std::string_view key) {
  const auto found = values.find(key);
  return found == values.end() ? std::string() : found->second;
}

}  // namespace

WebBoard::WebBoard() : news_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!news_.valid()) throw std::system_error(errno, std::generic_category(), "eventfd");
}

void WebBoard::changed() {
  ++version_;
  const std::uint64_t one = 1;
  (void)!::write(news_.get(), &one, sizeof one);
}

void WebBoard::take_news() const {
  std::uint64_t count = 0;
  (void)!::read(news_.get(), &count, sizeof count);
}

bool WebBoard::is_seen(const Seen& seen) const {
  const std::lock_guard lock(mutex_);
  return seen.version == version_;
}

void WebBoard::connected(const Json& arm) {
  const std::lock_guard lock(mutex_);
  arm_ = arm;
  ++arm_version_;
  status_.clear();  // of a controller that may have started anew
  candidate_.reset();
  linked_ = true;
  heard_ = Clock::now();
  changed();
}

void WebBoard::gone(std::string why) {
  const std::lock_guard lock(mutex_);
  if (!linked_ && why_ == why) return;
  linked_ = false;
  why_ = std::move(why);
  busy_.clear();
  changed();
}

void WebBoard::status(const Values& values) {
  const std::lock_guard lock(mutex_);
  status_ = values;
  heard_ = Clock::now();
  changed();
}

void WebBoard::axis_sigma(const std::string& joint, const std::string& points,
                          const std::string& sigma_deg) {
  const std::lock_guard lock(mutex_);
  Json& history = sigmas_[joint];
  const Json entry{points, sigma_deg};
  if (history.is_null() || history.back()[0] != points) {
    history.push_back(entry);
  } else {
    history.back() = entry;  // the same points, and a later fit to them
  }
  changed();
}

void WebBoard::candidate(const std::optional<Values>& values) {
  const std::lock_guard lock(mutex_);
  candidate_ = values;
  changed();
}

void WebBoard::say(std::string line) {
  const std::lock_guard lock(mutex_);
  lines_.push_back(std::move(line));
  ++lines_said_;
  if (lines_.size() > kMostLines) lines_.pop_front();
  changed();
}

void WebBoard::begin_run() {
  const std::lock_guard lock(mutex_);
  ++run_;
  points_.clear();
  sigmas_.clear();
  changed();
}

void WebBoard::point(const Values& row) {
  const std::lock_guard lock(mutex_);
  points_.push_back(json_of(row));
  changed();
}

std::size_t WebBoard::points() const {
  const std::lock_guard lock(mutex_);
  return points_.size();
}

void WebBoard::answered(std::string_view verb, bool good, std::string_view words) {
  const std::lock_guard lock(mutex_);
  answer_ = {{"number", ++answers_}, {"verb", verb}, {"ok", good}, {"words", words}};
  changed();
}

void WebBoard::busy(std::string_view verb) {
  const std::lock_guard lock(mutex_);
  busy_ = verb;
  changed();
}

void WebBoard::touch() {
  const std::lock_guard lock(mutex_);
  changed();
}

std::string WebBoard::black_box() const {
  const std::lock_guard lock(mutex_);
  return value_or_empty(status_, "black_box");
}

std::vector<bool> WebBoard::revolute() const {
  const std::lock_guard lock(mutex_);
  std::vector<bool> revolute;
  if (!arm_.contains("joints")) return revolute;
  for (const Json& joint : arm_["joints"]) revolute.push_back(joint["revolute"].get<bool>());
  return revolute;
}

std::string WebBoard::events(Seen& seen, const Json& own) const {
  const std::lock_guard lock(mutex_);
  std::string text;
  if (seen.arm != arm_version_) text += event("arm", arm_);
  if (seen.run != run_) seen.points = 0;
  if (seen.run != run_ || seen.points < points_.size()) {
    Json fresh = Json::array();
    for (std::size_t k = seen.points; k < points_.size(); ++k) fresh.push_back(points_[k]);
    text += event("points", {{"from", seen.points}, {"points", std::move(fresh)}});
  }
  if (seen.lines < lines_said_) {
    const std::size_t fresh = std::min<std::uint64_t>(lines_said_ - seen.lines, lines_.size());
    Json said = Json::array();
    for (std::size_t k = lines_.size() - fresh; k < lines_.size(); ++k) said.push_back(lines_[k]);
    text += event("said", said);
  }
  Json state{{"linked", linked_}, {"why", why_}, {"busy", busy_}, {"answer", answer_}};
  state["age_ms"] = nullptr;
  if (heard_) {
    state["age_ms"] = std::chrono::duration_cast<milliseconds>(Clock::now() - *heard_).count();
  }
  state["status"] = json_of(status_);
  state["candidate"] = candidate_ ? json_of(*candidate_) : Json(nullptr);
  state["sigmas"] = sigmas_;
  state.update(own);
  text += event("state", state);
  seen = {.version = version_,
          .arm = arm_version_,
          .run = run_,
          .lines = lines_said_,
          .points = points_.size()};
  return text;
}

}  // namespace armsig::tool
