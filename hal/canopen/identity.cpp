// SPDX-License-Identifier: MIT
#include "hal/canopen/identity.hpp"

namespace armsig::canopen {
namespace {

constexpr std::uint16_t kIdentityObject = 0x1018;

}  // namespace

void append_identity_requests(cia402::Setup& setup) {
  for (std::uint8_t number = 0; number < hal::kDeviceNumbers; ++number) {
    const auto subindex = static_cast<std::uint8_t>(number + 1);
    setup.push_back({{kIdentityObject, subindex, 0, 0}, cia402::SetupRule::kIfPresent, 0, 0});
  }
}

hal::DriveIdentity identity_of(const AxisConfiguration& axis) {
  return {.device = {},
          .counts_per_revolution = axis.scaling.counts_per_revolution,
          .gear_ratio = axis.scaling.gear_ratio,
          .lead_m = axis.scaling.lead_m,
          .zero_counts = axis.scaling.zero_counts,
          .reversed = axis.scaling.reversed,
          .axis = axis.axis};
}

void take_identity(const cia402::ObjectRequest& request, const cia402::ObjectOutcome& outcome,
                   hal::DriveIdentity& identity) {
  if (request.index != kIdentityObject || request.subindex == 0) return;
  if (request.subindex > hal::kDeviceNumbers) return;
  identity.device[request.subindex - 1U] = outcome.value_or(0);
}

}  // namespace armsig::canopen
