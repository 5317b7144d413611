// SPDX-License-Identifier: MIT
// What a live page shows, as far as it is known: written by the one thread that talks to the
// controller, read by the one that serves the viewers, each of them at its own pace.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "hal/linux/file_descriptor.hpp"

namespace armsig::tool {

class WebBoard {
 public:
  using Json = nlohmann::ordered_json;
  using milliseconds = std::chrono::milliseconds;
  // key=value words of a reply.
  using Values = std::map<std::string, std::string, std::less<>>;

  static constexpr std::size_t kMostLines = 200;  // kept of what the controller says unasked

  // What one viewer has seen.
  struct Seen {
    std::uint64_t version = 0;
    std::uint64_t arm = 0;
    std::uint64_t run = 0;
    std::uint64_t lines = 0;
    std::size_t points = 0;
  };

  // Throws std::system_error where the system has no descriptor left.
  WebBoard();

  // --- Written ----------------------------------------------------------------------------------

  // The console is open, and has told its nominal model and its verbs.
  void connected(const Json& arm);
  // The console is not there, for a reason in words.
  void gone(std::string why);
  void status(const Values& values);
  void candidate(const std::optional<Values>& values);
  void say(std::string line);
  // How well the axis of `joint`, from 1, is known by the run's first `points`.
  void axis_sigma(const std::string& joint, const std::string& points,
                  const std::string& sigma_deg);
  // The rows of the log that follow those known; `run` begins anew.
  void begin_run();
  void point(const Values& row);
  [[nodiscard]] std::size_t points() const;
  // What became of a request: `words` of the controller.
  void answered(std::string_view verb, bool good, std::string_view words);
  // A request is under way; empty: none.
  void busy(std::string_view verb);
  // Something that viewers see has changed elsewhere.
  void touch();

  // --- Read -------------------------------------------------------------------------------------

  // The file of the black box, as the controller named it; empty: none.
  [[nodiscard]] std::string black_box() const;
  // Of each joint of the arm whether it is revolute; empty before the arm is known.
  [[nodiscard]] std::vector<bool> revolute() const;
  // A descriptor that can be read when something has changed since take_news().
  [[nodiscard]] int news() const { return news_.get(); }
  void take_news() const;
  // Whether there is nothing new since `seen`.
  [[nodiscard]] bool is_seen(const Seen& seen) const;
  // What is new since `seen`, as server-sent events; the state in any case, with the members of
  // `own`, which are this viewer's.
  [[nodiscard]] std::string events(Seen& seen, const Json& own) const;

 private:
  using Clock = std::chrono::steady_clock;

  void changed();  // the mutex is held

  mutable std::mutex mutex_;
  linux_hal::FileDescriptor news_;
  std::uint64_t version_ = 1;

  bool linked_ = false;
  std::string why_ = "not connected yet";
  std::optional<Clock::time_point> heard_;
  std::uint64_t arm_version_ = 0;
  Json arm_;
  Values status_;
  std::optional<Values> candidate_;
  std::string busy_;
  Json answer_;
  std::uint64_t answers_ = 0;
  std::uint64_t run_ = 1;
  std::vector<Json> points_;
  std::map<std::string, Json> sigmas_;  // by joint: [points of the run, sigma in degrees]
  std::uint64_t lines_said_ = 0;
  std::deque<std::string> lines_;
};

}  // namespace armsig::tool
