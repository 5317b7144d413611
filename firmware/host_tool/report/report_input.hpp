// SPDX-License-Identifier: MIT
// What a report is made from.
#pragma once

#include <optional>
#include <string>

#include "firmware/formats/signature_record.hpp"
#include "firmware/host_tool/report/certificate.hpp"
#include "firmware/host_tool/report/measured_sweeps.hpp"

namespace armsig::tool {

// Files by their paths; all but the signature may be empty.
struct ReportFiles {
  std::string signature;
  RowSource rows;     // what it was identified from, or measured later
  std::string truth;  // exact signature, where the arm is simulated
};

// A file that the report is made from: its name, and the CRC-32 of its content.
struct ReportSource {
  std::string name;
  std::string crc32;
};

struct ReportInput {
  SignatureRecord record;
  ReportSource signature;  // its own crc32 line
  std::optional<MeasuredSweeps> measured;
  std::optional<ReportSource> measurements;
  std::optional<SignatureRecord> truth;  // where the arm is simulated
  CertificateNames names;

  // The certificate is of the rows that the signature was found from: with others there is none.
  [[nodiscard]] bool certifies() const { return !measured || measured->match.is_origin(); }
};

// What the measurements are where they are not those of the signature; empty where they are, and
// where there are none.
[[nodiscard]] std::string other_measurements_in_words(const ReportInput& input);

[[nodiscard]] Read<ReportInput> read_report_input(const ReportFiles& files);

}  // namespace armsig::tool
