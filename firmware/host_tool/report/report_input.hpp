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
  std::string measurements;  // what it was identified from
  std::string sensor;        // where those are ranges to receivers
  std::string truth;         // exact signature, where the arm is simulated
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
};

[[nodiscard]] Read<ReportInput> read_report_input(const ReportFiles& files);

}  // namespace armsig::tool
