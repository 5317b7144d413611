// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/fetch.hpp"

#include <ctime>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/console/fetching.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

std::string what_of(const FetchOptions& options) {
  if (!options.what.empty()) return options.what;
  return options.file.ends_with(".csv") ? "log" : "signature";
}

std::string utc(std::int64_t seconds) {
  const auto time = seconds > 0 ? static_cast<std::time_t>(seconds) : std::time(nullptr);
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

SignatureRecord file_record(const controller::SignatureRecord& fetched, const Arm& drawing,
                            const FetchOptions& options) {
  SignatureRecord record;
  record.signature = fetched.signature;
  record.arm_name = options.name;
  record.serial = options.serial;
  record.method = "encoder";
  record.nominal = drawing;
  record.air_c = fetched.air_celsius;
  record.time = utc(fetched.identified_at_s);
  record.version = ARMSIG_VERSION;
  if (!fetched.deflections.empty()) {
    record.deflections = std::make_shared<calibration::ArmModel>(
        calibration::unpacked(fetched.deflections, drawing));
  }
  return record;
}

// The number of the target that the log's rows follow: the candidate's, which is of the same run,
// else that of the signature in use.
int target_number(Fetcher& fetcher, const Arm& drawing) {
  for (const char* what : {"candidate", "signature"}) {
    const auto record = fetcher.record(what, drawing);
    if (record && !record->signature.targets.empty()) return record->signature.targets[0].number;
  }
  return 1;
}

Read<std::size_t> write_log(Fetcher& fetcher, const Arm& drawing, const FetchOptions& options) {
  MeasurementLayout layout;
  layout.types = types_of(drawing.joints);
  layout.sigma = true;
  layout.comment =
      "fetched from a controller: readings of the joints, whatever couples their motors";
  ARMSIG_TRY(rows, fetcher.log(layout.types));
  const int target = target_number(fetcher, drawing);
  ARMSIG_TRY(writer, MeasurementWriter::create(options.file, layout));
  for (MeasurementRow& row : rows) {
    row.target = target;
    writer.write(row);
  }
  if (auto written = writer.commit(); !written) return std::unexpected(written.error());
  return rows.size();
}

int tell(const FetchOptions& options, std::string_view what, std::string_view words,
         std::string_view next, const nlohmann::ordered_json& details) {
  if (options.json) {
    nlohmann::ordered_json result{{"status", 0}, {"fetched", what}, {"out", options.file}};
    result.update(details);
    print_json(result);
  } else {
    say("{}\nWritten: {}\nNext: {}\n", words, options.file, next);
  }
  return kDone;
}

int fetch_record(Fetcher& fetcher, const Arm& drawing, const std::string& what,
                 const FetchOptions& options) {
  const auto fetched = fetcher.record(what, drawing);
  if (!fetched) return fail(fetched.error(), kNoAnswer, options);
  const auto written = write_signature_file(options.file, file_record(*fetched, drawing, options));
  if (!written) return fail(written.error(), kBadInput, options);
  return tell(
      options, what,
      fmt::format("{}: {} joints, {:.3f} mm RMS on the poses held out, air {:.1f} degrees C",
                  what == "candidate" ? "The candidate" : "The signature in use",
                  fetched->signature.joint_count(), 1e3 * fetched->held_out_rms_m,
                  fetched->air_celsius),
      fmt::format("armsig report --signature {} --out report.html", options.file),
      {{"joints", fetched->signature.joint_count()},
       {"sequence", fetched->sequence},
       {"held_out_rms_m", fetched->held_out_rms_m},
       {"predicted_sigma_m", fetched->predicted_sigma_m},
       {"air_c", fetched->air_celsius}});
}

}  // namespace

int fetch(ConsoleClient& console, const FetchOptions& options) {
  for (const auto& [option, text] :
       {std::pair{"--name", &options.name}, std::pair{"--serial", &options.serial}}) {
    const auto good = check_option_text(option, *text);
    if (!good) return fail(good.error(), kBadInput, options);
  }
  Fetcher fetcher(console, options.console, options.longest);
  const auto drawing = fetcher.drawing();
  if (!drawing) return fail(drawing.error(), kNoAnswer, options);
  const std::string what = what_of(options);
  if (what == "drawing") {
    const auto written = write_arm_file(options.file, {.name = options.name, .arm = *drawing});
    if (!written) return fail(written.error(), kBadInput, options);
    return tell(options, what, fmt::format("The drawing: {} joints", drawing->joints.size()),
                fmt::format("armsig connect {} fetch log.csv", options.console),
                {{"joints", drawing->joints.size()}});
  }
  if (what == "log") {
    const auto rows = write_log(fetcher, *drawing, options);
    if (!rows) return fail(rows.error(), kNoAnswer, options);
    return tell(options, what, fmt::format("What was measured: {} points", *rows),
                fmt::format("armsig connect {} fetch arm.yaml --what drawing, then armsig identify "
                            "--arm arm.yaml --measurements {}",
                            options.console, options.file),
                {{"rows", *rows}});
  }
  return fetch_record(fetcher, *drawing, what, options);
}

}  // namespace armsig::tool
