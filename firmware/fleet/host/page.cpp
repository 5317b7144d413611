// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/page.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

constexpr std::string_view kHead =
    "<!doctype html><html lang=en><meta charset=utf-8>"
    "<meta name=viewport content=\"width=device-width\"><title>Arms</title><style>"
    "body{font:15px/1.4 system-ui,sans-serif;margin:1rem;color:#1b1f24;background:#fff}"
    "div{overflow-x:auto}table{border-collapse:collapse;white-space:nowrap}"
    "th,td{text-align:left;padding:.3rem .8rem .3rem 0;border-bottom:1px solid #d0d7de}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}"
    ".bad{color:#b3261e;font-weight:600}a{color:#0b57d0}</style>";

constexpr const char* kArms =
    "SELECT arm.node, arm.online, arm.current ->> 'mode', arm.current ->> 'fault', "
    "arm.current ->> 'held_out_mm', "
    "round((sqrt(d.sum[1]^2 + d.sum[2]^2 + d.sum[3]^2) / s.h)::numeric, 2), "
    "d.named_at IS NOT NULL, to_char(d.last_at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), "
    "d.verdict, left(arm.current ->> 'signature', 12), arm.current ->> 'firmware' "
    "FROM arm LEFT JOIN drift d USING (node) LEFT JOIN drift_setting s ON true "
    "ORDER BY d.named_at IS NULL, arm.current ->> 'fault' IS NULL, arm.node LIMIT 5000";

constexpr const char* kHistory =
    "SELECT to_char(at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI:SS'), reading::text FROM row "
    "WHERE node = $1 ORDER BY at DESC LIMIT 200";

constexpr const char* kNamed =
    "SELECT count(*) FILTER (WHERE named_at IS NOT NULL), coalesce((SELECT sum(dropped) FROM "
    "journal), 0), (SELECT count(*) FROM arm), (SELECT count(*) FROM arm WHERE "
    "current ->> 'mode' = 'faulted') FROM drift";

using Cell = std::optional<std::string>;

std::string cell(const Cell& text, std::string_view kind = "") {
  return fmt::format("<td{}>{}</td>", kind, escaped(text.value_or("")));
}

std::string three_digits(const Cell& number) {
  return number ? fmt::format("{:.3f}", std::stod(*number)) : "";
}

Answer arms(Database& database) {
  const auto table = database.ask(kArms);
  if (!table) return {.status = 503, .body = "the record does not answer\n"};
  Answer page{.body = std::string(kHead)};
  const auto drifting =
      std::ranges::count_if(*table, [](const auto& row) { return row[6] == "t"; });
  const auto there = std::ranges::count_if(*table, [](const auto& row) { return row[1] == "t"; });
  page.body += fmt::format(
      "<h1>{} arms</h1><p>{} there, {} drifting<div><table><tr>"
      "<th>arm<th>state<th>fault<th>accuracy, mm<th>drift<th>last check, UTC"
      "<th>verdict<th>signature<th>firmware</tr>",
      table->size(), there, drifting);
  for (const auto& row : *table) {
    const std::string name = escaped(row[0].value_or(""));
    page.body += fmt::format("<tr><td><a href=\"/arm/{0}\">{0}</a></td>", name);
    page.body += row[1] == "t" ? cell(row[2]) : cell("away", " class=bad");
    page.body += cell(row[3], " class=bad") + cell(three_digits(row[4]), " class=n");
    page.body += cell(row[5], row[6] == "t" ? " class=\"n bad\"" : " class=n");
    page.body += cell(row[7]) + cell(row[8]) + cell(row[9]) + cell(row[10]) + "</tr>";
  }
  page.body +=
      "</table></div><p>Drift: the sum of all checks over its threshold; from 1 on the arm "
      "is named.";
  return page;
}

Answer one_arm(std::string_view node, Database& database) {
  const auto rows = database.ask(kHistory, {std::string(node)});
  if (!rows) return {.status = 503, .body = "the record does not answer\n"};
  if (rows->empty()) return {.status = 404, .body = "no such arm\n"};
  Answer page{.body = std::string(kHead)};
  page.body += fmt::format(
      "<p><a href=\"/\">all arms</a><h1>{}</h1><div><table>"
      "<tr><th>time, UTC<th>what it told</tr>",
      escaped(node));
  for (const auto& row : *rows) page.body += "<tr>" + cell(row[0]) + cell(row[1]) + "</tr>";
  page.body += "</table></div>";
  return page;
}

void metric(std::string& text, std::string_view name, std::string_view type, std::string_view help,
            std::string_view value) {
  text += fmt::format("# HELP armsig_{0} {1}\n# TYPE armsig_{0} {2}\narmsig_{0} {3}\n", name, help,
                      type, value);
}

Answer metrics(const Intake& intake, Database* database) {
  Answer answer{.type = "text/plain; version=0.0.4", .body = {}};
  std::string& text = answer.body;
  const Intake::Counts& counts = intake.counts();
  const auto add = [&](std::string_view name, std::string_view help, std::uint64_t value) {
    metric(text, name, "counter", help, std::to_string(value));
  };
  add("rows_total", "Rows taken since the start", counts.rows);
  add("rows_repeated_total", "Rows that came once more", counts.repeated);
  add("rows_early_total", "Rows without the one before", counts.early);
  add("messages_malformed_total", "Messages that could not be read", counts.malformed);
  add("rebirths_total", "Cabinets asked to tell everything anew", counts.rebirths);
  metric(text, "arms_online", "gauge", "Cabinets that are there", std::to_string(intake.online()));
  const auto named = database != nullptr ? database->ask(kNamed) : std::nullopt;
  metric(text, "record_up", "gauge", "Whether the record answers", named ? "1" : "0");
  if (!named || named->empty()) return answer;
  const auto& row = (*named)[0];
  metric(text, "arms_drifting", "gauge", "Arms named by the drift sum", row[0].value_or("0"));
  metric(text, "rows_dropped", "gauge", "Rows that cabinets lost, their ring being full",
         row[1].value_or("0"));
  metric(text, "arms", "gauge", "Arms known", row[2].value_or("0"));
  metric(text, "arms_faulted", "gauge", "Arms whose controller is faulted", row[3].value_or("0"));
  return answer;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

Answer answer(std::string_view path, const Intake& intake, Database* database) {
  constexpr std::string_view kArm = "/arm/";
  if (path == "/metrics") return metrics(intake, database);
  if (path != "/" && !path.starts_with(kArm)) return {.status = 404, .body = "nothing here\n"};
  if (database == nullptr) return {.status = 503, .body = "the record is not there\n"};
  return path == "/" ? arms(*database) : one_arm(path.substr(kArm.size()), *database);
}

}  // namespace armsig::fleet
