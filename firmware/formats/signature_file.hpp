// SPDX-License-Identifier: MIT
// Signature files, signature/1 (docs/formats.md). Numbers have 17 significant digits, so that a
// signature read back is the one written, bit for bit.
#pragma once

#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

inline constexpr std::string_view kSignatureTag = "signature/1";

// Refuses a file whose crc32 is absent or does not match, that lacks anything or holds anything
// unknown, or whose parts contradict one another: base pose and first axis, reading offset and
// pseudo-DH, pseudo-DH and link frames (see signature_agreement.hpp).
[[nodiscard]] Read<SignatureRecord> read_signature_file(const std::string& path);
[[nodiscard]] Read<SignatureRecord> parse_signature(std::string_view text, std::string_view file);

// The file's text with its header comment and crc32. Refuses a record that could not be read back:
// counts that differ, a number that is not finite, a rotation that is none.
[[nodiscard]] Read<std::string> signature_text(const SignatureRecord& record);

// Writes atomically: the file is complete or it is not there.
[[nodiscard]] Read<void> write_signature_file(const std::string& path,
                                              const SignatureRecord& record);

}  // namespace armsig::tool
