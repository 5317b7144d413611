// SPDX-License-Identifier: MIT
#include "firmware/linux/self_calibrating.hpp"

#include <cstdio>
#include <utility>

#include <fmt/format.h>

namespace armsig::daemon {
namespace {

std::optional<linux_hal::FileMemory> open_points(const DaemonConfiguration& configuration) {
  const std::string path = configuration.store + ".points";
  auto file = linux_hal::FileMemory::open(path, controller::PointJournal::kLayout);
  if (file) return std::move(*file);
  fmt::print(stderr, "armsigd: {}: {}: a self-calibration can't be continued after a restart\n",
             path, describe(file.error()));
  return std::nullopt;
}

}  // namespace

SelfCalibrating::SelfCalibrating(const DaemonConfiguration& configuration)
    : file_(open_points(configuration)),
      calibration_(configuration.controller, memory_, file_ ? &journal_.emplace(*file_) : nullptr) {
}

}  // namespace armsig::daemon
