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
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/console/fetching.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"

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
  record.method = controller::kMethods[static_cast<std::size_t>(fetched.method)];
  record.accuracy = fetched.accuracy;
  record.controller_signature = fetched.sequence;
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

// `next`: one after the other.
int tell(const FetchOptions& options, std::string_view what, std::string_view words,
         const std::vector<TypedCommand>& next, const nlohmann::ordered_json& details) {
  if (options.json) {
    nlohmann::ordered_json result{{"status", 0}, {"fetched", what}, {"out", options.file}};
    result.update(details);
    print_json(result);
  } else {
    say("{}\nWritten: {}\n", words, options.file);
    for (const TypedCommand& command : next) say_next(command);
  }
  return kDone;
}

void add_accuracy(const ToolAccuracy& accuracy, nlohmann::ordered_json& details) {
  if (accuracy.predicted) {
    details["predicted_tool_error_m"] = accuracy.predicted->rms_m;
    details["predicted_region"] = name(accuracy.predicted->region);
  }
  if (!accuracy.validated) return;
  details["validation_rms_m"] = accuracy.validated->rms_m;
  if (accuracy.validated->poses > 0) details["validation_poses"] = accuracy.validated->poses;
}

// A figure a line.
std::string accuracy_in_words(const ToolAccuracy& accuracy) {
  std::string words;
  if (accuracy.predicted) {
    words +=
        fmt::format("  predicted tool error, 1 sigma: {:.3f} mm RMS over {}\n",
                    1e3 * accuracy.predicted->rms_m, region_in_words(accuracy.predicted->region));
  }
  if (accuracy.validated) {
    const auto poses = accuracy.validated->poses;
    words += fmt::format("  on {}validation poses, with the sensor's noise: {:.3f} mm RMS\n",
                         poses > 0 ? fmt::format("{} ", poses) : std::string(),
                         1e3 * accuracy.validated->rms_m);
  }
  return words.empty() ? "  its accuracy is not recorded" : words.substr(0, words.size() - 1);
}

int fetch_record(Fetcher& fetcher, const Arm& drawing, const std::string& what,
                 const FetchOptions& options) {
  const auto fetched = fetcher.record(what, drawing);
  if (!fetched) return fail(fetched.error(), kNoAnswer, options);
  const SignatureRecord record = file_record(*fetched, drawing, options);
  const auto written = write_signature_file(options.file, record);
  if (!written) return fail(written.error(), kBadInput, options);
  nlohmann::ordered_json details{{"joints", fetched->signature.joint_count()},
                                 {"signature", fetched->sequence},
                                 {"method", record.method},
                                 {"air_c", fetched->air_celsius}};
  add_accuracy(fetched->accuracy, details);
  const std::string which = what == "candidate"
                                ? std::string("The candidate")
                                : fmt::format("Signature {}, in use", fetched->sequence);
  return tell(options, what,
              fmt::format("{}: {}, method {}, air {:.1f} degrees C\n{}", which,
                          counted(fetched->signature.joint_count(), "joint"), record.method,
                          fetched->air_celsius, accuracy_in_words(fetched->accuracy)),
              {TypedCommand("report")
                   .file_option("--signature", options.file)
                   .option("--out", "report.html")},
              details);
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
  if (what == "nominal") {
    const auto written = write_arm_file(options.file, {.name = options.name, .arm = *drawing});
    if (!written) return fail(written.error(), kBadInput, options);
    return tell(options, what, "The nominal model: " + counted(drawing->joints.size(), "joint"),
                {TypedCommand("plan")
                     .file_option("--arm", options.file)
                     .option("--out", "sweeps-to-measure.csv")},
                {{"joints", drawing->joints.size()}});
  }
  if (what == "log") {
    const auto rows = write_log(fetcher, *drawing, options);
    if (!rows) return fail(rows.error(), kNoAnswer, options);
    return tell(options, what, "What was measured: " + counted(*rows, "point"),
                {TypedCommand("connect")
                     .file(options.console)
                     .word("fetch")
                     .word("arm.yaml")
                     .option("--what", "nominal"),
                 TypedCommand("identify")
                     .option("--arm", "arm.yaml")
                     .file_option("--measurements", options.file)
                     .option("--out", "signature.yaml")},
                {{"rows", *rows}});
  }
  return fetch_record(fetcher, *drawing, what, options);
}

}  // namespace armsig::tool
