// SPDX-License-Identifier: MIT
#include <span>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/deflections.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/formats/yaml_tree.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kHeader =
    "# Arm signature: the actual kinematics of one arm. SI units (metre, radian).\n"
    "# Directions, points and poses are in the sensor frame, at the signature configuration\n"
    "# (reading_rad, reading_m of each joint). Master: the link frames (axis_direction = z,\n"
    "# x_direction, y_direction, axis_point_m = origin); s_model and pseudo_dh are derived from "
    "them.\n"
    "# Near parallel axes d_m and theta_offset_rad are large and cancel: compare poses, not them.\n"
    "# Comments and layout are free; crc32 covers every key and value.\n";

std::string list_text(std::span<const double> values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ", ";
    text += number_text(values[i]);
  }
  return text + "]";
}

std::string vector_text(const Vector3& v) { return list_text({v.data(), 3}); }

// One row a line, indented by `indent`.
std::string matrix_text(const Eigen::Ref<const Eigen::MatrixXd>& matrix, std::size_t indent) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    const Eigen::VectorXd values = matrix.row(row);
    text += fmt::format("{:{}}- {}\n", "", indent,
                        list_text({values.data(), static_cast<std::size_t>(values.size())}));
  }
  return text;
}

std::string base_text(const Pose& X_S0) {
  const Eigen::Quaterniond q(X_S0.R);
  return fmt::format("base:\n  position_m: {}\n  quaternion_wxyz: {}\n", vector_text(X_S0.p),
                     list_text(std::array{q.w(), q.x(), q.y(), q.z()}));
}

std::string feature_text(const features::JointFeature& feature) {
  const features::SweepQuality& quality = feature.quality;
  const std::string_view unit = si_suffix(feature.type);
  std::string text = "    sweep:\n";
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("      {}: {}\n", key, value);
  };
  const auto add_reading = [&](std::string_view key, double value) {
    add(fmt::format("{}_{}", key, unit), number_text(value));
  };
  add("axis_direction", vector_text(feature.axis_S));
  add("point_m", vector_text(feature.point_S));
  add("radial_direction", vector_text(feature.radial_S));
  add("radius_m", number_text(feature.radius_m));
  add_reading("reference_reading", feature.reference_reading);
  add_reading("lowest_reading", quality.lowest_reading);
  add_reading("highest_reading", quality.highest_reading);
  add("used", std::to_string(quality.used));
  add("rejected", std::to_string(quality.rejected));
  add("residual_normal_m", number_text(quality.rms_normal_m));
  add("residual_radial_m", number_text(quality.rms_radial_m));
  add("residual_tangential_m", number_text(quality.rms_tangential_m));
  add("encoder_ratio", number_text(quality.encoder_ratio));
  add("encoder_ratio_sigma", number_text(quality.encoder_ratio_sigma));
  add("sigma_m", number_text(quality.sigma_m));
  add("sigma_is_estimated", quality.sigma_is_estimated ? "true" : "false");
  text += "      covariance:  # of point_m, rotation of the triad (rad), radius_m\n";
  return text + matrix_text(feature.covariance, 8);
}

// The corrections that were fitted; empty where there are none.
std::string correction_text(const SignatureRecord& record, std::size_t i) {
  if (record.fitted.readings.empty()) return {};
  const calibration::ReadingTerms& terms = record.fitted.readings[i];
  const calibration::ReadingCorrection& c = record.corrections[i];
  const bool revolute = record.signature.types[i] == JointType::kRevolute;
  std::string text;
  const auto add = [&](std::string_view key, double value) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", key, number_text(value));
  };
  if (terms.gain) add("gain", c.gain);
  if (terms.first && revolute) {
    add("cos_1_rad", c.cos_1);
    add("sin_1_rad", c.sin_1);
  }
  if (terms.second && revolute) {
    add("cos_2_rad", c.cos_2);
    add("sin_2_rad", c.sin_2);
  }
  return text.empty() ? text : fmt::format("    reading_correction: {{{}}}\n", text);
}

std::string joint_text(const SignatureRecord& record, std::size_t i) {
  const Signature& signature = record.signature;
  const JointType type = signature.types[i];
  const std::string_view unit = si_suffix(type);
  const DhJoint& dh = signature.pseudo_dh[i];
  const s_model::Parameters& s = signature.s_model[i];
  const Pose& X_SL = signature.X_SL[i];
  const DhJoint& nominal = record.nominal.joints[i];
  std::string text = fmt::format("  - type: {}  # joint {}\n", word_of(type), i + 1);
  const auto add = [&](std::string_view key, const std::string& value) {
    text += fmt::format("    {}: {}\n", key, value);
  };
  if (!record.joint_names.empty()) add("name", yaml_quoted(record.joint_names[i]));
  add(fmt::format("reading_{}", unit), number_text(signature.configuration[i]));
  add(fmt::format("reading_offset_{}", unit),
      number_text(type == JointType::kRevolute ? dh.theta_rad : dh.d_m));
  add("pseudo_dh", fmt::format("{{theta_offset_rad: {}, d_m: {}, a_m: {}, alpha_rad: {}}}",
                               number_text(dh.theta_rad), number_text(dh.d_m), number_text(dh.a_m),
                               number_text(dh.alpha_rad)));
  add("s_model",
      fmt::format("{{beta_rad: {}, d_m: {}, a_m: {}, alpha_rad: {}, gamma_rad: {}, b_m: {}}}",
                  number_text(s.beta_rad), number_text(s.d_m), number_text(s.a_m),
                  number_text(s.alpha_rad), number_text(s.gamma_rad), number_text(s.b_m)));
  add("axis_direction", vector_text(X_SL.R.col(2)));
  add("axis_point_m", vector_text(X_SL.p));
  add("x_direction", vector_text(X_SL.R.col(0)));
  add("y_direction", vector_text(X_SL.R.col(1)));
  add("nominal", fmt::format("{{theta_rad: {}, d_m: {}, a_m: {}, alpha_rad: {}}}",
                             number_text(nominal.theta_rad), number_text(nominal.d_m),
                             number_text(nominal.a_m), number_text(nominal.alpha_rad)));
  text += fmt::format("    {}\n", limits_text(type, record.nominal.limits[i]));
  text += correction_text(record, i);
  if (!signature.features.empty()) text += feature_text(signature.features[i]);
  return text;
}

std::string targets_text(const Signature& signature) {
  if (signature.targets.empty()) return "targets: []\n";
  std::string text = "targets:\n";
  for (const Target& target : signature.targets) {
    text += fmt::format("  - number: {}\n    link: {}\n    position_m: {}\n    covariance_m2:\n{}",
                        target.number, target.link, vector_text(target.p_S),
                        matrix_text(target.covariance_m2, 6));
  }
  return text;
}

std::string last_link_text(const Pose& X_SL) {
  return fmt::format(
      "last_link:\n  origin_m: {}\n  x_direction: {}\n  y_direction: {}\n  z_direction: {}\n",
      vector_text(X_SL.p), vector_text(X_SL.R.col(0)), vector_text(X_SL.R.col(1)),
      vector_text(X_SL.R.col(2)));
}

std::string fit_text(const FitRecord& fit) {
  std::string text = fmt::format("fit:\n  rows_used: {}\n  rows_rejected: {}\n  rms_m: {}\n",
                                 fit.rows_used, fit.rows_rejected, number_text(fit.rms_m));
  if (fit.rows_merged_to > 0) text += fmt::format("  rows_merged_to: {}\n", fit.rows_merged_to);
  if (!fit.left_out) return text;
  return text + fmt::format(
                    "  left_out_rows: {}  # cross-validated\n  left_out_mean_m: {}\n"
                    "  left_out_rms_m: {}\n",
                    fit.left_out->rows, number_text(fit.left_out->mean_m),
                    number_text(fit.left_out->rms_m));
}

std::string accuracy_text(const SignatureRecord& record) {
  const auto& [predicted, validated] = record.accuracy;
  std::string text;
  if (record.controller_signature > 0) {
    text += fmt::format("  controller_signature: {}\n", record.controller_signature);
  }
  if (predicted) {
    text += fmt::format(
        "  predicted_tool_error_m: {}  # RMS over the region, 1 sigma, without the sensor's noise\n"
        "  predicted_region: {}\n",
        number_text(predicted->rms_m), name(predicted->region));
  }
  if (validated) {
    text += fmt::format(
        "  validation_rms_m: {}  # on poses that no fit has used, with the sensor's noise\n",
        number_text(validated->rms_m));
    if (validated->poses > 0) text += fmt::format("  validation_poses: {}\n", validated->poses);
  }
  return text.empty() ? text : "accuracy:\n" + text;
}

// Whose signature it is, how it was found, and how good it is.
std::string head_text(const SignatureRecord& record) {
  std::string text =
      fmt::format("armsig: {}\nname: {}\n", kSignatureTag, yaml_quoted(record.arm_name));
  text += fmt::format("serial: {}\nmethod: {}\n", yaml_quoted(record.serial), record.method);
  text +=
      fmt::format("time: {}\nversion: {}\n", yaml_quoted(record.time), yaml_quoted(record.version));
  if (record.air_c) text += fmt::format("air_c: {}\n", number_text(*record.air_c));
  if (record.sigma_m) {
    text += fmt::format("sigma_m: {}  # noise of the measurements per axis\n",
                        number_text(*record.sigma_m));
  }
  if (record.unexplained_m > 0) {
    text += fmt::format("unexplained_m: {}  # per axis, beyond that noise\n",
                        number_text(record.unexplained_m));
  }
  if (record.noise_freedom > 0) {
    text += fmt::format("noise_freedom: {}\n", number_text(record.noise_freedom));
  }
  text += accuracy_text(record);
  if (record.fit) text += fit_text(*record.fit);
  return text;
}

std::string sensor_errors_text(const SignatureRecord& record) {
  std::string text;
  if (record.fitted.receiver_offsets) {
    text += fmt::format("range_offsets_m: {}\n", list_text({record.receiver_offsets_m.data(),
                                                            record.receiver_offsets_m.size()}));
  }
  if (record.fitted.scale) {
    text += fmt::format("length_scale: {}  # a measured length is 1 + this times the true one\n",
                        number_text(record.scale));
  }
  return text;
}

std::string body_text(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  std::string text = head_text(record) + sensor_errors_text(record);
  if (!record.warnings.empty()) text += "warnings:\n";
  for (const std::string& warning : record.warnings) {
    text += fmt::format("  - {}\n", yaml_quoted(warning));
  }
  text += origin_text(record.origin);
  text += base_text(signature.X_SL[0]);
  text += "joints:\n";
  for (std::size_t i = 0; i < signature.joint_count(); ++i) text += joint_text(record, i);
  text += last_link_text(signature.X_SL.back());
  text += couplings_text(record.nominal.couplings) + mounting_text(record.mounting);
  text += deflections_text(record);
  text += targets_text(signature);
  if (record.covariance) {
    text += fmt::format("covariance_of: {}\ncovariance:\n", yaml_quoted(record.covariance_of));
    text += matrix_text(*record.covariance, 2);
  }
  return text;
}

// One count for everything that there is one of per joint.
bool counts_agree(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  const std::size_t n = signature.joint_count();
  return n > 0 && signature.configuration.size() == n && signature.X_SL.size() == n + 1 &&
         signature.s_model.size() == n && signature.pseudo_dh.size() == n &&
         (signature.features.empty() || signature.features.size() == n) &&
         record.fitted.readings.size() == record.corrections.size() &&
         (record.corrections.empty() || record.corrections.size() == n) &&
         (!record.deflections || record.deflections->joint_count() == n) &&
         (record.joint_names.empty() || record.joint_names.size() == n) &&
         record.nominal.joints.size() == n && record.nominal.limits.size() == n;
}

}  // namespace

Read<std::string> signature_text(const SignatureRecord& record) {
  if (!counts_agree(record)) {
    return problem_at(0, 0, "the signature is incomplete", "every part for every joint");
  }
  ARMSIG_TRY(text, sealed(std::string(kHeader) + body_text(record)));
  if (auto check = parse_signature(text, ""); !check) {
    return std::unexpected(std::move(check).error());
  }
  return text;
}

Read<void> write_signature_file(const std::string& path, const SignatureRecord& record) {
  ARMSIG_TRY(text, in_file(path, signature_text(record)));
  return write_text_file(path, text);
}

}  // namespace armsig::tool
