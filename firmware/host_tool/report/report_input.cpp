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
#include "firmware/formats/characters.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text_file.hpp"

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

std::string other_measurements_in_words(const ReportInput& input) {
  if (input.certifies()) return {};
  const OriginMatch& match = input.measured->match;
  const std::string file = shown(input.measurements->name);
  if (!match.stated) {
    return fmt::format(
        "The signature does not say which measurements it was found from. Whether they are those "
        "of "
        "{} is not known, and there is no certificate.",
        file);
  }
  const std::string origin = name_of(input.record.origin->measurements);
  if (match.same_rows) {
    return fmt::format(
        "The ranges of {} are those that the signature was found from, by another sensor "
        "description. There is no certificate.",
        file);
  }
  return fmt::format(
      "{} holds other measurements than {}, from which the signature was found: it was fitted to "
      "{}. They are shown beside the signature, and there is no certificate.",
      file, origin, fitted_in_words(match));
}

Read<ReportInput> read_report_input(const ReportFiles& files) {
  ReportInput input;
  ARMSIG_TRY(record, read_signature_file(files.signature));
  ARMSIG_TRY(crc, stated_crc32(record));
  input.record = record;
  input.signature = {name_of(files.signature), crc};
  if (const std::string& file = files.rows.measurements; !file.empty()) {
    ARMSIG_TRY(rows,
               open_rows(files.rows, record.nominal, {record.signature.types, record.joint_names}));
    ARMSIG_TRY(measured, read_measured_sweeps(rows, record));
    ARMSIG_TRY(measurements_crc, crc32_of_file(file));
    input.measured = measured;
    input.measurements = {name_of(file), measurements_crc};
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
