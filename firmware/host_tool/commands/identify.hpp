// SPDX-License-Identifier: MIT
// What `armsig identify` does with its options, for itself and for the demonstration.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/presentation/identify_report.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"

namespace armsig::tool {

// The method is chosen by the rows.
inline constexpr const char* kBestMethod = "auto";

struct IdentifyOptions : CommonOptions {
  RowSource rows;
  std::string arm, out, serial;
  std::string method = kBestMethod;
  std::vector<std::string> correct;
  std::string instrument;  // description, where the rows are touches; empty: they are positions
  bool accept_different_arm = false;
  bool explain = false;  // say which models were tried
};

struct IdentifiedFile {
  Found found;
  SignatureRecord record;  // as written, its warnings included
  std::size_t receivers = 0;
};

// Reads, identifies, judges, and writes the signature. Prints nothing of the result.
[[nodiscard]] Attempt<IdentifiedFile> identify_file(IdentifyOptions options);

}  // namespace armsig::tool
