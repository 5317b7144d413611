// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/arm_page.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "firmware/fleet/host/html.hpp"
#include "firmware/fleet/host/signature_page.hpp"

namespace armsig::fleet {
namespace {

constexpr std::string_view kCompare = "/compare/";
constexpr std::size_t kHashSize = 64;
using Table = Database::Table;

constexpr const char* kNow =
    "SELECT arm.online, arm.current ->> 'mode', arm.current ->> 'fault', "
    "arm.current ->> 'validation_rms_mm', "
    "round((sqrt(d.sum[1]^2 + d.sum[2]^2 + d.sum[3]^2) / s.h)::numeric, 2), "
    "to_char(d.named_at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), d.verdict, "
    "arm.current ->> 'model', arm.current ->> 'sensor', arm.current ->> 'air_c', "
    "arm.current ->> 'firmware', arm.current ->> 'serial', arm.current ->> 'late_p99_us', "
    "arm.current ->> 'signature_number', arm.current ->> 'predicted_tool_error_mm', "
    "arm.current ->> 'predicted_region', arm.current ->> 'validation_poses', "
    "(SELECT count(*) FROM row_refused r WHERE r.node = arm.node), "
    "(SELECT problem FROM row_refused r WHERE r.node = arm.node ORDER BY received_at DESC LIMIT 1) "
    "FROM arm LEFT JOIN drift d USING (node) LEFT JOIN drift_setting s ON true WHERE node = $1";

constexpr const char* kChecks =
    "SELECT sqrt((reading ->> 'dx_mm')::double precision ^ 2 + "
    "(reading ->> 'dy_mm')::double precision ^ 2 + (reading ->> 'dz_mm')::double precision ^ 2), "
    "to_char(at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI') "
    "FROM row WHERE node = $1 AND reading ? 'dx_mm' "
    "AND abs((reading ->> 'dx_mm')::double precision) < 1e6 "
    "AND abs((reading ->> 'dy_mm')::double precision) < 1e6 "
    "AND abs((reading ->> 'dz_mm')::double precision) < 1e6 "
    "ORDER BY number DESC LIMIT 200";

constexpr const char* kWornNow =
    "SELECT to_char(since AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), hash, "
    "to_char(to_timestamp(identified_ms / 1000) AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), "
    "predicted_tool_error_mm, predicted_region, validation_rms_mm, validation_poses, air_c, "
    "number, "
    "signature.document FROM worn LEFT JOIN signature USING (hash) "
    "WHERE node = $1 ORDER BY id DESC LIMIT 50";

constexpr const char* kHistory =
    "SELECT to_char(at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI:SS'), reading::text FROM row "
    "WHERE node = $1 AND NOT reading ? 'document' ORDER BY at DESC LIMIT 200";

bool is_hash(std::string_view text) {
  return text.size() == kHashSize && text.find_first_not_of("0123456789abcdef") == text.npos;
}

std::string fact(std::string_view name, const Cell& value, std::string_view attributes = "") {
  if (!value) return "";
  return fmt::format("<tr><th>{}", name) + cell(value, attributes) + "</tr>";
}

// Of the signature in use, and of no other.
std::string accuracy(const std::vector<Cell>& row) {
  std::string text = fact("signature number", row[13]);
  if (row[14] && row[15]) {
    text += fact("predicted tool error, RMS",
                 fmt::format("{} mm over: {}", decimals(row[14], 3), in_words(*row[15])));
  }
  if (row[3]) {
    text += fact("RMS on validation poses",
                 fmt::format("{} mm on {} poses", decimals(row[3], 3), row[16].value_or("some")));
  }
  if (row[9]) text += fact("identified in air of", row[9].value() + " \u00b0C");
  return text;
}

std::string now(const Table& table) {
  const auto& row = table[0];
  std::string text = "<h2>Now</h2>" + table_head("now", " class=f");
  text += row[0] == "t" ? fact("state", row[1]) : fact("state", "away", " class=bad");
  text += fact("fault", row[2], " class=bad");
  text += fact("drift, of its threshold", row[4], row[5] ? " class=bad" : "");
  text += fact("named as drifting, UTC", row[5], " class=bad");
  text += fact("last check", row[6]) + fact("goes by the", row[7]) + accuracy(row) +
          fact("sensor", row[8]);
  if (row[18]) {
    text += fact("rows set aside",
                 fmt::format("{}, the last for: {}", row[17].value_or(""), *row[18]), " class=bad");
  }
  text += fact("firmware", row[10]) + fact("serial number", row[11]);
  if (row[12]) text += fact("tick late, 99 %", row[12].value() + " \u00b5s");
  return text + "</table></div>";
}

// The length of each check's mean residual, the oldest at the left, and as numbers, the newest
// first.
std::string chart(const Table& checks) {
  if (checks.size() < 2) return "";
  double largest = 0.01;
  for (const auto& row : checks) {
    largest = std::max(largest, std::strtod(row[0].value_or("0").c_str(), nullptr));
  }
  constexpr double kWidth = 800;
  constexpr double kHeight = 120;
  std::string points;
  for (std::size_t i = checks.size(); i > 0; --i) {
    const double length = std::strtod(checks[i - 1][0].value_or("0").c_str(), nullptr);
    const auto place = static_cast<double>(checks.size() - i);
    points += fmt::format("{:.1f},{:.1f} ", place * kWidth / static_cast<double>(checks.size() - 1),
                          kHeight * (1 - length / largest));
  }
  std::string text = fmt::format(
      "<h2>Mean residual of the last {0} checks</h2><p class=ends><span>{1:.3f} mm</span></p>"
      "<svg viewBox=\"-5 -5 {2} {3}\" role=img aria-label=\"length of the mean residual, check by "
      "check; the numbers are below\"><line class=rule x2={4} /><line class=rule x2={4} y1={5} "
      "y2={5} /><polyline points=\"{6}\"/></svg><p class=ends><span>0 mm, {7}</span><span>{8} "
      "UTC</span></p>",
      checks.size(), largest, kWidth + 10, kHeight + 10, kWidth, kHeight, points,
      escaped(checks.back()[1].value_or("")), escaped(checks.front()[1].value_or("")));
  text += "<details><summary>The numbers</summary>" + table_head("mean residuals") +
          "<tr><th>checked, UTC<th class=n>mean residual, mm</tr>";
  for (const auto& row : checks) {
    text += "<tr>" + cell(row[1]) + cell(decimals(row[0], 4), kNumber) + "</tr>";
  }
  return text + "</table></div></details>";
}

std::string signatures(const Table& worn) {
  if (worn.empty()) return "";
  std::string text = "<h2>Signatures</h2>" + table_head("signatures") +
                     "<tr><th>since, UTC<th>signature<th>number<th>identified, UTC" +
                     std::string(kFigureHeads) + "<th>joint by joint</tr>";
  std::string newest;  // the last change of which both documents are there
  for (std::size_t i = 0; i < worn.size(); ++i) {
    const auto& row = worn[i];
    text += "<tr>" + cell(row[0]) + "<td>" +
            (row[1] ? link_to_signature(*row[1]) : "the nominal model");
    text +=
        cell(row[8]) + cell(row[2]) + figures({row[3], row[4], row[5], row[6], row[7]}) + "<td>";
    const auto before = std::find_if(worn.begin() + static_cast<std::ptrdiff_t>(i) + 1, worn.end(),
                                     [](const auto& former) { return former[9].has_value(); });
    if (row[9] && before != worn.end() && (*before)[1] != row[1]) {
      text += fmt::format("<a href=\"{}{}/{}\">against {}</a>", kCompare, escaped(*(*before)[1]),
                          escaped(*row[1]), escaped(std::string_view(*(*before)[1]).substr(0, 12)));
      if (newest.empty()) {
        newest = fmt::format("<h2>The last change, {}, joint by joint</h2>",
                             escaped(row[0].value_or(""))) +
                 comparison_of(*(*before)[9], *row[9]);
      }
    }
    text += "</tr>";
  }
  return text + "</table></div>" + newest;
}

Answer one_arm(std::string_view node, Database& database) {
  const std::vector<std::string> name{std::string(node)};
  const auto there = database.ask(kNow, name);
  const auto checks = database.ask(kChecks, name);
  const auto worn = database.ask(kWornNow, name);
  const auto rows = database.ask(kHistory, name);
  if (!there || !checks || !worn || !rows) return no_record();
  if (there->empty()) return {.status = 404, .body = "no such arm\n"};
  Answer page{.body = page_head(node)};
  page.body += fmt::format("<p><a href=\"/\">all arms</a></p><h1>{}</h1>", escaped(node));
  page.body += now(*there) + chart(*checks) + signatures(*worn);
  page.body +=
      "<h2>History</h2>" + table_head("history") + "<tr><th>time, UTC<th>what it reported</tr>";
  for (const auto& row : *rows) {
    page.body += "<tr>" + cell(row[0]) + cell(row[1], " class=long") + "</tr>";
  }
  page.body += "</table></div>";
  return page;
}

}  // namespace

bool is_of_one_arm(std::string_view path) {
  if (path.starts_with(kArm)) return true;
  if (path.starts_with(kSignature)) return is_hash(path.substr(kSignature.size()));
  if (!path.starts_with(kCompare)) return false;
  path.remove_prefix(kCompare.size());
  return path.size() == 2 * kHashSize + 1 && path[kHashSize] == '/' &&
         is_hash(path.substr(0, kHashSize)) && is_hash(path.substr(kHashSize + 1));
}

Answer answer_of_one_arm(std::string_view path, Database& database) {
  if (path.starts_with(kArm)) return one_arm(path.substr(kArm.size()), database);
  if (path.starts_with(kSignature)) {
    return signature_page(std::string(path.substr(kSignature.size())), database);
  }
  path.remove_prefix(kCompare.size());
  return comparison_page(std::string(path.substr(0, kHashSize)),
                         std::string(path.substr(kHashSize + 1)), database);
}

}  // namespace armsig::fleet
