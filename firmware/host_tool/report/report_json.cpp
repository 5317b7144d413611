// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/host_tool/presentation/differences.hpp"
#include "firmware/host_tool/presentation/signature_tables.hpp"
#include "firmware/host_tool/report/arm_drawing.hpp"
#include "firmware/host_tool/report/certificate_json.hpp"
#include "firmware/host_tool/report/grid_task.hpp"
#include "firmware/host_tool/report/poses_json.hpp"
#include "firmware/host_tool/report/reading_maps.hpp"
#include "firmware/host_tool/report/report.hpp"
#include "firmware/host_tool/report/sweep_picture.hpp"
#include "firmware/host_tool/report/tool_error_map.hpp"
#include "firmware/host_tool/report/uncertain_signature.hpp"
#include "firmware/host_tool/report/verdict.hpp"

namespace armsig::tool {
namespace {

using Json = nlohmann::ordered_json;

// Points shown of one sweep. The fit uses all; rejected ones are shown in any case.
constexpr std::size_t kShownPoints = 600;

// Pictures need no 17 digits: micrometres for places, nanometres for residuals.
double rounded(double value, double unit) { return std::round(value / unit) * unit; }
Json rounded_place(const Vector3& p) {
  return {rounded(p.x(), 1e-6), rounded(p.y(), 1e-6), rounded(p.z(), 1e-6)};
}
Json exactly(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json source_json(const ReportSource& source) {
  return {{"name", source.name}, {"crc32", source.crc32}};
}

// What the signature says of the rows that it was found from.
Json origin_json(const Origin& origin) {
  return {{"measurements", origin.measurements},
          {"columns", origin.columns},
          {"sensor", origin.sensor},
          {"options", origin.options},
          {"rows", origin.rows},
          {"rows_crc32", fmt::format("0x{:08X}", origin.rows_crc32)}};
}

Json about_json(const ReportInput& input) {
  const SignatureRecord& record = input.record;
  Json about{{"arm", record.arm_name},
             {"serial", record.serial},
             {"method", record.method},
             {"time", record.time},
             {"version", record.version},
             {"air_c", or_null(record.air_c)},
             {"sigma_m", or_null(record.sigma_m)},
             {"noise_m", record.sigma_m ? Json(std::hypot(*record.sigma_m, record.unexplained_m))
                                        : Json(nullptr)},
             {"warnings", record.warnings},
             {"signature", source_json(input.signature)}};
  about["origin"] = record.origin ? origin_json(*record.origin) : Json(nullptr);
  about["other_measurements"] = other_measurements_in_words(input);
  if (input.measurements) about["measurements"] = source_json(*input.measurements);
  if (input.measured) {
    about["rows"] = input.measured->rows;
    about["rows_not_located"] = input.measured->not_located;
    about["rows_mixed"] = input.measured->mixed;
  }
  return about;
}

Json line_json(const BentLine& line) {
  Json points = Json::array();
  for (const Vector3& p : line) points.push_back(rounded_place(p));
  return points;
}

Json arm_json(const SignatureRecord& record) {
  const ArmDrawing drawing = arm_drawing(record);
  Json frames = Json::array();
  for (std::size_t k = 0; k < drawing.frames.size(); ++k) {
    Json readings = Json::array();
    for (const double reading : drawing.poses[k]) readings.push_back(rounded(reading, 1e-6));
    frames.push_back({{"q", std::move(readings)},
                      {"nominal", line_json(drawing.frames[k].nominal)},
                      {"actual", line_json(drawing.frames[k].actual)}});
  }
  return {{"has_tool", drawing.has_tool}, {"frames", std::move(frames)}};
}

Json point_json(const PointResidual& point) {
  return {rounded(point.reading, 1e-7),      rounded_place(point.p_S),
          rounded(point.radial_m, 1e-9),     rounded(point.normal_m, 1e-9),
          rounded(point.tangential_m, 1e-9), point.rejected ? 1 : 0};
}

Json points_json(const SweepPicture& sweep) {
  const std::size_t every = 1 + (sweep.points.size() - 1) / kShownPoints;
  Json points = Json::array();
  for (std::size_t k = 0; k < sweep.points.size(); ++k) {
    if (k % every == 0 || sweep.points[k].rejected) points.push_back(point_json(sweep.points[k]));
  }
  return points;
}

Json wave_json(const EncoderWave& wave, const features::JointFeature& feature) {
  constexpr int kSteps = 90;
  Json curve = Json::array();
  const features::SweepQuality& quality = feature.quality;
  for (int k = 0; k <= kSteps; ++k) {
    const double reading = quality.lowest_reading + quality.arc() * k / kSteps;
    const CircleResidual residual = wave.residual_at(reading, feature.radius_m);
    curve.push_back({rounded(reading, 1e-6), rounded(residual.radial_m, 1e-9),
                     rounded(residual.tangential_m, 1e-9)});
  }
  return {{"amplitude_rad", wave.amplitude_rad()},
          {"sigma_rad", wave.sigma_rad},
          {"chi_square", wave.chi_square},
          {"significant", wave.significant()},
          {"curve", std::move(curve)}};
}

Json sweep_json(const SweepPicture& sweep) {
  const features::JointFeature& feature = sweep.feature;
  const features::SweepQuality& quality = feature.quality;
  Json json{{"joint", sweep.joint + 1},
            {"target", sweep.target},
            {"revolute", feature.type == JointType::kRevolute},
            {"axis", exactly(feature.axis_S)},
            {"centre", exactly(feature.point_S)},
            {"radial", exactly(feature.radial_S)},
            {"radius_m", feature.radius_m},
            {"reference", feature.reference_reading},
            {"lowest", quality.lowest_reading},
            {"highest", quality.highest_reading},
            {"used", quality.used},
            {"rejected", quality.rejected},
            {"rms_radial_m", quality.rms_radial_m},
            {"rms_normal_m", quality.rms_normal_m},
            {"rms_tangential_m", quality.rms_tangential_m},
            {"sigma_m", quality.sigma_m},
            {"encoder_ratio", quality.encoder_ratio},
            {"encoder_ratio_sigma", quality.encoder_ratio_sigma},
            {"words", residuals_in_words(sweep)}};
  json["wave"] = sweep.wave ? wave_json(*sweep.wave, feature) : Json(nullptr);
  json["points"] = points_json(sweep);
  return json;
}

Json row_json(const DhJoint& row) {
  return {{"theta_rad", row.theta_rad},
          {"d_m", row.d_m},
          {"a_m", row.a_m},
          {"alpha_rad", row.alpha_rad}};
}

Json parameters_json(const SignatureRecord& record, const calibration::Refined* estimate) {
  DhRows sigmas;
  if (estimate != nullptr) sigmas = parameter_sigmas(*estimate, record.nominal);
  Json rows = Json::array();
  for (std::size_t i = 0; i < record.signature.joint_count(); ++i) {
    Json row{{"joint", i + 1},
             {"revolute", record.signature.types[i] == JointType::kRevolute},
             {"reading", record.signature.configuration[i]},
             {"actual", row_json(record.signature.pseudo_dh[i])},
             {"nominal", row_json(record.nominal.joints[i])}};
    row["sigma"] = sigmas.empty() ? Json(nullptr) : row_json(sigmas[i]);
    rows.push_back(std::move(row));
  }
  return {{"rows", std::move(rows)}, {"near_parallel", near_parallel_note(record.signature)}};
}

Json map_json(const ToolErrorMap& map) {
  Json points = Json::array();
  for (const ToolErrorAt& at : map.points) {
    Json point = rounded_place(at.p_S);
    point.push_back(rounded(at.drawing_m, 1e-8));
    point.push_back(at.predicted_m ? Json(rounded(*at.predicted_m, 1e-9)) : Json(nullptr));
    point.push_back(at.measured ? 1 : 0);
    points.push_back(std::move(point));
  }
  return {{"nominal_rms_m", map.nominal_rms_m},
          {"over", map.over},
          {"predicted_rms_m", or_null(map.predicted_rms_m)},
          {"predicted_over_limits_m", or_null(map.predicted_over_limits_m)},
          {"true_nominal_rms_m", or_null(map.true_nominal_rms_m)},
          {"true_rms_m", or_null(map.true_rms_m)},
          {"joint_share", map.joint_share},
          {"points", std::move(points)}};
}

// Curves as [reading, map, sigma, covered], in rad or m.
Json reading_maps_json(const ReadingMaps& maps) {
  Json joints = Json::array();
  for (const ReadingMapPicture& joint : maps.joints) {
    Json curve = Json::array();
    for (const ReadingMapPoint& point : joint.points) {
      curve.push_back({rounded(point.reading, 1e-6), rounded(point.map, 1e-10),
                       rounded(point.sigma, 1e-10), point.covered ? 1 : 0});
    }
    joints.push_back({{"joint", joint.joint + 1},
                      {"revolute", joint.type == JointType::kRevolute},
                      {"covered", {joint.covered.lower, joint.covered.upper}},
                      {"tool_m_per_unit", joint.tool_m_per_unit},
                      {"largest", joint.largest},
                      {"tool_rms_m", joint.tool_rms_m},
                      {"curve", std::move(curve)}});
  }
  return {{"gravity_terms", maps.gravity_terms},
          {"gravity_rms_m", maps.gravity_rms_m},
          {"gravity_largest_m", maps.gravity_largest_m},
          {"maps_rms_m", maps.maps_rms_m},
          {"joints", std::move(joints)}};
}

Json figures_json(const std::vector<ErrorFigure>& figures) {
  Json list = Json::array();
  for (const ErrorFigure& figure : figures) {
    list.push_back({{"name", figure.name}, {"over", figure.over}, {"rms_m", figure.rms_m}});
  }
  return list;
}

Json verdict_json(const Verdict& verdict) {
  return {{"headline", verdict.headline},
          {"before_after", figures_json(verdict.before_after)},
          {"validation", verdict.validation ? Json{{"rms_m", verdict.validation->rms_m},
                                                   {"poses", verdict.validation->poses}}
                                            : Json(nullptr)},
          {"other_figures", figures_json(verdict.others)},
          {"sentences", verdict.sentences},
          {"next_steps", verdict.next_steps}};
}

std::vector<SweepPicture> pictures(const ReportInput& input) {
  std::vector<SweepPicture> all;
  if (!input.measured) return all;
  const auto method =
      input.record.method == "paper" ? features::Method::kPaper : features::Method::kEncoder;
  for (const MeasuredSweep& sweep : input.measured->sweeps) {
    auto picture = picture_of(sweep, input.record.signature.types[sweep.joint], method);
    if (picture) all.push_back(std::move(*picture));
  }
  return all;
}

}  // namespace

nlohmann::ordered_json report_json(const ReportInput& input) {
  const SignatureRecord& record = input.record;
  const auto estimate = estimate_behind(record);
  const std::vector<SweepPicture> sweeps = pictures(input);
  const auto reach =
      input.measured ? measured_reach(*input.measured) : FixedVector<JointLimits, kMaxJoints>();
  const auto map = tool_error_map(record, estimate.get(), input.truth, reach);
  const auto poses = input.measured ? pose_residuals(record, *input.measured, estimate.get())
                                    : std::optional<PoseResiduals>();
  const auto task = grid_task(record, estimate.get(), input.truth);

  Json report{{"about", about_json(input)},
              {"verdict", verdict_json(verdict(record, sweeps, map, poses))},
              {"arm", arm_json(record)},
              {"parameters", parameters_json(record, estimate.get())}};
  const auto differences = difference_table(record, estimate.get());
  report["differences"] = differences ? json_of(*differences) : Json(nullptr);
  Json sweep_list = Json::array();
  for (const SweepPicture& sweep : sweeps) sweep_list.push_back(sweep_json(sweep));
  report["sweeps"] = std::move(sweep_list);
  const auto maps = reading_maps(record);
  report["reading_maps"] = maps ? reading_maps_json(*maps) : Json(nullptr);
  report["poses"] = poses ? poses_json(*poses) : Json(nullptr);
  report["certificate"] =
      input.certifies() ? certificate_json(input, sweeps, map, poses) : Json(nullptr);
  report["map"] = map ? map_json(*map) : Json(nullptr);
  report["grid"] = nullptr;
  if (task) {
    report["grid"] = comparison_json(task->comparison);
    report["grid"]["drawn_arms"] = task->drawn_arms;
  }
  return report;
}

}  // namespace armsig::tool
