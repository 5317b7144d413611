// SPDX-License-Identifier: MIT
#include <algorithm>

#include "firmware/host_tool/console/web_server.hpp"

namespace armsig::tool {

std::optional<std::size_t> WebViewers::begin(const std::string& viewer) {
  auto* const place = std::ranges::find(looking_, std::string());
  if (place == looking_.end()) return std::nullopt;
  if (holder_.empty()) holder_ = viewer;
  *place = viewer;
  return static_cast<std::size_t>(place - looking_.begin());
}

void WebViewers::take_over(const std::string& viewer) {
  if (looks(viewer)) holder_ = viewer;
}

bool WebViewers::looks(const std::string& viewer) const {
  return std::ranges::find(looking_, viewer) != looking_.end();
}

bool WebViewers::holds(const std::string& viewer) const {
  return holder_ == viewer && looks(viewer);
}

WebBoard::Json WebViewers::told(const std::string& viewer) const {
  const auto count = std::ranges::count_if(looking_, [](const auto& one) { return !one.empty(); });
  return {{"holds", holder_ == viewer}, {"free", !looks(holder_)}, {"viewers", count}};
}

}  // namespace armsig::tool
