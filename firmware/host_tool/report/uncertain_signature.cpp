// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/uncertain_signature.hpp"

#include <cmath>

#include "core/calibration/chain.hpp"
#include "core/identification.hpp"
#include "firmware/analysis/uncertainty/feature_information.hpp"
#include "firmware/library/estimate.hpp"

namespace armsig::tool {
namespace {

// Share of a sigma that a derivative is taken over: small beside the curvature of the parameters of
// nearly parallel axes, large beside rounding.
constexpr double kDerivativeStep = 1e-2;

}  // namespace

std::unique_ptr<calibration::Refined> estimate_behind(const SignatureRecord& record) {
  if (record.covariance) {
    auto estimate = estimate_of(record, "");
    return estimate ? std::move(*estimate) : nullptr;
  }
  if (record.signature.features.size() != record.signature.joint_count()) return nullptr;
  auto estimate = std::make_unique<calibration::Refined>();
  if (!uncertainty::from_features(record.signature, *estimate)) return nullptr;
  estimate->readings.couplings = record.nominal.couplings;
  return estimate;
}

Signature moved(const calibration::Refined& estimate, const Arm& nominal,
                const Eigen::VectorXd& step) {
  calibration::StateVector x{};
  for (Eigen::Index k = 0; k < step.size(); ++k) x.at(static_cast<std::size_t>(k)) = step[k];
  Signature signature = estimate.signature;
  calibration::ReadingModel readings = estimate.readings;
  calibration::apply_corrections(estimate.layout, x, 1.0, signature, readings);
  derive_parameters(signature, nominal);
  return signature;
}

DhRows parameter_sigmas(const calibration::Refined& estimate, const Arm& nominal) {
  const Eigen::MatrixXd covariance = covariance_of(estimate);
  const auto n = covariance.rows();
  const std::size_t joints = estimate.signature.joint_count();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(4 * joints), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double h = kDerivativeStep * std::sqrt(covariance(k, k));
    const auto rows = [&](double by) {
      const Eigen::VectorXd step = by * Eigen::VectorXd::Unit(n, k);
      return moved(estimate, nominal, step).pseudo_dh;
    };
    const auto above = rows(h);
    const auto below = rows(-h);
    for (std::size_t i = 0; i < joints; ++i) {
      const auto row = static_cast<Eigen::Index>(4 * i);
      jacobian(row, k) = wrap_angle(above[i].theta_rad - below[i].theta_rad) / (2 * h);
      jacobian(row + 1, k) = (above[i].d_m - below[i].d_m) / (2 * h);
      jacobian(row + 2, k) = (above[i].a_m - below[i].a_m) / (2 * h);
      jacobian(row + 3, k) = wrap_angle(above[i].alpha_rad - below[i].alpha_rad) / (2 * h);
    }
  }
  const Eigen::VectorXd sigma =
      (jacobian * covariance * jacobian.transpose()).diagonal().cwiseSqrt();
  DhRows sigmas;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto row = static_cast<Eigen::Index>(4 * i);
    sigmas.push_back({.type = estimate.signature.types[i],
                      .theta_rad = sigma[row],
                      .d_m = sigma[row + 1],
                      .a_m = sigma[row + 2],
                      .alpha_rad = sigma[row + 3]});
  }
  return sigmas;
}

}  // namespace armsig::tool
