// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/identify_places.hpp"

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/places/place_report.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/signature/record.hpp"

namespace armsig::tool {
namespace {

// What is about positions and ranges has no meaning here.
Read<void> check_place_options(const IdentifyOptions& options) {
  const RowSource& rows = options.rows;
  const auto refuse = [](const char* option) {
    return std::unexpected(
        Problem{option, 0, 0, "is not for touches of an instrument", "--instrument without it"});
  };
  if (!rows.sensor.empty()) return refuse("--sensor");
  if (!rows.columns.empty()) return refuse("--columns");
  if (!options.correct.empty()) return refuse("--correct");
  if (options.explain) return refuse("--explain");
  if (options.method != kBestMethod && options.method != "refined") return refuse("--method");
  if (auto apart = check_roles({{"--arm", options.arm},
                                {"--measurements", rows.measurements},
                                {"--instrument", options.instrument}},
                               {{"--out", options.out}});
      !apart) {
    return apart;
  }
  return check_option_text("--serial", options.serial);
}

// Where it comes from; touches have no positions by which rows are known again.
Origin place_origin(const IdentifyOptions& options, const PlaceCalibration& found) {
  Origin origin;
  origin.arm = shown(options.arm);
  origin.measurements = shown(options.rows.measurements);
  origin.options = "--instrument " + shown(options.instrument);
  origin.rows = found.task->touches.size();
  return origin;
}

SignatureRecord record_of_places(const IdentifyOptions& options, const ArmDescription& arm,
                                 PlaceCalibration& found) {
  Identified identified{.signature = found.outcome.refined->signature,
                        .counts = {},
                        .air_celsius = {},
                        .warnings = found.warnings};
  identified.counts.rows = found.task->touches.size();
  SignatureRecord record = record_of(identified, arm, "refined", options.serial);
  record.origin = place_origin(options, found);
  add_refinement(record, found.outcome, 0, Evidence{.arm = arm.arm, .rows = {}});
  return record;
}

}  // namespace

Attempt<ExitStatus> identify_by_places(const IdentifyOptions& options) {
  if (auto checked = check_place_options(options); !checked) {
    return std::unexpected(std::move(checked).error());
  }
  ARMSIG_TRY(arm, read_arm(options.arm));
  ARMSIG_TRY(description, read_instrument_file(options.instrument));
  const JointTypes types = types_of(arm.arm.joints);
  ARMSIG_TRY(touches, read_touches(options.rows.measurements, types, description));
  auto found =
      calibrate_by_places(place_task(arm.arm, description, touches), options.rows.measurements);
  if (!found) return no_answer(std::move(found).error());
  const SignatureRecord record = record_of_places(options, arm, *found);
  if (auto written = write_signature_file(options.out, record); !written) {
    return std::unexpected(std::move(written).error());
  }
  for (const std::string& warning : record.warnings) {
    complain("armsig: warning: {}", shown(warning));
  }
  if (options.json) {
    print_json(json_of(*found, record, options.out));
    return kDone;
  }
  print_place_calibration(*found, record, options.rows.measurements, options.out);
  TypedCommand report("report");
  report.file_option("--signature", options.out).option("--out", "report.html");
  if (is_there_to_read(options.out)) say_next(report);
  return kDone;
}

}  // namespace armsig::tool
