// SPDX-License-Identifier: MIT
#include "firmware/formats/orientation_columns.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

Matrix3 about_y(double angle_rad) { return rotation_about(Vector3::UnitY(), angle_rad); }

Matrix3 of_quaternion(std::span<const double> n) {
  return Eigen::Quaterniond(n[0], n[1], n[2], n[3]).normalized().toRotationMatrix();
}

// A vector along the axis, as long as the angle.
Matrix3 of_vector(std::span<const double> n) {
  const Vector3 vector(n[0], n[1], n[2]);
  const double angle_rad = vector.norm();
  return angle_rad > 0 ? rotation_about(vector / angle_rad, angle_rad)
                       : Matrix3(Matrix3::Identity());
}

// About z, the new y, the new x.
Matrix3 of_abc(std::span<const double> n) {
  return rotation_z(n[0]) * about_y(n[1]) * rotation_x(n[2]);
}

// About the fixed x, y, z.
Matrix3 of_wpr(std::span<const double> n) {
  return rotation_z(n[2]) * about_y(n[1]) * rotation_x(n[0]);
}

// About x, the new y, the new z.
Matrix3 of_xyz(std::span<const double> n) {
  return rotation_x(n[0]) * about_y(n[1]) * rotation_z(n[2]);
}

struct OrientationForm {
  std::array<std::string_view, 4> names;  // the last empty where there are three
  Matrix3 (*rotation)(std::span<const double> numbers);

  [[nodiscard]] std::size_t size() const { return names[3].empty() ? 3 : 4; }
};

constexpr std::array<OrientationForm, 6> kForms{
    {{{"qw", "qx", "qy", "qz"}, of_quaternion},
     {{"q1", "q2", "q3", "q4"}, of_quaternion},                   // ABB
     {{"ur_rx", "ur_ry", "ur_rz", ""}, of_vector},                // Universal Robots
     {{"a", "b", "c", ""}, of_abc},                               // KUKA
     {{"w", "p", "r", ""}, of_wpr},                               // FANUC
     {{"staubli_rx", "staubli_ry", "staubli_rz", ""}, of_xyz}}};  // Stäubli

constexpr std::string_view kAllForms =
    "qw, qx, qy, qz; q1 to q4 of ABB; ur_rx, ur_ry, ur_rz of Universal Robots; a, b, c of KUKA; w, "
    "p, r of FANUC; or staubli_rx, staubli_ry, staubli_rz; angles with _deg or _rad";

Dimension dimension_of_form(const OrientationForm& form) {
  return form.size() == 4 ? Dimension::kNone : Dimension::kAngle;
}

std::string names_in_words(const OrientationForm& form) {
  std::string words(form.names[0]);
  for (std::size_t k = 1; k < form.size(); ++k) words += fmt::format(", {}", form.names.at(k));
  return words;
}

// Which of the columns of a form, whose quantities begin at `first`, is not there.
std::optional<std::size_t> missing_column(const CsvTable& table, const OrientationForm& form,
                                          std::size_t first) {
  for (std::size_t k = 0; k < form.size(); ++k) {
    if (!table.has(first + k)) return k;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Quantity> orientation_quantities() {
  std::vector<Quantity> quantities;
  for (const OrientationForm& form : kForms) {
    for (std::size_t k = 0; k < form.size(); ++k) {
      quantities.push_back({.name = std::string(form.names.at(k)),
                            .dimension = dimension_of_form(form),
                            .required = false});
    }
  }
  return quantities;
}

Read<OrientationColumns> OrientationColumns::of(const CsvTable& table, std::size_t first) {
  std::optional<OrientationColumns> found;
  for (std::size_t f = 0; f < kForms.size(); ++f) {
    const OrientationForm& form = kForms.at(f);
    std::size_t there = 0;
    for (std::size_t k = 0; k < form.size(); ++k) there += table.has(first + k) ? 1 : 0;
    if (const auto missing = missing_column(table, form, first); missing && there != 0) {
      const std::string_view name = form.names.at(*missing);
      return table.problem(fmt::format("there is no column for {}", name),
                           any_of(names_of(name, dimension_of_form(form))));
    }
    if (there != 0 && found) {
      return table.problem(
          fmt::format("orientations by the columns {} and {}",
                      names_in_words(kForms.at(found->form_)), names_in_words(form)),
          "one of the two");
    }
    if (there != 0) found = OrientationColumns(f, first);
    first += form.size();
  }
  if (!found)
    return table.problem("there are no columns of an orientation", std::string(kAllForms));
  return *found;
}

Read<Matrix3> OrientationColumns::rotation(const CsvTable& table) const {
  const OrientationForm& form = kForms.at(form_);
  std::array<double, 4> numbers{};
  for (std::size_t k = 0; k < form.size(); ++k) numbers.at(k) = table.value(first_ + k);
  if (form.size() == 4) {
    constexpr double kTolerance = 1e-3;
    const double length = Eigen::Map<const Eigen::Vector4d>(numbers.data()).stableNorm();
    if (!(std::abs(length - 1) <= kTolerance)) {
      return table.problem(first_, fmt::format("a quaternion of length {:.6g}", length),
                           "a unit quaternion " + names_in_words(form));
    }
  }
  return form.rotation(std::span(numbers).first(form.size()));
}

}  // namespace armsig::tool
