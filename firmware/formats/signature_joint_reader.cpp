// SPDX-License-Identifier: MIT
#include "firmware/formats/signature_joint_reader.hpp"

#include <array>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/formats/yaml_matrix.hpp"

namespace armsig::tool {
namespace {

constexpr int kMostPoints = 2'000'000'000;

Read<bool> read_flag(const YamlMap& map, std::string_view key) {
  ARMSIG_TRY(node, map.require(key));
  if (node->text == "true") return true;
  if (node->text == "false") return false;
  return problem_at(*node, fmt::format("{}: {}", key, in_quotes(node->text)), "true or false");
}

Read<std::size_t> read_count(const YamlMap& map, std::string_view key) {
  ARMSIG_TRY(count, map.integer(key, 0, kMostPoints));
  return static_cast<std::size_t>(count);
}

Read<features::SweepQuality> read_quality(const YamlMap& map, std::string_view unit) {
  features::SweepQuality quality;
  const std::array numbers{
      std::pair{fmt::format("lowest_reading_{}", unit), &quality.lowest_reading},
      std::pair{fmt::format("highest_reading_{}", unit), &quality.highest_reading},
      std::pair{std::string("residual_normal_m"), &quality.rms_normal_m},
      std::pair{std::string("residual_radial_m"), &quality.rms_radial_m},
      std::pair{std::string("residual_tangential_m"), &quality.rms_tangential_m},
      std::pair{std::string("encoder_ratio"), &quality.encoder_ratio},
      std::pair{std::string("encoder_ratio_sigma"), &quality.encoder_ratio_sigma},
      std::pair{std::string("sigma_m"), &quality.sigma_m}};
  for (const auto& [key, number] : numbers) {
    ARMSIG_TRY(value, map.number(key));
    *number = value;
  }
  ARMSIG_TRY(used, read_count(map, "used"));
  ARMSIG_TRY(rejected, read_count(map, "rejected"));
  ARMSIG_TRY(estimated, read_flag(map, "sigma_is_estimated"));
  quality.used = used;
  quality.rejected = rejected;
  quality.sigma_is_estimated = estimated;
  return quality;
}

Read<features::JointFeature> read_feature(const YamlNode& node, const std::string& joint,
                                          JointType type) {
  const std::string_view unit = si_suffix(type);
  ARMSIG_TRY(map,
             YamlMap::open(
                 node, "sweep of " + joint,
                 {"axis_direction", "point_m", "radial_direction", "radius_m",
                  fmt::format("reference_reading_{}", unit), fmt::format("lowest_reading_{}", unit),
                  fmt::format("highest_reading_{}", unit), "used", "rejected", "residual_normal_m",
                  "residual_radial_m", "residual_tangential_m", "encoder_ratio",
                  "encoder_ratio_sigma", "sigma_m", "sigma_is_estimated", "covariance"}));
  features::JointFeature feature;
  feature.type = type;
  ARMSIG_TRY(axis_S, map.vector3("axis_direction"));
  ARMSIG_TRY(point_S, map.vector3("point_m"));
  ARMSIG_TRY(radial_S, map.vector3("radial_direction"));
  ARMSIG_TRY(radius_m, map.number("radius_m"));
  ARMSIG_TRY(reference, map.number(fmt::format("reference_reading_{}", unit)));
  ARMSIG_TRY(quality, read_quality(map, unit));
  ARMSIG_TRY(covariance_node, map.require("covariance"));
  ARMSIG_TRY(covariance, read_covariance(*covariance_node, "covariance", 7, 7));
  feature.axis_S = axis_S;
  feature.point_S = point_S;
  feature.radial_S = radial_S;
  feature.radius_m = radius_m;
  feature.reference_reading = reference;
  feature.quality = quality;
  feature.covariance = covariance;
  return feature;
}

Read<DhJoint> read_dh(const YamlNode& node, const std::string& name, const std::string& theta_key,
                      JointType type) {
  ARMSIG_TRY(map, YamlMap::open(node, name, {theta_key, "d_m", "a_m", "alpha_rad"}));
  ARMSIG_TRY(theta_rad, map.number(theta_key));
  ARMSIG_TRY(d_m, map.number("d_m"));
  ARMSIG_TRY(a_m, map.number("a_m"));
  ARMSIG_TRY(alpha_rad, map.number("alpha_rad"));
  return DhJoint{type, theta_rad, d_m, a_m, alpha_rad};
}

Read<s_model::Parameters> read_s_model(const YamlNode& node, const std::string& name) {
  ARMSIG_TRY(
      map, YamlMap::open(node, name, {"beta_rad", "d_m", "a_m", "alpha_rad", "gamma_rad", "b_m"}));
  ARMSIG_TRY(beta_rad, map.number("beta_rad"));
  ARMSIG_TRY(d_m, map.number("d_m"));
  ARMSIG_TRY(a_m, map.number("a_m"));
  ARMSIG_TRY(alpha_rad, map.number("alpha_rad"));
  ARMSIG_TRY(gamma_rad, map.number("gamma_rad"));
  ARMSIG_TRY(b_m, map.number("b_m"));
  return s_model::Parameters{beta_rad, d_m, a_m, alpha_rad, gamma_rad, b_m};
}

// What was fitted of the errors of a reading: pairs of cosine and sine, of revolute joints.
Read<void> read_correction(const YamlNode& node, const std::string& name, JointType type,
                           SignatureRecord& record) {
  std::vector<std::string> known{"gain"};
  if (type == JointType::kRevolute) {
    known.insert(known.end(), {"cos_1_rad", "sin_1_rad", "cos_2_rad", "sin_2_rad"});
  }
  ARMSIG_TRY(map, YamlMap::open(node, "reading_correction of " + name, known));
  calibration::ReadingTerms& terms = record.fitted.readings.back();
  calibration::ReadingCorrection& correction = record.corrections.back();
  terms.gain = map.find("gain") != nullptr;
  terms.first = map.find("cos_1_rad") != nullptr || map.find("sin_1_rad") != nullptr;
  terms.second = map.find("cos_2_rad") != nullptr || map.find("sin_2_rad") != nullptr;
  const std::array<std::tuple<bool, std::string_view, double*>, 5> numbers{
      std::tuple{terms.gain, "gain", &correction.gain},
      std::tuple{terms.first, "cos_1_rad", &correction.cos_1},
      std::tuple{terms.first, "sin_1_rad", &correction.sin_1},
      std::tuple{terms.second, "cos_2_rad", &correction.cos_2},
      std::tuple{terms.second, "sin_2_rad", &correction.sin_2}};
  for (const auto& [given, key, number] : numbers) {
    if (!given) continue;
    ARMSIG_TRY(value, map.number(key));
    *number = value;
  }
  return {};
}

// A joint's keys, some of which say the unit of its type.
struct JointKeys {
  explicit JointKeys(const YamlNode& node) {
    // read_joint_type refuses what is neither.
    const YamlNode* type = node.find("type");
    const bool prismatic = type != nullptr && type->text == word_of(JointType::kPrismatic);
    const auto unit = si_suffix(prismatic ? JointType::kPrismatic : JointType::kRevolute);
    reading = fmt::format("reading_{}", unit);
    offset = fmt::format("reading_offset_{}", unit);
    limits = fmt::format("limits_{}", unit);
  }
  [[nodiscard]] std::vector<std::string> known() const {
    return {"name",           "type",
            reading,          offset,
            "pseudo_dh",      "s_model",
            "axis_direction", "axis_point_m",
            "x_direction",    "y_direction",
            "nominal",        "limits",
            limits,           "reading_correction",
            "sweep"};
  }

  std::string reading, offset, limits;
};

Read<JointLimits> read_required_limits(const YamlMap& map, std::string_view key, JointType type) {
  if (map.find("limits") == nullptr) {
    if (auto node = map.require(key); !node) return std::unexpected(std::move(node).error());
  }
  return read_limits(map, type);
}

}  // namespace

Read<void> read_signature_joint(const YamlNode& node, SignatureRecord& record) {
  Signature& signature = record.signature;
  const std::string name = fmt::format("joint {}", signature.types.size() + 1);
  const JointKeys keys(node);
  ARMSIG_TRY(map, YamlMap::open(node, name, keys.known()));
  if (auto named = read_joint_name(map, record.joint_names); !named) return named;
  ARMSIG_TRY(type, read_joint_type(map));
  ARMSIG_TRY(reading, map.number(keys.reading));
  ARMSIG_TRY(offset, map.number(keys.offset));
  ARMSIG_TRY(dh_node, map.require("pseudo_dh"));
  ARMSIG_TRY(dh, read_dh(*dh_node, "pseudo_dh of " + name, "theta_offset_rad", type));
  if (offset != (type == JointType::kRevolute ? dh.theta_rad : dh.d_m)) {
    return problem_at(node, fmt::format("{} of {} is not that of its pseudo_dh", keys.offset, name),
                      "the same number, (19)");
  }
  ARMSIG_TRY(s_node, map.require("s_model"));
  ARMSIG_TRY(s, read_s_model(*s_node, "s_model of " + name));
  ARMSIG_TRY(R, read_rotation(map, "axis_direction"));
  ARMSIG_TRY(point_S, map.vector3("axis_point_m"));
  ARMSIG_TRY(nominal_node, map.require("nominal"));
  ARMSIG_TRY(nominal, read_dh(*nominal_node, "nominal of " + name, "theta_rad", type));
  ARMSIG_TRY(limits, read_required_limits(map, keys.limits, type));
  record.fitted.readings.push_back({});
  record.corrections.push_back({});
  if (const YamlNode* correction = map.find("reading_correction")) {
    if (auto done = read_correction(*correction, name, type, record); !done) return done;
  }
  if (const YamlNode* sweep = map.find("sweep")) {
    ARMSIG_TRY(feature, read_feature(*sweep, name, type));
    signature.features.push_back(feature);
  }
  signature.types.push_back(type);
  signature.configuration.push_back(reading);
  signature.pseudo_dh.push_back(dh);
  signature.s_model.push_back(s);
  signature.X_SL.push_back(Pose{R, point_S});
  record.nominal.joints.push_back(nominal);
  record.nominal.limits.push_back(limits);
  return {};
}

}  // namespace armsig::tool
