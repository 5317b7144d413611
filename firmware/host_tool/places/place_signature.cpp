// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_signature.hpp"

#include <cmath>
#include <limits>

#include "core/identification.hpp"
#include "firmware/analysis/evaluation/geometry_alone.hpp"

namespace armsig::tool {
namespace {

using calibration::ArmModel;

// The signature of the nominal model, at the touch that is most in the middle.
Signature nominal_signature(const PlaceTask& task, const Vector3& tool_F) {
  std::vector<calibration::Observation> rows;
  for (const TouchRow& touch : task.touches) {
    calibration::Observation row;
    row.readings = touch.q;
    rows.push_back(row);
  }
  const std::size_t link = task.nominal.joints.size();
  const Target tool{.number = 1, .link = link};
  calibration::BaseAndTool fitted;
  fitted.p_LT.push_back(tool_F);
  return calibration::drawn_signature(task.nominal, fitted, rows, std::span(&tool, 1));
}

bool deflects(const PlaceFit& fit) { return fit.parts().gravity || fit.parts().maps; }

// Gravity and maps alone, with the readings that were covered and what is known of the maps.
std::shared_ptr<ArmModel> deflections_of(const PlaceTask& task, const PlaceFit& fit) {
  auto model = std::make_shared<ArmModel>(fit.state().arm);
  for (std::size_t j = 0; j < model->joint_count(); ++j) {
    calibration::JointModel& joint = model->joints[j];
    joint.deviation.fill(0);
    joint.covered = {std::numeric_limits<double>::infinity(),
                     -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < task.touches.size(); ++k) {
      if (fit.weights()[k] == 0) continue;
      joint.covered.lower = std::min(joint.covered.lower, task.touches[k].q[j]);
      joint.covered.upper = std::max(joint.covered.upper, task.touches[k].q[j]);
    }
  }
  for (const auto& [joint, first] : fit.columns().maps) {
    for (std::size_t k = 0; k < calibration::kKnots; ++k) {
      const auto c = first + static_cast<Eigen::Index>(k);
      model->joints[joint].map_variance[k] = static_cast<float>(fit.covariance()(c, c));
    }
  }
  return model;
}

void add_quality(const PlaceTask& task, const PlaceFit& fit, calibration::Refined& refined) {
  calibration::FitQuality& quality = refined.quality;
  double squares = 0;
  double variances = 0;
  for (const PlaceScalar& scalar : fit.touches()) {
    if (fit.weights()[scalar.touch] == 0) continue;
    squares += scalar.residual * scalar.residual;
    variances += fit.variance_of(scalar);
    ++quality.scalars;
  }
  quality.rows_rejected = fit.rejected();
  quality.rows_used = task.touches.size() - fit.rejected();
  quality.rms_m = std::sqrt(squares / static_cast<double>(quality.rows_used));
  quality.sigma_m = std::sqrt(variances / static_cast<double>(quality.scalars));
  quality.sigma_is_estimated = true;
  quality.noise_freedom = fit.freedom();
}

// Every sigma of the estimate, times `factor`.
void enlarge_all(RefinementOutcome& outcome, ArmModel* deflections, double factor) {
  outcome.refined->information.scale(1 / factor);
  for (Target& target : outcome.refined->signature.targets) {
    target.covariance_m2 *= factor * factor;
  }
  if (deflections == nullptr) return;
  for (calibration::JointModel& joint : deflections->joints) {
    for (float& variance : joint.map_variance) variance *= static_cast<float>(factor * factor);
  }
}

}  // namespace

Judged<void> add_signature(PlaceCalibration& found) {
  const PlaceTask& task = *found.task;
  const PlaceFit& fit = *found.fit;
  RefinementOutcome& outcome = found.outcome;
  outcome.refined = std::make_unique<calibration::Refined>();
  calibration::Refined& refined = *outcome.refined;
  const PlaceState& state = fit.state();
  const Signature nominal = nominal_signature(task, state.tool.p_L);
  refined.signature = nominal;
  refined.readings.couplings = task.nominal.couplings;
  const auto model = deflects(fit) ? deflections_of(task, fit) : nullptr;
  const auto limits =
      model ? calibration::covered_limits(*model, task.nominal.limits) : task.nominal.limits;
  found.knowledge =
      tool_knowledge(fit, judged_configurations(types_of(fit.state().arm.joints), limits));
  std::vector<double> scratch(calibration::kMaxParameters * calibration::kMaxParameters);
  auto done = calibration::geometry_to_signature(state.arm, std::span(&state.tool, 1),
                                                 PlaceCovariance(fit, found.knowledge), refined, {},
                                                 scratch);
  if (!done) return done;
  if (auto like = calibration::like_its_drawing(nominal, refined.signature, {}); !like) return like;
  derive_parameters(refined.signature, task.nominal);
  add_quality(task, fit, refined);
  refined.readings.deflections = model.get();
  outcome.deflections = model;
  if (found.validation) {
    outcome.cross_validation =
        CrossValidation{found.validation->touches, found.validation->mean_m,
                        found.validation->rms_m, found.validation->largest_m};
    found.knowledge.rms_m *= found.validation->factor;
    found.knowledge.by_scale_m *= found.validation->factor;
  }
  // Maps and geometry are known together better than apart, as the signature has them: what it
  // states is to be what the fit knows.
  predict_tool_error(task.nominal, outcome);
  enlarge_all(outcome, model.get(), found.knowledge.rms_m / outcome.predicted_tool_error->rms_m);
  predict_tool_error(task.nominal, outcome);
  return {};
}

}  // namespace armsig::tool
