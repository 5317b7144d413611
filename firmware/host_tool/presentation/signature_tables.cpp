// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/signature_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// Twice any link of a common arm: a larger d comes from a common normal far away.
constexpr double kLargeOffset_m = 2.0;
constexpr double kMicroradian = 1e-6;

std::string millimetres(double metres) { return fmt::format("{:.3f}", 1e3 * metres); }

std::string encoder_scale(const features::SweepQuality& quality) {
  return fmt::format("{:+.3f} ± {:.3f}", 100 * (quality.encoder_ratio - 1),
                     100 * quality.encoder_ratio_sigma);
}

nlohmann::ordered_json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json feature_json(const features::JointFeature& feature) {
  const features::SweepQuality& quality = feature.quality;
  const bool revolute = feature.type == JointType::kRevolute;
  nlohmann::ordered_json json{{"used", quality.used}, {"rejected", quality.rejected}};
  json[revolute ? "arc_rad" : "stroke_m"] = quality.arc();
  if (revolute) json["radius_m"] = feature.radius_m;
  json["rms_normal_m"] = quality.rms_normal_m;
  if (revolute) json["rms_radial_m"] = quality.rms_radial_m;
  json["rms_tangential_m"] = quality.rms_tangential_m;
  json["encoder_ratio"] = quality.encoder_ratio;
  json["encoder_ratio_sigma"] = quality.encoder_ratio_sigma;
  json["sigma_m"] = quality.sigma_m;
  json["sigma_is_estimated"] = quality.sigma_is_estimated;
  return json;
}

}  // namespace

std::string sweep_table(const Signature& signature) {
  if (signature.features.empty()) return {};
  Table table({"Joint", "Swept", "Radius mm", "Used", "Rejected", "Normal mm", "Radial mm",
               "Tangential mm", "Scale error %"});
  for (std::size_t i = 0; i < signature.features.size(); ++i) {
    const features::JointFeature& feature = signature.features[i];
    const features::SweepQuality& quality = feature.quality;
    const bool revolute = feature.type == JointType::kRevolute;
    table.add_row({fmt::format("{}", i + 1),
                   revolute ? fmt::format("{:.1f}°", degrees(quality.arc()))
                            : fmt::format("{:.1f} mm", 1e3 * quality.arc()),
                   revolute ? fmt::format("{:.2f}", 1e3 * feature.radius_m) : "",
                   fmt::format("{}", quality.used), fmt::format("{}", quality.rejected),
                   millimetres(quality.rms_normal_m),
                   revolute ? millimetres(quality.rms_radial_m) : "",
                   millimetres(quality.rms_tangential_m), encoder_scale(quality)});
  }
  return table.render();
}

std::string dh_table(const DhRows& rows) {
  Table table({"Link", "Variable", "θ offset °", "d mm", "a mm", "α °"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhJoint& row = rows[i];
    table.add_row({fmt::format("{}", i + 1),
                   fmt::format("{}{}", row.type == JointType::kRevolute ? "θ" : "d", i + 1),
                   fmt::format("{:.3f}", degrees(row.theta_rad)),
                   fmt::format("{:.2f}", 1e3 * row.d_m), fmt::format("{:.2f}", 1e3 * row.a_m),
                   fmt::format("{:.3f}", degrees(row.alpha_rad))});
  }
  return table.render();
}

std::string near_parallel_note(const Signature& signature) {
  std::vector<std::string> links;
  double moved_m = 0;
  for (std::size_t i = 0; i < signature.pseudo_dh.size(); ++i) {
    const DhJoint& row = signature.pseudo_dh[i];
    if (std::abs(row.d_m) <= kLargeOffset_m) continue;
    links.push_back(std::to_string(i + 1));
    // d is a distance across over the sine of the angle between the axes. The last row has its d
    // from the one before: no axis follows it.
    const double sine = std::abs(std::sin(row.alpha_rad));
    if (sine > 0) moved_m = std::max(moved_m, std::abs(row.d_m) * kMicroradian / sine);
  }
  if (links.empty() || moved_m == 0) return {};
  const bool is_small = moved_m < 1;
  const double moved = (is_small ? 1e3 : 1) * moved_m;
  // Two digits that count.
  const double digit = std::pow(10.0, std::floor(std::log10(moved)) - 1);
  const std::string far =
      fmt::format("{:.{}f}", std::round(moved / digit) * digit, moved < 10 ? 1 : 0);
  return paragraph(fmt::format(
      "The d of {} {} is large because two axes there are nearly parallel: their common normal is "
      "far away, and a microradian of tilt moves it by {}. Only the product of the rows means "
      "something; compare predicted positions, or what is different joint by joint, never these "
      "parameters.",
      links.size() == 1 ? "link" : "links", all_of(links), far + (is_small ? " mm" : " m")));
}

std::string comparison_table(const evaluation::Comparison& comparison) {
  const evaluation::Indices& a = comparison.ideal;
  const evaluation::Indices& b = comparison.with_signature;
  const std::array<double, 4> factors = improvement(comparison);
  Table table({"Index", "Nominal", "Signature", "Better by"});
  const auto add = [&](const char* name, const std::string& ideal, const std::string& signature,
                       double factor) {
    table.add_row({name, ideal, signature, fmt::format("{:.1f}", factor)});
  };
  const auto mm = [](double metres) { return fmt::format("{:.3f} mm", 1e3 * metres); };
  const auto deg = [](double radians) { return fmt::format("{:.3f}°", degrees(radians)); };
  add("Maximum normal deviation from a line", mm(a.normal_deviation_m), mm(b.normal_deviation_m),
      factors[0]);
  add("Deviation from perpendicular between lines", deg(a.perpendicular_deviation_rad),
      deg(b.perpendicular_deviation_rad), factors[1]);
  add("Maximum radial deviation of a grid point", mm(a.radial_deviation_m),
      mm(b.radial_deviation_m), factors[2]);
  add("Maximum orientational deviation", deg(a.orientation_deviation_rad),
      deg(b.orientation_deviation_rad), factors[3]);
  return table.render();
}

nlohmann::ordered_json signature_json(const Signature& signature) {
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const DhJoint& row = signature.pseudo_dh[i];
    nlohmann::ordered_json joint{
        {"type", row.type == JointType::kRevolute ? "revolute" : "prismatic"},
        {"theta_offset_rad", row.theta_rad},
        {"d_m", row.d_m},
        {"a_m", row.a_m},
        {"alpha_rad", row.alpha_rad},
        {"axis_direction", vector_json(signature.X_SL[i].R.col(2))},
        {"axis_point_m", vector_json(signature.X_SL[i].p)},
        {"signature_reading", signature.configuration[i]}};
    if (i < signature.features.size()) joint["sweep"] = feature_json(signature.features[i]);
    joints.push_back(std::move(joint));
  }
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  for (const Target& target : signature.targets) {
    targets.push_back({{"number", target.number},
                       {"link", target.link},
                       {"position_m", vector_json(target.p_S)}});
  }
  return {{"joints", std::move(joints)},
          {"targets", std::move(targets)},
          {"description_matches", signature.description_matches}};
}

nlohmann::ordered_json comparison_json(const evaluation::Comparison& comparison) {
  const auto indices_json = [](const evaluation::Indices& indices) {
    return nlohmann::ordered_json{
        {"normal_deviation_m", indices.normal_deviation_m},
        {"perpendicular_deviation_rad", indices.perpendicular_deviation_rad},
        {"radial_deviation_m", indices.radial_deviation_m},
        {"orientation_deviation_rad", indices.orientation_deviation_rad}};
  };
  return {{"grid_m", comparison.grid.size_m},
          {"ideal", indices_json(comparison.ideal)},
          {"with_signature", indices_json(comparison.with_signature)},
          {"improvement", improvement(comparison)}};
}

}  // namespace armsig::tool
