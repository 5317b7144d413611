// SPDX-License-Identifier: MIT
// What the host shows: figures for Prometheus, the table of arms, one arm. Read-only.
#pragma once

#include <string>
#include <string_view>

#include "firmware/fleet/host/database.hpp"
#include "firmware/fleet/host/intake.hpp"

namespace armsig::fleet {

struct Answer {
  int status = 200;
  std::string_view type = "text/html; charset=utf-8";
  std::string body;
};

// Of the request line's path; `database` is null where the record is not there.
[[nodiscard]] Answer answer(std::string_view path, const Intake& intake, Database* database);

}  // namespace armsig::fleet
