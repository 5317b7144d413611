// SPDX-License-Identifier: MIT
#include <cmath>

#include <fmt/core.h>

#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

using calibration::ArmModel;
using calibration::GravityTerm;
using calibration::JointModel;
using calibration::kKnots;

std::string heading(const SignatureRecord& record) {
  std::string text =
      provenance(record) +
      "What joint i has turned (or slid) by: effective reading + d_i(readings) - d_i(readings of "
      "the "
      "signature configuration),\nd_i the sum of its map and its gravity terms.\n"
      "map: a periodic cubic B-spline of its reading q; coefficient c_k stands at knot k, whose "
      "reading is given.\nWith u = (q - reading of knot 0) / spacing, k = floor(u), t = u - k:\n"
      "((1-t)^3 c_k + (4-6t^2+3t^3) c_k+1 + (4-6(1-t)^2+3(1-t)^3) c_k+2 + t^3 c_k+3) / 6, k modulo "
      "120.\n"
      "value: the map at the reading; sigma: what it is known to, 1 sigma.\n"
      "gravity: coefficient times the lever of link origin `index` about the axis of the joint, "
      "z . ((O_index - O_joint) x down)\n(of a prismatic joint: z . down), by the nominal rows; "
      "rad "
      "or m per m.\n";
  if (record.deflections) {
    const Vector3 down = Vector3::Zero() - record.deflections->up_0;
    text += fmt::format("down in frame 0 of the nominal rows: {},{},{}\n", number_text(down.x()),
                        number_text(down.y()), number_text(down.z()));
  }

  for (std::size_t i = 0; i < record.nominal.joints.size(); ++i) {
    const DhJoint& row = record.nominal.joints[i];
    const bool revolute = row.type == JointType::kRevolute;
    const double zero = record.deflections ? record.deflections->joints[i].offset
                                           : (revolute ? row.theta_rad : row.d_m);
    text += fmt::format("nominal {}: theta_rad={},d_m={},a_m={},alpha_rad={}\n", i + 1,
                        number_text(revolute ? zero : row.theta_rad),
                        number_text(revolute ? row.d_m : zero), number_text(row.a_m),
                        number_text(row.alpha_rad));
  }
  std::string at_rest;
  const JointVector readings =
      readings_for(record.nominal.couplings, record.signature.configuration);
  for (const double reading : readings) {
    if (!at_rest.empty()) at_rest += ',';
    at_rest += number_text(reading);
  }
  return comment_text(text + "readings of the signature configuration: " + at_rest + "\n" +
                      coupling_lines(record.nominal));
}

}  // namespace

Read<std::string> maps_csv_text(const SignatureRecord& record) {
  if (!record.deflections) {
    return cannot_hold("maps-csv", "its signature has no gravity and no joint error maps",
                       "a signature that `armsig identify` found them for, by --method refined");
  }
  const ArmModel& model = *record.deflections;
  std::string text =
      heading(record) +
      "kind,joint,index,reading_rad_or_m,coefficient_rad_or_m,value_rad_or_m,sigma_rad_or_m\n";
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const JointModel& joint = model.joints[i];
    if (joint.domain.per_length == 0) continue;
    const double unit = calibration::map_unit(joint.type);
    for (std::size_t k = 0; k < kKnots; ++k) {
      const double reading = joint.domain.origin + static_cast<double>(k) / joint.domain.per_length;
      text += fmt::format("map,{},{},{},{},{},{}\n", i + 1, k, number_text(reading),
                          number_text(unit * joint.map[k]),
                          number_text(calibration::map_at(joint, reading)),
                          number_text(std::sqrt(calibration::map_variance_at(joint, reading))));
    }
  }
  for (const GravityTerm& term : model.gravity) {
    text += fmt::format("gravity,{},{},,{},,\n", term.joint + 1, term.origin,
                        number_text(term.coefficient));
  }
  return text;
}

}  // namespace armsig::tool
