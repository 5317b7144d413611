// SPDX-License-Identifier: MIT
// armsig report: a signature for the eye.
#include "firmware/host_tool/report/report.hpp"

#include <array>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/measurement_options.hpp"
#include "firmware/host_tool/diagnosis/another_arm.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/report/report_input.hpp"

namespace armsig::tool {
namespace {

struct ReportOptions : CommonOptions {
  ReportFiles files;
  CertificateNames names;
  std::string out;
};

std::array<std::pair<const char*, const std::string*>, 11> named_options(
    const CertificateNames& names) {
  return {{{"--serial", &names.serial},
           {"--certificate-number", &names.number},
           {"--laboratory", &names.laboratory},
           {"--customer", &names.customer},
           {"--place", &names.place},
           {"--measured-on", &names.measured_on},
           {"--conditions", &names.conditions},
           {"--operator", &names.operator_name},
           {"--instrument", &names.instrument},
           {"--instrument-serial", &names.instrument_serial},
           {"--instrument-certificate", &names.instrument_certificate}}};
}

Read<void> check_names(const CertificateNames& names, const SignatureRecord& record) {
  for (const auto& [option, text] : named_options(names)) {
    if (auto good = check_option_text(option, *text); !good) return good;
  }
  if (!names.serial.empty() && !record.serial.empty() && names.serial != record.serial) {
    return std::unexpected(Problem{"--serial", 0, 0,
                                   "the signature is of serial number " + shown(record.serial),
                                   "that number, or none"});
  }
  return {};
}

// Pictures of measurements that are not those of the signature would show another arm's errors.
Read<void> check_measurements(const ReportFiles& files, const ReportInput& input) {
  constexpr double kNotItsOwn = 0.05;  // of how far the rows are spread
  const double share = input.measured ? input.measured->missed_share() : 0;
  if (share <= kNotItsOwn) return {};
  return std::unexpected(Problem{
      files.rows.measurements, 0, 0,
      fmt::format("the signature misses half of the rows by {:.0f} % of their spread, or more",
                  100 * share),
      "the measurements that the signature was found from, in the units of their header"});
}

// A certificate is of the measurements that the signature was found from.
Read<void> check_nothing_to_sign(const CertificateNames& names, const ReportInput& input) {
  if (input.certifies() || names.empty()) return {};
  std::string words = other_measurements_in_words(input);  // a sentence, which names the file
  words.pop_back();
  return std::unexpected(
      Problem{"", 0, 0, std::move(words),
              "the measurements that it was found from; without --operator, --instrument and the "
              "other options of the certificate the page is written, and has none"});
}

// Compared with the truth of another arm nothing of the report holds.
Read<void> check_truth(const ReportFiles& files, const ReportInput& input) {
  const SignatureRecord& record = input.record;
  if (!input.truth || record.nominal.limits.size() != record.signature.joint_count()) return {};
  const Farness found = farness_of(record, record.nominal, {});
  const Farness real = farness_of(*input.truth, record.nominal, {});
  if (!is_of_another_arm(real, found)) return {};
  return std::unexpected(Problem{
      files.truth, 0, 0, "it is not of the arm of the signature's nominal model: " + real.words,
      "--truth of the arm that the signature is of"});
}

void print_written(const ReportOptions& options, const nlohmann::ordered_json& report,
                   bool certified, std::size_t bytes) {
  if (options.json) {
    print_json({{"status", 0},
                {"reading_maps", report["reading_maps"]},
                {"verdict", report["verdict"]},
                {"origin", report["about"]["origin"]},
                {"certified", certified},
                {"sweeps", report["sweeps"].size()},
                {"bytes", bytes},
                {"out", options.out}});
    return;
  }
  say("{}", paragraph(report["verdict"]["headline"].get<std::string>(), 0));
  for (const auto& sentence : report["verdict"]["sentences"]) {
    say("{}", paragraph(sentence.get<std::string>()));
  }
  say("\nWritten: {}\nNext: open it in a browser\n", file_in_words(options.out));
}

int run(const ReportOptions& options) {
  const auto apart = check_roles({{"--signature", options.files.signature},
                                  {"--measurements", options.files.rows.measurements},
                                  {"--sensor", options.files.rows.sensor},
                                  {"--truth", options.files.truth}},
                                 {{"--out", options.out}});
  if (!apart) return fail(apart.error(), kBadInput, options);
  auto input = read_report_input(options.files);
  if (!input) return fail(input.error(), kBadInput, options);
  const auto good = check_names(options.names, input->record);
  if (!good) return fail(good.error(), kBadInput, options);
  for (const auto& fits :
       {check_measurements(options.files, *input), check_truth(options.files, *input),
        check_nothing_to_sign(options.names, *input)}) {
    if (!fits) return fail(fits.error(), kNoAnswer, options);
  }
  const std::string other = other_measurements_in_words(*input);
  if (!other.empty()) complain("armsig: warning: {}", other);
  input->names = options.names;
  const auto report = report_json(*input);
  const auto page = report_page(report);
  if (!page) return fail(page.error(), kNoAnswer, options);
  const auto written = write_text_file(options.out, *page);
  if (!written) return fail(written.error(), kBadInput, options);
  print_written(options, report, input->certifies(), page->size());
  return kDone;
}

void add_names(CLI::App& command, CertificateNames& names) {
  command.add_option("--operator", names.operator_name, "who measured, for the certificate");
  command.add_option("--instrument", names.instrument, "what it was measured with");
  command.add_option("--instrument-serial", names.instrument_serial, "its serial number");
  command.add_option("--instrument-certificate", names.instrument_certificate,
                     "number and date of its calibration certificate, by which the lengths are "
                     "traceable");
  command.add_option("--serial", names.serial,
                     "serial number of the arm, where the signature has none");
  command.add_option("--certificate-number", names.number,
                     "number of the certificate (default: the CRC-32 of the signature)");
  command.add_option("--laboratory", names.laboratory, "who issues it: name and address");
  command.add_option("--customer", names.customer, "whom it is issued to: name and address");
  command.add_option("--place", names.place, "where the arm was measured");
  command.add_option("--measured-on", names.measured_on, "day or days of the measurements");
  command.add_option("--conditions", names.conditions,
                     "load, warm-up, temperature and whatever else influences the result");
}

}  // namespace

void add_report(CLI::App& app, int& status) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command =
      app.add_subcommand("report", "a page that shows the signature (HTML, readable offline)");
  command->add_option("--signature", options->files.signature, "signature (YAML)")->required();
  add_measurement_options(*command, options->files.rows,
                          "what it was identified from (CSV): adds sweeps and free poses; with "
                          "other measurements the page says so, and has no certificate");
  command->add_option("--truth", options->files.truth,
                      "exact signature of the arm (YAML), where it is simulated");
  add_names(*command, options->names);
  command->add_option("-o,--out", options->out, "page to write (HTML)")->required();
  add_common(*command, *options);
  command->callback([options, &status] { status = run(*options); });
}

}  // namespace armsig::tool
