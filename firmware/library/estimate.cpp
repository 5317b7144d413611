// SPDX-License-Identifier: MIT
#include "firmware/library/estimate.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

namespace armsig::tool {
namespace {

// R with R^T R the inverse of `covariance`; empty where that is no covariance.
std::optional<Eigen::MatrixXd> information_factor(const Eigen::MatrixXd& covariance) {
  const Eigen::Index size = covariance.rows();
  // Scaled to a unit diagonal, so that radians and metres do not spoil each other's digits.
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse_sigma = sigma.cwiseInverse();
  const Eigen::MatrixXd correlation =
      inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> information(
      correlation.llt().solve(Eigen::MatrixXd::Identity(size, size)));
  if (information.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd factor = Eigen::MatrixXd(information.matrixU()) * inverse_sigma.asDiagonal();
  if (!factor.allFinite()) return std::nullopt;
  return factor;
}

// Empty where signature and covariance do not fit together.
std::unique_ptr<calibration::Refined> rebuilt(const SignatureRecord& record) {
  const Signature& signature = record.signature;
  std::array<bool, kMaxTargets> observed{};
  for (std::size_t k = 0; k < signature.targets.size(); ++k) observed[k] = true;
  const auto layout = calibration::make_layout(signature, observed, record.fitted,
                                               record.receiver_offsets_m.size());
  if (!layout || record.covariance->rows() != static_cast<Eigen::Index>(layout->size())) {
    return nullptr;
  }
  const auto factor = information_factor(*record.covariance);
  if (!factor) return nullptr;
  auto estimate = std::make_unique<calibration::Refined>();
  estimate->signature = signature;
  estimate->readings = record.readings();
  std::ranges::copy(record.receiver_offsets_m, estimate->receiver_offsets_m.begin());
  estimate->scale = record.scale;
  estimate->layout = *layout;
  estimate->information.reset(layout->size());
  for (std::size_t i = 0; i < layout->size(); ++i) {
    for (std::size_t j = i; j < layout->size(); ++j) {
      estimate->information.set_entry(
          i, j, (*factor)(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  estimate->quality.sigma_m = record.sigma_m.value_or(0);
  estimate->quality.unexplained_m = record.unexplained_m;
  estimate->quality.noise_freedom = record.noise_freedom;
  return estimate;
}

}  // namespace

Read<std::unique_ptr<calibration::Refined>> estimate_of(const SignatureRecord& record,
                                                        const std::string& file) {
  if (!record.covariance) {
    return std::unexpected(Problem{file, 0, 0, "the signature has no covariance",
                                   "one that armsig identify found from measurements"});
  }
  auto estimate = rebuilt(record);
  if (!estimate) {
    return std::unexpected(Problem{file, 0, 0,
                                   "the covariance is not that of what the signature holds",
                                   "one that armsig identify found from measurements"});
  }
  return estimate;
}

Eigen::MatrixXd covariance_of(const calibration::Refined& refined) {
  const std::size_t n = refined.layout.size();
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd half(size, size);  // columns R^-T e_i, so that P = half^T half
  for (std::size_t i = 0; i < n; ++i) {
    calibration::StateVector column{};
    column[i] = 1;
    refined.information.solve_transposed(column);
    for (std::size_t k = 0; k < n; ++k) {
      half(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = column[k];
    }
  }
  return half.transpose() * half;
}

std::optional<std::size_t> tool_target(const Signature& signature) {
  for (std::size_t k = signature.targets.size(); k-- > 0;) {
    if (signature.targets[k].link == signature.joint_count()) return k;
  }
  return std::nullopt;
}

}  // namespace armsig::tool
