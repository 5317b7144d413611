// SPDX-License-Identifier: MIT
// What the controller's console says, as readings. Keys that are not known are passed over, values
// that are no numbers are left out: a newer controller is no reason to stop.
#pragma once

#include <string_view>
#include <vector>

#include "firmware/fleet/wire/items.hpp"

namespace armsig::fleet {

// Of the reply to `status`: mode, fault in words, model, sensor, quantiles of the tick's lateness.
// Empty: it is no such reply.
[[nodiscard]] Readings readings_of_status(std::string_view line);

// Of the reply to `signature`: model, hash (SHA-256 of the parameters as they stand in the reply),
// date, uncertainty, air temperature. Empty: it is no such reply.
[[nodiscard]] Readings readings_of_signature(std::string_view line);

// The same with the hash of a document that says more than the reply.
[[nodiscard]] Readings with_hash(Readings signature, std::string_view document);

// The parameters as they stand in that reply: of a signature without maps, gravity and prismatic
// joints its whole document. Empty: there are none.
[[nodiscard]] std::string_view document_of_signature(std::string_view line);

// A signature's document as rows of the journal, each a part with the hash of the whole. None:
// `document` is empty, or longer than a host keeps.
inline constexpr std::uint64_t kMostDocumentParts = 128;
[[nodiscard]] std::vector<Readings> readings_of_document(std::string_view document);

// `# check verdict="..." dx_mm= dy_mm= dz_mm= sigma_mm= poses=`: the verdict of a check with the
// mean residual; of one that could not measure, with its reason and without a residual. Empty: it
// is no such line.
[[nodiscard]] Readings readings_of_check(std::string_view line);

}  // namespace armsig::fleet
