// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/signature_page.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/base/pose.hpp"
#include "firmware/fleet/host/html.hpp"
#include "firmware/fleet/host/signature_comparison.hpp"
#include "firmware/fleet/wire/signature_document.hpp"

namespace armsig::fleet {
namespace {

constexpr const char* kWearers =
    "SELECT node, to_char(since AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), "
    "to_char(to_timestamp(identified_ms / 1000) AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), "
    "predicted_tool_error_mm, predicted_region, validation_rms_mm, validation_poses, air_c, number "
    "FROM worn WHERE hash = $1 ORDER BY id DESC LIMIT 50";

constexpr const char* kDocumentByHash = "SELECT document FROM signature WHERE hash = $1";

// An angle in degrees, a length in mm; of a slide with its unit.
std::string of_joint(JointType type, double value, int count) {
  return type == JointType::kPrismatic ? fmt::format("{:.{}f} mm", 1e3 * value, count)
                                       : fmt::format("{:.{}f}", degrees(value), count);
}

// With the sign of a change; none where it is nought in so many decimals.
std::string with_sign(const std::string& number) {
  const bool negative = number.starts_with('-');
  if (number.find_first_of("123456789") == std::string::npos) {
    return negative ? number.substr(1) : number;
  }
  return negative ? number : "+" + number;
}

// Of each joint the largest value of its map, and deflection by gravity to it.
std::string bends_of(const DocumentedSignature& signature) {
  if (signature.deflections.empty()) return "";
  const auto model =
      std::make_unique<calibration::ArmModel>(unpacked(signature.deflections, signature.arm));
  std::string text = "<h2>Joint error maps and gravity terms</h2>" +
                     table_head("maps and gravity") +
                     "<tr><th>joint<th class=n>largest of its map, \u00b0<th class=n>deflection, "
                     "\u00b0 a metre of lever</tr>";
  for (std::size_t i = 0; i < model->joint_count(); ++i) {
    JointDifference joint{.type = model->joints[i].type};
    const auto& map = signature.deflections.maps[i];
    for (const std::int16_t step : map.steps) {
      joint.map = std::max(joint.map, map.step * std::abs(static_cast<double>(step)));
    }
    for (const auto& term : model->gravity) {
      if (term.joint == i) joint.gravity = std::max(joint.gravity, std::abs(term.coefficient));
    }
    text += fmt::format("<tr><th>{}<td class=n>{}<td class=n>{}</tr>", i + 1,
                        of_joint(joint.type, joint.map, 4), of_joint(joint.type, joint.gravity, 5));
  }
  return text + "</table></div>";
}

std::string parameters_of(const Arm& arm) {
  std::string text =
      table_head("parameters") +
      "<tr><th>joint<th>type<th class=n>\u03b8, \u00b0<th class=n>d, mm<th class=n>a, mm"
      "<th class=n>\u03b1, \u00b0</tr>";
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    text += fmt::format(
        "<tr><th>{}<td>{}<td class=n>{:.6f}<td class=n>{:.4f}<td class=n>{:.4f}"
        "<td class=n>{:.6f}</tr>",
        i + 1, row.type == JointType::kPrismatic ? "prismatic" : "revolute", degrees(row.theta_rad),
        1e3 * row.d_m, 1e3 * row.a_m, degrees(row.alpha_rad));
  }
  return text +
         "</table></div><p>Pseudo Denavit-Hartenberg rows; near parallel axes only their product "
         "means anything.</p>";
}

}  // namespace

std::string figures(const Figures& of) {
  return cell(of.region ? decimals(of.predicted_mm, 3) : "", kNumber) +
         cell(of.region ? in_words(*of.region) : "") +
         cell(decimals(of.validation_mm, 3), kNumber) + cell(of.poses, kNumber) +
         cell(decimals(of.air_c, 1), kNumber);
}

std::string in_words(std::string_view region) {
  if (region == "configuration") return "signature configuration";
  if (region == "measured") return "measured readings";
  return region == "limits" ? "joint limits" : std::string(region);
}

Answer no_record() { return {.status = 503, .body = "the record does not answer\n"}; }

std::string link_to_signature(const std::string& hash) {
  return fmt::format("<a href=\"{}{}\">{}</a>", kSignature, escaped(hash),
                     escaped(std::string_view(hash).substr(0, 12)));
}

std::string comparison_of(std::string_view before, std::string_view actual) {
  const auto compared = compare_signatures(before, actual);
  if (!compared) return "<p>These two are not of one arm, or cannot be read.</p>";
  std::string text = table_head("joint by joint") +
                     "<tr><th>joint<th class=n>axis tilted, \u00b0<th class=n>shifted, mm"
                     "<th class=n>zero, \u00b0<th class=n>adds at the tool, mm";
  if (compared->bends) text += "<th class=n>map, \u00b0<th class=n>gravity, \u00b0 a metre";
  text += "</tr>";
  for (std::size_t i = 0; i < compared->joints.size(); ++i) {
    const JointDifference& joint = compared->joints[i];
    text +=
        fmt::format("<tr><th>{}<td class=n>{:.4f}<td class=n>{:.3f}<td class=n>{}<td class=n>{}",
                    i + 1, degrees(joint.tilt_rad), 1e3 * joint.shift_m,
                    with_sign(of_joint(joint.type, joint.zero, 4)),
                    with_sign(fmt::format("{:.3f}", 1e3 * joint.adds_m)));
    if (compared->bends) {
      text += fmt::format("<td class=n>{}<td class=n>{}", of_joint(joint.type, joint.map, 4),
                          of_joint(joint.type, joint.gravity, 5));
    }
    text += "</tr>";
  }
  text += fmt::format(
      "</table></div><p>Together {:.3f} mm at the tool (RMS over the work volume, "
      "base and tool fitted). Each axis is held against the link before it.",
      1e3 * compared->tool_rms_m);
  if (compared->bends) {
    text +=
        " Map and gravity are the largest changes of what a joint's reading is wrong by, and of "
        "its deflection for a metre of lever";
    text += compared->whole ? "; what they do at the tool is in the sum."
                            : "; the sum has none of them, as an older armsig-node reported one of "
                              "these signatures.";
  }
  return text + "</p>";
}

Answer signature_page(const std::string& hash, Database& database) {
  const auto wearers = database.ask(kWearers, {hash});
  const auto document = database.ask(kDocumentByHash, {hash});
  if (!wearers || !document) return no_record();
  if (wearers->empty() && document->empty()) return {.status = 404, .body = "no such signature\n"};
  Answer page{.body = page_head("Signature " + hash.substr(0, 12))};
  page.body += fmt::format(
      "<p><a href=\"/\">all arms</a></p><h1>Signature {0}</h1><p>SHA-256 {1}</p><h2>Arms that went "
      "by "
      "it</h2>{2}<tr><th>arm<th>since, UTC<th>number<th>identified, UTC{3}</tr>",
      hash.substr(0, 12), hash, table_head("arms that went by it"), kFigureHeads);
  for (const auto& row : *wearers) {
    const std::string name = escaped(row[0].value_or(""));
    page.body += fmt::format("<tr><td><a href=\"{0}{1}\">{1}</a>", kArm, name);
    page.body += cell(row[1]) + cell(row[8]) + cell(row[2]) +
                 figures({row[3], row[4], row[5], row[6], row[7]}) + "</tr>";
  }
  page.body += "</table></div><h2>Parameters</h2>";
  if (document->empty()) {
    page.body += "<p>The document has not arrived.</p>";
    return page;
  }
  const std::string text = (*document)[0][0].value_or("");
  if (const auto documented = read_signature_document(text)) {
    page.body += parameters_of(documented->arm) + bends_of(*documented);
  }
  page.body += fmt::format("<h2>Document</h2><p class=long>{}</p>", escaped(text));
  return page;
}

Answer comparison_page(const std::string& before, const std::string& actual, Database& database) {
  const auto former = database.ask(kDocumentByHash, {before});
  const auto newer = database.ask(kDocumentByHash, {actual});
  if (!former || !newer) return no_record();
  if (former->empty() || newer->empty()) return {.status = 404, .body = "no such signature\n"};
  Answer page{.body = page_head("Two signatures")};
  page.body += fmt::format("<p><a href=\"/\">all arms</a></p><h1>{} against {}</h1>",
                           link_to_signature(actual), link_to_signature(before));
  page.body += comparison_of((*former)[0][0].value_or(""), (*newer)[0][0].value_or(""));
  return page;
}

}  // namespace armsig::fleet
