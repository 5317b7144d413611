// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement_run.hpp"

#include <algorithm>

#include <Eigen/Cholesky>
#include <fmt/core.h>

#include "core/identification.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

refinement::RefinementConfig config_of(const Arm& nominal,
                                       const std::optional<SensorDescription>& sensor) {
  refinement::RefinementConfig config;
  config.readings.couplings = nominal.couplings;
  if (sensor) {
    for (const Vector3& p_S : sensor->receivers_S) {
      if (!config.receivers.full()) config.receivers.push_back(p_S);
    }
  }
  return config;
}

std::string in_words(const refinement::Undetermined& open, const Signature& signature) {
  const std::string phrase(refinement::describe(open.open));
  switch (open.open) {
    case refinement::Open::kTarget:
      return fmt::format("target {}: {}", signature.targets[open.index].number, phrase);
    case refinement::Open::kReceiverOffset:
      return fmt::format("receiver {}: {}", open.index + 1, phrase);
    default:
      return fmt::format("joint {}: {}", open.index + 1, phrase);
  }
}

Problem refused(const std::string& file, const Refusal& refusal) {
  std::string what(describe(refusal.error));
  if (refusal.error == Error::kTooFewPoints) {
    what =
        fmt::format("{:.0f} measured numbers for {:.0f} unknowns", refusal.found, refusal.needed);
  } else if (refusal.error == Error::kNotConverged) {
    what = "no arm near the description explains the measurements";
  } else if (refusal.error == Error::kTooManyOutliers) {
    what = fmt::format("{:.0f} rows contradict the others, at most {:.0f} may", refusal.found,
                       refusal.needed);
  }
  return {file, 0, 0, what, remedy_in_words(refusal.error)};
}

}  // namespace

std::optional<std::size_t> tool_target(const Signature& signature) {
  for (std::size_t k = signature.targets.size(); k-- > 0;) {
    if (signature.targets[k].link == signature.joint_count()) return k;
  }
  return std::nullopt;
}

Eigen::MatrixXd covariance_of(const refinement::Refined& refined) {
  const std::size_t n = refined.layout.size();
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd half(size, size);  // columns R^-T e_i, so that P = half^T half
  for (std::size_t i = 0; i < n; ++i) {
    refinement::StateVector column{};
    column[i] = 1;
    refined.information.solve_transposed(column);
    for (std::size_t k = 0; k < n; ++k) {
      half(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = column[k];
    }
  }
  return half.transpose() * half;
}

std::unique_ptr<refinement::Refined> estimate_from(const Signature& signature, const Arm& nominal,
                                                   const Eigen::MatrixXd& covariance) {
  std::array<bool, kMaxTargets> observed{};
  for (std::size_t k = 0; k < signature.targets.size(); ++k) observed[k] = true;
  const auto layout = refinement::make_layout(signature, observed, {}, 0);
  const auto size = static_cast<Eigen::Index>(layout ? layout->size() : 0);
  if (!layout || covariance.rows() != size) return nullptr;

  // Scaled to a unit diagonal, so that radians and metres do not spoil each other's digits.
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse_sigma = sigma.cwiseInverse();
  const Eigen::MatrixXd correlation =
      inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> information(
      correlation.llt().solve(Eigen::MatrixXd::Identity(size, size)));
  if (information.info() != Eigen::Success) return nullptr;
  const Eigen::MatrixXd factor =
      Eigen::MatrixXd(information.matrixU()) * inverse_sigma.asDiagonal();
  if (!factor.allFinite()) return nullptr;

  auto estimate = std::make_unique<refinement::Refined>();
  estimate->signature = signature;
  estimate->readings.couplings = nominal.couplings;
  estimate->layout = *layout;
  estimate->information.reset(layout->size());
  for (std::size_t i = 0; i < layout->size(); ++i) {
    for (std::size_t j = i; j < layout->size(); ++j) {
      estimate->information.set_entry(
          i, j, factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  return estimate;
}

Read<RefinementOutcome> run_refinement(const Arm& nominal, const std::optional<Signature>& start,
                                       MeasurementLog& log,
                                       const std::optional<SensorDescription>& sensor,
                                       const std::string& file) {
  FixedVector<Target, kMaxTargets> targets;
  if (start) {
    targets = start->targets;
  } else {
    for (const Target& target : log.targets(nominal.joints.size())) {
      if (!targets.full()) targets.push_back(target);
    }
  }
  if (const auto unknown = log.index_targets(targets)) {
    return std::unexpected(
        Problem{file, 0, 0, fmt::format("target {} is in no sweep that gave a feature", *unknown),
                "a sweep of each target, or targets on the last link"});
  }

  const refinement::RefinementConfig config = config_of(nominal, sensor);
  RefinementOutcome outcome{.refined = std::make_unique<refinement::Refined>(),
                            .rejected_lines = {},
                            .undetermined = {},
                            .cross_validation = {},
                            .drawing_rms_m = {}};
  refinement::Refined& refined = *outcome.refined;
  std::vector<refinement::Observation>& observations = log.observations();
  std::vector<refinement::RowOutcome> verdicts(observations.size());
  refinement::BaseAndTool drawn;
  const auto done = start ? refinement::refine(*start, observations, config, verdicts, refined)
                          : refinement::refine_from_drawing(
                                nominal, observations, std::span(targets.begin(), targets.end()),
                                config, verdicts, refined, {}, &drawn);
  if (!done) return std::unexpected(refused(file, done.error()));
  if (!start) outcome.drawing_rms_m = drawn.rms_m;
  derive_parameters(refined.signature, nominal);

  for (std::size_t k = 0; k < verdicts.size(); ++k) {
    if (!verdicts[k].rejected) continue;
    observations[k].use = refinement::RowUse::kIgnore;
    if (outcome.rejected_lines.empty() || outcome.rejected_lines.back() != log.line(k)) {
      outcome.rejected_lines.push_back(log.line(k));
    }
  }
  for (const refinement::Undetermined& open : refined.undetermined) {
    outcome.undetermined.push_back(in_words(open, refined.signature));
  }
  if (const auto tool = tool_target(refined.signature)) {
    outcome.predicted_tool_error_m = uncertainty::predicted_rms(
        refined, std::span(nominal.limits.begin(), nominal.limits.end()), *tool);
  }
  const auto scratch = std::make_unique<refinement::Refined>();
  const auto crossed =
      refinement::cross_validate(refined.signature, observations, config, verdicts, *scratch);
  if (crossed) outcome.cross_validation = *crossed;
  return outcome;
}

}  // namespace armsig::tool
