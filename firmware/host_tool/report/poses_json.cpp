// SPDX-License-Identifier: MIT
#include "firmware/host_tool/report/poses_json.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::tool {
namespace {

using PosesJson = nlohmann::ordered_json;

constexpr std::size_t kShownPoses = 3000;
constexpr std::size_t kWorstPoses = 10;  // in any case

// Pictures need no 17 digits.
double to_unit(double value, double unit) { return std::round(value / unit) * unit; }

PosesJson vector_json(const Vector3& v, double unit) {
  return {to_unit(v.x(), unit), to_unit(v.y(), unit), to_unit(v.z(), unit)};
}

PosesJson summary_json(const ResidualSummary& summary) {
  return {{"rows", summary.rows},
          {"mean_m", summary.mean_m},
          {"rms_m", summary.rms_m},
          {"largest_m", summary.largest_m}};
}

PosesJson pose_json(const PoseResidual& pose) {
  PosesJson readings = PosesJson::array();
  for (const double reading : pose.q) readings.push_back(to_unit(reading, 1e-6));
  PosesJson along = PosesJson::array();
  for (const auto& component : pose.along_m) {
    along.push_back(component ? PosesJson(to_unit(*component, 1e-8)) : PosesJson(nullptr));
  }
  return {{"line", pose.line},
          {"target", pose.target},
          {"q", std::move(readings)},
          {"p", vector_json(pose.p_S, 1e-6)},
          {"e", vector_json(pose.error_S, 1e-9)},
          {"stated_m", to_unit(pose.stated_m, 1e-9)},
          {"outlier", pose.outlier ? 1 : 0},
          {"along_m", std::move(along)}};
}

}  // namespace

nlohmann::ordered_json poses_json(const PoseResiduals& poses) {
  std::vector<double> lengths;
  for (const PoseResidual& pose : poses.poses) lengths.push_back(pose.length_m());
  std::ranges::sort(lengths, std::greater{});
  const double worst_m = lengths[std::min(kWorstPoses, lengths.size()) - 1];
  const std::size_t every = 1 + (poses.poses.size() - 1) / kShownPoses;
  PosesJson list = PosesJson::array();
  for (std::size_t k = 0; k < poses.poses.size(); ++k) {
    const PoseResidual& pose = poses.poses[k];
    if (k % every == 0 || pose.outlier || pose.length_m() >= worst_m) {
      list.push_back(pose_json(pose));
    }
  }
  return {{"fitted", poses.fitted},
          {"signature", summary_json(poses.signature)},
          {"outliers", poses.outliers},
          {"nominal", poses.nominal ? summary_json(*poses.nominal) : PosesJson(nullptr)},
          {"stated_rms_m", poses.stated_rms_m},
          {"histogram",
           {{"bin_m", poses.histogram.bin_m},
            {"counts", poses.histogram.counts},
            {"expected", poses.histogram.expected}}},
          {"shown_every", every},
          {"poses", std::move(list)}};
}

}  // namespace armsig::tool
