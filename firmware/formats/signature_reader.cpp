// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/deflections.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/signature_agreement.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/signature_joint_reader.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/formats/yaml_matrix.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kLargestCovariance = 256;

Read<void> read_joints(const YamlMap& root, SignatureRecord& record) {
  Signature& signature = record.signature;
  ARMSIG_TRY(list_node, root.require("joints"));
  ARMSIG_TRY(list, read_list(*list_node, "joints", 1, kMaxJoints));
  for (const YamlNode& node : *list) {
    if (auto joint = read_signature_joint(node, record); !joint) return joint;
  }
  if (auto named = check_joint_names(*list_node, signature.joint_count(), record.joint_names);
      !named) {
    return named;
  }
  const auto fitted = [](const calibration::ReadingTerms& terms) {
    return terms.gain || terms.first || terms.second;
  };
  if (std::ranges::none_of(record.fitted.readings, fitted)) {
    record.fitted.readings.clear();
    record.corrections.clear();
  }
  if (!signature.features.empty() && signature.features.size() != signature.joint_count()) {
    return problem_at(*list_node,
                      fmt::format("{} of {} joints have a sweep", signature.features.size(),
                                  signature.joint_count()),
                      "a sweep for every joint, or for none");
  }
  ARMSIG_TRY(last_node, root.require("last_link"));
  ARMSIG_TRY(last, YamlMap::open(*last_node, "last_link",
                                 {"origin_m", "x_direction", "y_direction", "z_direction"}));
  ARMSIG_TRY(R, read_rotation(last, "z_direction"));
  ARMSIG_TRY(origin_S, last.vector3("origin_m"));
  signature.X_SL.push_back(Pose{R, origin_S});
  return {};
}

Read<Pose> read_base(const YamlMap& root) {
  ARMSIG_TRY(node, root.require("base"));
  ARMSIG_TRY(map, YamlMap::open(*node, "base", {"position_m", "quaternion_wxyz"}));
  ARMSIG_TRY(p, map.vector3("position_m"));
  ARMSIG_TRY(quaternion_node, map.require("quaternion_wxyz"));
  ARMSIG_TRY(w, read_numbers(*quaternion_node, "quaternion_wxyz", 4));
  const Eigen::Quaterniond q(w[0], w[1], w[2], w[3]);
  constexpr double kTolerance = 1e-9;
  if (!(std::abs(q.norm() - 1) < kTolerance)) {
    return problem_at(*quaternion_node, fmt::format("a quaternion of length {}", q.norm()),
                      "a unit quaternion w, x, y, z");
  }
  return Pose{q.toRotationMatrix(), p};
}

Read<void> read_targets(const YamlMap& root, Signature& signature) {
  constexpr int kLowest = std::numeric_limits<int>::min();
  constexpr int kHighest = std::numeric_limits<int>::max();
  ARMSIG_TRY(list_node, root.require("targets"));
  ARMSIG_TRY(list, read_list(*list_node, "targets", 0, kMaxTargets));
  for (const YamlNode& node : *list) {
    ARMSIG_TRY(map, YamlMap::open(node, fmt::format("target {}", signature.targets.size() + 1),
                                  {"number", "link", "position_m", "covariance_m2"}));
    Target target;
    ARMSIG_TRY(number, map.integer("number", kLowest, kHighest));
    ARMSIG_TRY(link, map.integer("link", 1, static_cast<int>(signature.joint_count())));
    ARMSIG_TRY(p_S, map.vector3("position_m"));
    ARMSIG_TRY(covariance_node, map.require("covariance_m2"));
    ARMSIG_TRY(covariance, read_covariance(*covariance_node, "covariance_m2", 3, 3));
    for (const Target& earlier : signature.targets) {
      if (earlier.number != number) continue;
      return problem_at(node, fmt::format("target {} is given twice", number), "each number once");
    }
    target.number = number;
    target.link = static_cast<std::size_t>(link);
    target.p_S = p_S;
    target.covariance_m2 = covariance;
    signature.targets.push_back(target);
  }
  return {};
}

// What says where the signature comes from.
Read<void> read_origin(const YamlMap& root, SignatureRecord& record) {
  ARMSIG_TRY(arm_name, root.name_under("name"));
  ARMSIG_TRY(serial_node, root.require("serial"));
  ARMSIG_TRY(serial, read_name(*serial_node, "serial"));
  ARMSIG_TRY(method, root.text("method"));
  constexpr std::array<std::string_view, 4> kMethods{"paper", "encoder", "refined", "exact"};
  if (std::ranges::find(kMethods, method) == kMethods.end()) {
    return problem_at(*root.find("method"), "method: " + in_quotes(method),
                      "paper, encoder, refined or exact");
  }
  ARMSIG_TRY(time, root.text("time"));
  if (!is_utc_time(time)) {
    return problem_at(*root.find("time"), "time: " + in_quotes(time),
                      "UTC like 1986-04-07T12:00:00Z");
  }
  ARMSIG_TRY(version, root.name_under("version"));
  record.arm_name = arm_name;
  record.serial = serial;
  record.method = method;
  record.time = time;
  record.version = version;
  return {};
}

constexpr int kMostRows = 2'000'000'000;

Read<FitRecord> read_fit(const YamlNode& node) {
  ARMSIG_TRY(map, YamlMap::open(node, "fit",
                                {"rows_used", "rows_rejected", "rms_m", "left_out_rows",
                                 "left_out_mean_m", "left_out_rms_m", "rows_merged_to"}));
  ARMSIG_TRY(used, map.integer("rows_used", 0, kMostRows));
  ARMSIG_TRY(rejected, map.integer("rows_rejected", 0, kMostRows));
  ARMSIG_TRY(rms_m, map.number("rms_m"));
  FitRecord fit{static_cast<std::size_t>(used), static_cast<std::size_t>(rejected), rms_m, {}, 0};
  if (map.find("rows_merged_to") != nullptr) {
    ARMSIG_TRY(merged, map.integer("rows_merged_to", 1, kMostRows));
    fit.rows_merged_to = static_cast<std::size_t>(merged);
  }
  if (map.find("left_out_rows") == nullptr) return fit;
  ARMSIG_TRY(rows, map.integer("left_out_rows", 1, kMostRows));
  ARMSIG_TRY(mean_m, map.number("left_out_mean_m"));
  ARMSIG_TRY(left_out_rms_m, map.number("left_out_rms_m"));
  fit.left_out = FitRecord::LeftOut{static_cast<std::size_t>(rows), mean_m, left_out_rms_m};
  return fit;
}

// What was found of the sensor.
Read<void> read_sensor_errors(const YamlMap& root, SignatureRecord& record) {
  if (const YamlNode* node = root.find("range_offsets_m")) {
    ARMSIG_TRY(list, read_list(*node, "range_offsets_m", 1, kMaxReceivers));
    ARMSIG_TRY(offsets_m, read_numbers(*node, "range_offsets_m", list->size()));
    for (const double offset_m : offsets_m) record.receiver_offsets_m.push_back(offset_m);
    record.fitted.receiver_offsets = true;
  }
  if (root.find("length_scale") != nullptr) {
    ARMSIG_TRY(scale, root.number("length_scale"));
    record.scale = scale;
    record.fitted.scale = true;
  }
  return {};
}

// A number that a signature may have and need not: then `value` stays.
template <typename Value>
Read<void> read_if_there(const YamlMap& root, std::string_view key, Value& value) {
  if (root.find(key) == nullptr) return {};
  ARMSIG_TRY(number, root.number(key));
  value = number;
  return {};
}

Read<void> read_numbers(const YamlMap& root, SignatureRecord& record) {
  auto done = read_if_there(root, "air_c", record.air_c);
  if (done) done = read_if_there(root, "sigma_m", record.sigma_m);
  if (done) done = read_if_there(root, "unexplained_m", record.unexplained_m);
  if (done) done = read_if_there(root, "noise_freedom", record.noise_freedom);
  return done;
}

Read<double> read_length(const YamlMap& map, std::string_view key) {
  ARMSIG_TRY(length_m, map.number(key));
  if (length_m >= 0) return length_m;
  return problem_at(*map.find(key), fmt::format("{}: {}", key, length_m), "no negative length");
}

Read<PredictedRegion> read_region(const YamlMap& map) {
  ARMSIG_TRY(region, map.text("predicted_region"));
  const auto* const found = std::ranges::find(kPredictedRegions, region);
  if (found != kPredictedRegions.end()) {
    return static_cast<PredictedRegion>(found - kPredictedRegions.begin());
  }
  return problem_at(*map.find("predicted_region"), "predicted_region: " + in_quotes(region),
                    fmt::format("{}", fmt::join(kPredictedRegions, ", ")));
}

// A predicted error without its region is refused.
Read<void> read_accuracy(const YamlNode& node, SignatureRecord& record) {
  ARMSIG_TRY(map, YamlMap::open(node, "accuracy",
                                {"controller_signature", "predicted_tool_error_m",
                                 "predicted_region", "validation_rms_m", "validation_poses"}));
  if (map.find("controller_signature") != nullptr) {
    ARMSIG_TRY(number, map.integer("controller_signature", 1, std::numeric_limits<int>::max()));
    record.controller_signature = static_cast<std::uint32_t>(number);
  }
  if (map.find("predicted_tool_error_m") != nullptr) {
    ARMSIG_TRY(rms_m, read_length(map, "predicted_tool_error_m"));
    ARMSIG_TRY(region, read_region(map));
    record.accuracy.predicted = {rms_m, region};
  }
  if (map.find("validation_rms_m") != nullptr) {
    ARMSIG_TRY(rms_m, read_length(map, "validation_rms_m"));
    record.accuracy.validated = {rms_m, 0};
  }
  if (record.accuracy.validated && map.find("validation_poses") != nullptr) {
    ARMSIG_TRY(poses, map.integer("validation_poses", 1, kMostRows));
    record.accuracy.validated->poses = static_cast<std::uint32_t>(poses);
  }
  return {};
}

// What else it may have.
Read<void> read_extras(const YamlMap& root, SignatureRecord& record) {
  if (const YamlNode* node = root.find("accuracy")) {
    if (auto read = read_accuracy(*node, record); !read) return read;
  }
  if (const YamlNode* node = root.find("fit")) {
    ARMSIG_TRY(fit, read_fit(*node));
    record.fit = fit;
  }
  if (const YamlNode* node = root.find("warnings")) {
    constexpr std::size_t kMostWarnings = 1000;
    ARMSIG_TRY(warnings, read_list(*node, "warnings", 0, kMostWarnings));
    for (const YamlNode& item : *warnings) {
      ARMSIG_TRY(warning, read_text(item, "a warning"));
      record.warnings.push_back(warning);
    }
  }
  ARMSIG_TRY(origin, read_origin_section(root));
  record.origin = origin;
  if (const YamlNode* node = root.find("coupling")) {
    ARMSIG_TRY(couplings, read_couplings(*node, record.nominal.joints));
    record.nominal.couplings = couplings;
  }
  ARMSIG_TRY(mounting, read_mounting(root));
  record.mounting = mounting;
  record.nominal.up_0 = -clearance::gravity_B(record.nominal, mounting);
  if (const YamlNode* node = root.find("covariance")) {
    ARMSIG_TRY(covariance_of, root.text("covariance_of"));
    ARMSIG_TRY(covariance, read_covariance(*node, "covariance", 1, kLargestCovariance));
    record.covariance_of = covariance_of;
    record.covariance = covariance;
  }
  return {};
}

std::vector<std::string> keys_of_a_signature() {
  std::vector<std::string> keys{
      "armsig",      "name",    "serial",          "method",        "time",
      "version",     "air_c",   "sigma_m",         "unexplained_m", "noise_freedom",
      "accuracy",    "fit",     "range_offsets_m", "length_scale",  "warnings",
      "origin",      "base",    "joints",          "last_link",     "coupling",
      "deflections", "targets", "covariance_of",   "covariance",    std::string(kCrcKey)};
  add_mounting_keys(keys);
  return keys;
}

Read<SignatureRecord> record_from(const YamlNode& root) {
  if (auto tag = check_tag(root, kSignatureTag); !tag) {
    return std::unexpected(std::move(tag).error());
  }
  if (root.keys.front().text != "armsig") {
    return problem_at(root.keys.front(), "the first key is " + in_quotes(root.keys.front().text),
                      fmt::format("armsig: {}", kSignatureTag));
  }
  if (auto seal = check_seal(root); !seal) return std::unexpected(std::move(seal).error());
  ARMSIG_TRY(map, YamlMap::open(root, "the signature", keys_of_a_signature()));
  SignatureRecord record;
  ARMSIG_TRY(X_S0, read_base(map));
  auto done = read_origin(map, record);
  if (done) done = read_joints(map, record);
  if (done) done = read_numbers(map, record);
  if (done) done = read_extras(map, record);
  if (done) done = read_deflections(map, record);
  if (done) done = read_sensor_errors(map, record);
  if (done) done = read_targets(map, record.signature);
  if (done) done = check_agreement(record.signature, X_S0);
  if (!done) return std::unexpected(std::move(done).error());
  return record;
}

}  // namespace

Read<SignatureRecord> parse_signature(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<SignatureRecord> {
    ARMSIG_TRY(root, parse_yaml(text));
    return record_from(root);
  };
  return in_file(file, parse());
}

Read<SignatureRecord> read_signature_file(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path, kLargestSignature));
  return parse_signature(text, path);
}

}  // namespace armsig::tool
