// SPDX-License-Identifier: MIT
// The gear of a joint whose target goes round a small circle: its sweep tells badly how far the
// joint turns for its reading, and another pose turns the whole arm by that.
#pragma once

#include <cstddef>
#include <optional>

#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

struct UnseenGear {
  std::size_t joint = 0;
  double sigma = 0;    // of the joint's turn over its reading, by its sweep
  double moved_m = 0;  // what so much does to the tool, RMS over the joint limits
};

// Of the turning joints whose gear was taken as exact, that which may move the tool most; nothing
// where all of them do little beside the tool error that the record predicts.
[[nodiscard]] std::optional<UnseenGear> least_seen_gear(const SignatureRecord& record);

}  // namespace armsig::tool
