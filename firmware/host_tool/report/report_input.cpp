// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/report_input.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>

#include <fmt/core.h>

#include "core/base/crc32.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/signature/record.hpp"

namespace armsig::tool {
namespace {

// As eight hexadecimal digits, like the last line of a signature file.
Read<std::string> crc32_of_file(const std::string& path) {
  auto file = open_file(path);
  if (!file) return std::unexpected(file.error());
  std::array<std::byte, 65536> buffer;
  std::uint32_t crc = 0;
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), file->get())) {
    crc = crc32(std::span(buffer).first(size), crc);
  }
  return fmt::format("0x{:08X}", crc);
}

Read<std::string> stated_crc32(const SignatureRecord& record) {
  auto text = signature_text(record);
  if (!text) return std::unexpected(text.error());
  const std::size_t at = text->rfind(kCrcKey) + kCrcKey.size() + 2;
  return text->substr(at, text->find('\n', at) - at);
}

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

Read<ReportInput> read_report_input(const ReportFiles& files) {
  ReportInput input;
  ARMSIG_TRY(record, read_signature_file(files.signature));
  ARMSIG_TRY(crc, stated_crc32(record));
  input.record = record;
  input.signature = {name_of(files.signature), crc};
  if (!files.measurements.empty()) {
    std::optional<SensorDescription> sensor;
    if (!files.sensor.empty()) {
      ARMSIG_TRY(read, read_checked_sensor(files.sensor));
      sensor = read;
    }
    ARMSIG_TRY(measured, read_measured_sweeps(files.measurements, record, sensor));
    ARMSIG_TRY(measurements_crc, crc32_of_file(files.measurements));
    input.measured = measured;
    input.measurements = {name_of(files.measurements), measurements_crc};
  }
  if (!files.truth.empty()) {
    ARMSIG_TRY(truth, read_signature_file(files.truth));
    if (!std::ranges::equal(truth.signature.types, record.signature.types)) {
      return std::unexpected(Problem{files.truth, 0, 0, "its joints are not those of the signature",
                                     "the exact signature of the same arm"});
    }
    input.truth = truth;
  }
  return input;
}

}  // namespace armsig::tool
