// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/page.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "firmware/fleet/host/arm_page.hpp"
#include "firmware/fleet/host/html.hpp"

namespace armsig::fleet {
namespace {

constexpr const char* kArms =
    "SELECT arm.node, arm.online, arm.current ->> 'mode', arm.current ->> 'fault', "
    "arm.current ->> 'validation_rms_mm', "
    "round((sqrt(d.sum[1]^2 + d.sum[2]^2 + d.sum[3]^2) / s.h)::numeric, 2), "
    "d.named_at IS NOT NULL, to_char(d.last_at AT TIME ZONE 'UTC', 'YYYY-MM-DD HH24:MI'), "
    "d.verdict, arm.current ->> 'signature', arm.current ->> 'firmware' "
    "FROM arm LEFT JOIN drift d USING (node) LEFT JOIN drift_setting s ON true "
    "ORDER BY d.named_at IS NULL, arm.current ->> 'fault' IS NULL, arm.node LIMIT 5000";

// Rows that are laid out together, or not; about two screens.
constexpr std::size_t kLot = 50;

constexpr const char* kNamed =
    "SELECT count(*) FILTER (WHERE named_at IS NOT NULL), coalesce((SELECT sum(dropped) FROM "
    "journal), 0), (SELECT count(*) FROM arm), (SELECT count(*) FROM arm WHERE "
    "current ->> 'mode' = 'faulted'), coalesce((SELECT sum(documents) FROM signature_refused), 0), "
    "(SELECT count(*) FROM row_refused) "
    "FROM drift";

Answer arms(Database& database) {
  const auto table = database.ask(kArms);
  if (!table) return {.status = 503, .body = "the record does not answer\n"};
  Answer page{.body = page_head("Arms")};
  const auto drifting =
      std::ranges::count_if(*table, [](const auto& row) { return row[6] == "t"; });
  const auto there = std::ranges::count_if(*table, [](const auto& row) { return row[1] == "t"; });
  page.body += fmt::format(
      "<h1>{} arms</h1><p>{} connected, {} away, {} drifting</p><p>Validation: of the signature in "
      "use, "
      "RMS on its validation poses, the sensor's noise included. Drift: the sum of all checks over "
      "its threshold; from 1 on the arm is "
      "named.</p>{}<thead><tr>"
      "<th>arm<th>state<th>fault<th class=n>validation, mm<th class=n>drift<th>last check, UTC"
      "<th>verdict<th>signature<th>firmware</tr></thead>",
      table->size(), there, std::ssize(*table) - there, drifting,
      table_head("arms", " class=arms"));
  for (std::size_t i = 0; i < table->size(); ++i) {
    const auto& row = (*table)[i];
    if (i % kLot == 0) page.body += "<tbody>";
    const std::string name = escaped(row[0].value_or(""));
    page.body += fmt::format("<tr><td><a href=\"/arm/{0}\">{0}</a></td>", name);
    page.body += row[1] == "t" ? cell(row[2]) : cell("away", " class=bad");
    page.body += cell(row[3], " class=bad") + cell(decimals(row[4], 3), kNumber);
    page.body += cell(row[5], row[6] == "t" ? " class=\"n bad\"" : kNumber);
    page.body += cell(row[7]) + cell(row[8]);
    page.body += row[9] ? fmt::format("<td><a href=\"/signature/{0}\">{1}</a></td>",
                                      escaped(*row[9]), escaped(row[9]->substr(0, 12)))
                        : "<td>the nominal model</td>";
    page.body += cell(row[10]) + "</tr>";
  }
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
  add("rebirths_total", "Controllers asked to report everything anew", counts.rebirths);
  metric(text, "arms_online", "gauge", "Controllers online", std::to_string(intake.online()));
  const auto named = database != nullptr ? database->ask(kNamed) : std::nullopt;
  metric(text, "record_up", "gauge", "Whether the record answers", named ? "1" : "0");
  if (!named || named->empty()) return answer;
  const auto& row = (*named)[0];
  metric(text, "arms_drifting", "gauge", "Arms named by the drift sum", row[0].value_or("0"));
  metric(text, "rows_dropped", "gauge", "Rows that controllers lost, their ring being full",
         row[1].value_or("0"));
  metric(text, "arms", "gauge", "Arms known", row[2].value_or("0"));
  metric(text, "arms_faulted", "gauge", "Arms whose controller is faulted", row[3].value_or("0"));
  metric(text, "signatures_refused", "gauge", "Documents that were not what their hash says",
         row[4].value_or("0"));
  metric(text, "rows_refused", "gauge", "Rows that the record could not take, which are set aside",
         row[5].value_or("0"));
  return answer;
}

}  // namespace

Answer answer(std::string_view path, const Intake& intake, Database* database) {
  if (path == "/metrics") return metrics(intake, database);
  if (path != "/" && !is_of_one_arm(path)) return {.status = 404, .body = "nothing here\n"};
  if (database == nullptr) return {.status = 503, .body = "the record is not there\n"};
  return path == "/" ? arms(*database) : answer_of_one_arm(path, *database);
}

}  // namespace armsig::fleet
