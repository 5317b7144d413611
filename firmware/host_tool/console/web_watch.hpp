// SPDX-License-Identifier: MIT
// Keeps a WebBoard up to date over one console of the controller, and passes requests on to it.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "firmware/host_tool/console/console_client.hpp"
#include "firmware/host_tool/console/web_board.hpp"
#include "firmware/host_tool/console/web_requests.hpp"

namespace armsig::tool {

// One thread, which opens the console anew when it has gone. At most one request of a viewer is
// under way; a stop is sent at once, whatever is.
class WebWatch {
 public:
  // `board` must outlive it.
  WebWatch(std::string path, WebBoard& board);

  // False while another request is under way (never of "stop"). Precondition: it has a line.
  [[nodiscard]] bool request(const PageRequest& request);

 private:
  using milliseconds = std::chrono::milliseconds;

  void run(const std::stop_token& ending);
  void converse(ConsoleClient& console, const std::stop_token& ending);
  // The modes of each verb of the page, as far as the controller has it.
  [[nodiscard]] WebBoard::Json learn_verbs(ConsoleClient& console);
  [[nodiscard]] bool look(ConsoleClient& console);
  [[nodiscard]] bool look_at_log(ConsoleClient& console);
  [[nodiscard]] bool look_at_candidate(ConsoleClient& console);
  [[nodiscard]] bool pass_on(ConsoleClient& console);
  void hear(ConsoleClient& console, const std::stop_token& ending);
  void said(std::string line);
  // The sigma of an axis among `values`; the joint is that of `joint_key`.
  void tell_axis(const WebBoard::Values& values, std::string_view joint_key);
  // The reply to `line`. Nothing when the controller has gone, did not answer within `longest`, or
  // when a stop came between and left open whose reply is whose.
  [[nodiscard]] std::optional<std::string> ask(ConsoleClient& console, const std::string& line,
                                               milliseconds longest);
  [[nodiscard]] bool take_stop();
  void tell(std::string_view verb, const std::optional<std::string>& reply);

  std::string path_;
  WebBoard& board_;

  std::mutex mutex_;
  std::optional<PageRequest> wanted_;  // by a viewer
  bool stop_wanted_ = false;

  bool lost_ = false;          // no reply came in time: which reply is whose is no longer known
  bool candidate_due_ = true;  // it may have changed
  bool was_running_ = false;
  unsigned rounds_ = 0;

  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace armsig::tool
