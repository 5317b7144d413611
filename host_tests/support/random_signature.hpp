// SPDX-License-Identifier: MIT
// Random signature records that are consistent, as the reader of signature files demands.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "firmware/formats/signature_record.hpp"

namespace armsig::test {

class RandomRecord {
 public:
  explicit RandomRecord(unsigned seed) : random_(seed) {}

  [[nodiscard]] tool::SignatureRecord make(std::size_t joint_count) {
    tool::SignatureRecord record;
    Signature& signature = record.signature;
    Pose X_SL{rotation(), vector()};
    for (std::size_t i = 0; i < joint_count; ++i) {
      const JointType type = number() < -0.3 ? JointType::kPrismatic : JointType::kRevolute;
      const double reading = 3 * number();
      signature.types.push_back(type);
      signature.configuration.push_back(reading);
      signature.X_SL.push_back(X_SL);
      add_link(signature, type, reading, X_SL);
      signature.features.push_back(feature(type));
      record.nominal.joints.push_back({type, number(), number(), number(), number()});
      record.nominal.limits.push_back({-1 + 0.1 * number(), 1 + 0.1 * number()});
    }
    signature.X_SL.push_back(X_SL);
    for (int number_of_target = 1; number_of_target < 4; ++number_of_target) {
      signature.targets.push_back({number_of_target, joint_count, vector(), covariance<3>()});
    }
    fill_origin(record);
    return record;
  }

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vector3 vector() { return {number(), number(), number()}; }
  Matrix3 rotation() {
    return Eigen::Quaterniond(number(), number(), number(), number())
        .normalized()
        .toRotationMatrix();
  }
  template <int kSize>
  Eigen::Matrix<double, kSize, kSize> covariance() {
    const Eigen::Matrix<double, kSize, kSize> L =
        Eigen::Matrix<double, kSize, kSize>::NullaryExpr([&] { return 1e-4 * number(); });
    return L * L.transpose();
  }

  // The S-model (4) of a link, its pseudo-DH row (9)-(12), (19)-(23), and the next link frame.
  void add_link(Signature& signature, JointType type, double reading, Pose& X_SL) {
    const s_model::Parameters s{3 * number(), number(),     number(),
                                3 * number(), 3 * number(), number()};
    const bool first = signature.s_model.empty();
    const double gamma_before = first ? 0 : signature.s_model.back().gamma_rad;
    const double b_before = first ? 0 : signature.s_model.back().b_m;
    DhJoint dh{type, s.beta_rad + gamma_before, s.d_m + b_before, s.a_m, s.alpha_rad};
    (type == JointType::kRevolute ? dh.theta_rad : dh.d_m) -= reading;
    signature.s_model.push_back(s);
    signature.pseudo_dh.push_back(dh);
    const Matrix3 R_beta = rotation_z(s.beta_rad);
    X_SL = X_SL * Pose{R_beta, R_beta * Vector3(s.a_m, 0, s.d_m)} *
           Pose{rotation_x(s.alpha_rad), Vector3::Zero()} *
           Pose{rotation_z(s.gamma_rad), Vector3(0, 0, s.b_m)};
  }

  features::JointFeature feature(JointType type) {
    features::JointFeature feature;
    feature.type = type;
    feature.axis_S = vector().normalized();
    feature.point_S = vector();
    feature.radial_S = any_perpendicular(feature.axis_S);
    feature.radius_m = std::abs(number());
    feature.reference_reading = number();
    feature.covariance = covariance<7>();
    feature.quality = {.used = random_() % 1000,
                       .rejected = random_() % 10,
                       .lowest_reading = -1 + 0.5 * number(),
                       .highest_reading = 1 + 0.5 * number(),
                       .rms_normal_m = std::abs(number()),
                       .rms_radial_m = std::abs(number()),
                       .rms_tangential_m = std::abs(number()),
                       .encoder_ratio = 1 + 1e-4 * number(),
                       .encoder_ratio_sigma = 1e-5 * std::abs(number()),
                       .sigma_m = 2e-4 * std::abs(number()),
                       .sigma_is_estimated = number() > 0};
    return feature;
  }

  void fill_origin(tool::SignatureRecord& record) {
    record.arm_name = "Puma 560 \"left\" \\ Größe: # 1";
    record.serial = "0012";
    record.method = "encoder";
    record.time = "1986-04-07T12:00:00Z";
    record.version = "armsig 0.1.0";
    record.covariance = covariance<9>();
    record.covariance_of = "axis lines";
    record.accuracy.predicted = {1e-4 * std::abs(number()), PredictedRegion::kMeasuredReadings};
    record.accuracy.validated = {1e-4 * std::abs(number()), 20};
    record.controller_signature = 3;
    record.air_c = 20 + number();
    record.warnings = {"joint 2: arc of 45 deg", "joint 3: \"far\" # from: its nominal model"};
    if (record.nominal.joints.size() > 1 &&
        record.nominal.joints[0].type == record.nominal.joints[1].type) {
      record.nominal.couplings.push_back({1, 0, number()});
    }
  }

  std::mt19937_64 random_;
};

}  // namespace armsig::test
