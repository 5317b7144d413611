// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/database.hpp"

#include <libpq-fe.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include <fmt/format.h>

#include "firmware/fleet/host/migrations.hpp"
#include "firmware/fleet/host/row_text.hpp"

namespace armsig::fleet {
namespace {

// Two hosts that start at once take turns.
constexpr const char* kLock = "SELECT pg_advisory_lock(7263541)";
constexpr const char* kUnlock = "SELECT pg_advisory_unlock(7263541)";

// Of rows that tell something which the record keeps apart: what is done with each, in their order.
constexpr std::string_view kWorn = "SELECT worn_take(node, at, reading)";
constexpr std::string_view kDocument =
    "SELECT document_take(node, reading ->> 'document', number_of(reading, 'document_part'), "
    "number_of(reading, 'document_parts'), reading ->> 'document_text')";
constexpr std::string_view kDrift =
    "SELECT drift_take(node, at, reading ->> 'verdict', (reading ->> 'dx_mm')::double precision, "
    "(reading ->> 'dy_mm')::double precision, (reading ->> 'dz_mm')::double precision)";
constexpr std::string_view kEach =
    " FROM (SELECT *, to_timestamp(ms / 1000) AS at FROM unnest($1::text[], "
    "$2::double precision[], $3::jsonb[]) WITH ORDINALITY AS r(node, ms, reading, place) "
    "ORDER BY place) AS come ";
constexpr std::string_view kMeasured =
    "WHERE abs((reading ->> 'dx_mm')::double precision) < 1e6 "
    "AND abs((reading ->> 'dy_mm')::double precision) < 1e6 "
    "AND abs((reading ->> 'dz_mm')::double precision) < 1e6";

// Parts of documents are told in passing, and are nothing that an arm is.
bool is_of_document(Item item) {
  return item >= Item::kDocumentHash && item <= Item::kDocumentText;
}

// Whether an error of this SQLSTATE is of what was to be stored, and not of the record: its
// connection, memory, disk and locks. A key that is there already is no cabinet's either.
bool is_of_data(std::string_view state) {
  constexpr std::string_view kUnique = "23505";
  constexpr std::array<std::string_view, 6> kOfData{"21", "22", "23", "38", "54", "P0"};
  return state != kUnique && std::ranges::any_of(kOfData, [&](std::string_view known) {
           return state.starts_with(known);
         });
}

// What is told of a signature replaces all that was known of the one before. Where a row names
// none, its figures are of none.
bool names_signature(const Readings& readings) {
  return std::ranges::find(readings.begin(), readings.end(), Item::kSignatureHash,
                           &Reading::item) != readings.end();
}

// A birth has all items, those that the cabinet has not heard yet without a value.
bool knows_signature(const Readings& birth) {
  return std::ranges::any_of(birth, [](const Reading& reading) {
    return (reading.item == Item::kSignatureHash && reading.value != Value()) ||
           (reading.item == Item::kModel && reading.value == Value(Text("nominal")));
  });
}

void forget_signature(Readings& known) {
  Readings rest;
  for (const Reading& reading : known) {
    if (!is_of_signature(reading.item)) rest.push_back(reading);
  }
  known = rest;
}

// Every key of a signature, as an array of SQL.
std::string signature_keys() {
  std::string keys = "{";
  for (const Item item : kOfSignature) {
    if (keys.size() > 1) keys += ',';
    keys += key_of(item);
  }
  return keys + '}';
}

std::string bits(std::uint64_t journal) {
  return std::to_string(std::bit_cast<std::int64_t>(journal));
}

}  // namespace

void Database::Close::operator()(pg_conn* connection) const { PQfinish(connection); }
void Database::Clear::operator()(pg_result* result) const { PQclear(result); }

std::optional<Database> Database::open(const std::string& connection, const DriftSettings& drift,
                                       std::string& problem) {
  const std::array<const char*, 5> keys{"connect_timeout", "application_name", "dbname", nullptr};
  const std::array<const char*, 5> values{"5", "armsig-fleet", connection.c_str(), nullptr};
  Database database(PQconnectdbParams(keys.data(), values.data(), 1));
  // Compiling a question takes longer than any of ours.
  const bool good = PQstatus(database.connection_.get()) == CONNECTION_OK &&
                    database.run("SET client_min_messages = warning") &&
                    database.run("SET jit = off") && database.migrate() && database.keep(drift);
  if (good) return database;
  problem = database.problem();
  return std::nullopt;
}

void Database::note_failure(const pg_result* result) {
  const char* const state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
  failed_state_ = state != nullptr ? state : "";
  failed_ = PQerrorMessage(connection_.get());
  // The message is in the server's language, the code is the same in all.
  if (!failed_state_.empty()) failed_ += fmt::format("(SQLSTATE {})", failed_state_);
}

std::string Database::problem() const {
  std::string text = failed_.empty() ? PQerrorMessage(connection_.get()) : failed_;
  while (text.ends_with('\n')) text.pop_back();
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

bool Database::run(const char* command) {
  const Result result(PQexec(connection_.get(), command));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK) return true;
  note_failure(result.get());
  return false;
}

bool Database::run(const char* command, const std::vector<std::string>& arguments) {
  return ask(command, arguments).has_value();
}

std::optional<Database::Table> Database::ask(const char* question,
                                             const std::vector<std::string>& arguments) {
  std::vector<const char*> values;
  for (const std::string& argument : arguments) values.push_back(argument.c_str());
  const Result result(PQexecParams(connection_.get(), question, static_cast<int>(values.size()),
                                   nullptr, values.data(), nullptr, nullptr, 0));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status == PGRES_COMMAND_OK) return Table{};
  if (status != PGRES_TUPLES_OK) {
    note_failure(result.get());
    return std::nullopt;
  }
  Table table(static_cast<std::size_t>(PQntuples(result.get())));
  for (std::size_t row = 0; row < table.size(); ++row) {
    for (int column = 0; column < PQnfields(result.get()); ++column) {
      const int r = static_cast<int>(row);
      table[row].push_back(PQgetisnull(result.get(), r, column) != 0
                               ? std::nullopt
                               : std::optional<std::string>(PQgetvalue(result.get(), r, column)));
    }
  }
  return table;
}

// Each migration in a transaction of its own, once and in order.
bool Database::migrate() {
  if (!run(kLock) || !run("CREATE TABLE IF NOT EXISTS migration (number integer PRIMARY KEY, "
                          "done_at timestamptz NOT NULL DEFAULT now())")) {
    return false;
  }
  const auto done = ask("SELECT coalesce(max(number), 0) FROM migration");
  if (!done || done->empty()) return false;
  const int last = std::stoi((*done)[0][0].value_or("0"));
  int number = 0;
  for (const char* migration : kMigrations) {
    if (++number <= last) continue;
    if (!run("BEGIN") || !run(migration) ||
        !run("INSERT INTO migration (number) VALUES ($1::integer)", {std::to_string(number)}) ||
        !run("COMMIT")) {
      return false;
    }
  }
  return run(kUnlock);
}

bool Database::keep(const DriftSettings& drift) {
  return run(
      "INSERT INTO drift_setting (sigma_mm, k, h, baseline) VALUES ($1::double precision, "
      "$2::double precision, $3::double precision, $4::integer) ON CONFLICT (one) DO UPDATE SET "
      "sigma_mm = excluded.sigma_mm, k = excluded.k, h = excluded.h, baseline = excluded.baseline",
      {fmt::format("{}", drift.sigma_mm), fmt::format("{}", drift.reference),
       fmt::format("{}", drift.threshold), std::to_string(drift.baseline)});
}

std::optional<std::vector<Intake::Journal>> Database::journals() {
  // Nobody is known to be there until it has told.
  if (!run("UPDATE arm SET online = false, changed_at = now() WHERE online")) return std::nullopt;
  const auto table = ask("SELECT node, journal, contiguous FROM journal");
  if (!table) return std::nullopt;
  std::vector<Intake::Journal> journals;
  for (const auto& row : *table) {
    journals.push_back(
        {.node = row[0].value_or(""),
         .journal = std::bit_cast<std::uint64_t>(std::int64_t{std::stoll(row[1].value_or("0"))}),
         .contiguous = std::stoull(row[2].value_or("0"))});
  }
  return journals;
}

bool Database::store(const Batch& batch) {
  set_aside_.clear();
  bool good = run("BEGIN");
  if (good) {
    const auto whole = attempt([&] { return store_whole(batch); });
    good = whole == Attempt::kStored || (whole == Attempt::kRefused && store_by_arm(batch));
  }
  if (good && run("COMMIT")) return true;
  const std::string why = failed_;  // the end of the transaction has none
  (void)run("ROLLBACK");
  failed_ = why;
  set_aside_.clear();
  return false;
}

bool Database::store_whole(const Batch& batch) { return store_states(batch) && store_rows(batch); }

template <typename Store>
Database::Attempt Database::attempt(const Store& store) {
  if (!run("SAVEPOINT part")) return Attempt::kFailed;
  if (store()) return run("RELEASE SAVEPOINT part") ? Attempt::kStored : Attempt::kFailed;
  const std::string why = problem();
  const bool of_data = is_of_data(failed_state_);
  const bool back = run("ROLLBACK TO SAVEPOINT part; RELEASE SAVEPOINT part");
  failed_ = why;
  return back && of_data ? Attempt::kRefused : Attempt::kFailed;
}

// One arm's values are no reason to lose another's.
bool Database::store_by_arm(const Batch& batch) {
  std::map<std::string_view, Batch> arms;
  for (const StoredState& state : batch.states) arms[state.node].states.push_back(state);
  for (const StoredRow& row : batch.rows) arms[row.node].rows.push_back(row);
  return std::ranges::all_of(arms, [&](const auto& named) {
    const Batch& arm = named.second;
    const auto whole = attempt([&] { return store_whole(arm); });
    return whole == Attempt::kStored || (whole == Attempt::kRefused && store_by_row(arm));
  });
}

// Of the arm that it is refused of: what can be stored is, and the rest is set aside. True unless
// the record itself fails.
bool Database::store_by_row(const Batch& arm) {
  const auto stored = [&](const auto& first, const auto& instead) {
    const Attempt one = attempt(first);
    return one == Attempt::kStored ||
           (one == Attempt::kRefused && attempt(instead) != Attempt::kFailed);
  };
  if (!arm.states.empty()) {
    StoredState bare = arm.states.back();
    bare.current.clear();
    const auto as_told = [&] { return store_states({.states = arm.states, .rows = {}}); };
    const auto known = [&] { return store_states({.states = {bare}, .rows = {}}); };
    if (!stored(as_told, known)) return false;
  }
  return std::ranges::all_of(arm.rows, [&](const StoredRow& row) {
    return stored([&] { return store_rows({.states = {}, .rows = {row}}); },
                  [&] { return set_aside(row); });
  });
}

// The row counts as arrived: it would be refused each time that it came.
bool Database::set_aside(const StoredRow& row) {
  const std::string why = problem();
  if (set_aside_.empty()) {
    set_aside_ = fmt::format("a row of {} is set aside: number {}: {}", row.node, row.number, why);
  }
  return run(
      "WITH furthest AS (INSERT INTO journal (node, journal, contiguous, dropped) VALUES "
      "($1::text, $2::bigint, $3::bigint, $4::bigint) ON CONFLICT (node, journal) DO UPDATE SET "
      "contiguous = excluded.contiguous, dropped = greatest(journal.dropped, excluded.dropped)) "
      "INSERT INTO row_refused (node, journal, number, at, reading, problem) VALUES ($1::text, "
      "$2::bigint, $3::bigint, to_timestamp($5::double precision / 1000), $6::text, $7::text) "
      "ON CONFLICT DO NOTHING",
      {row.node, bits(row.journal), std::to_string(row.number), std::to_string(row.dropped),
       std::to_string(row.time_ms), json_of(row.readings), why});
}

// The last state of each arm counts.
bool Database::store_states(const Batch& batch) {
  std::map<std::string_view, const StoredState*> last;
  for (const StoredState& state : batch.states) last[state.node] = &state;
  if (last.empty()) return true;
  ArrayText nodes;
  ArrayText online;
  ArrayText current;
  for (const auto& [node, state] : last) {
    nodes.add(node);
    online.add(state->online ? "t" : "f");
    const bool knows = knows_signature(state->current);
    Readings told;
    for (const Reading& reading : state->current) {
      const bool skipped =
          is_of_document(reading.item) || (is_of_signature(reading.item) && !knows);
      if (!skipped) told.push_back(reading);
    }
    current.add(json_of(told));
  }
  return run(
      "INSERT INTO arm (node, online, current) SELECT * FROM unnest($1::text[], $2::boolean[], "
      "$3::jsonb[]) ON CONFLICT (node) DO UPDATE SET online = excluded.online, changed_at = now(), "
      "current = (CASE WHEN excluded.current ? 'signature' THEN arm.current - $4::text[] ELSE "
      "arm.current END) || jsonb_strip_nulls(excluded.current)",
      {nodes.text(), online.text(), current.text(), signature_keys()});
}

// The key refuses what would be there twice, and with it the whole transaction.
bool Database::store_rows(const Batch& batch) {
  if (batch.rows.empty()) return true;
  ArrayText nodes;
  ArrayText journals;
  ArrayText numbers;
  ArrayText times;
  ArrayText historical;
  ArrayText dropped;
  ArrayText readings;
  for (const StoredRow& row : batch.rows) {
    nodes.add(row.node);
    journals.add(bits(row.journal));
    numbers.add(std::to_string(row.number));
    times.add(std::to_string(row.time_ms));
    historical.add(row.historical ? "t" : "f");
    dropped.add(std::to_string(row.dropped));
    readings.add(json_of(row.readings));
  }
  return run("WITH come AS (SELECT * FROM unnest($1::text[], $2::bigint[], $3::bigint[], "
             "$4::double precision[], $5::bigint[], $6::boolean[], $7::jsonb[]) "
             "AS r(node, journal, number, ms, dropped, historical, reading)), "
             "furthest AS (INSERT INTO journal (node, journal, contiguous, dropped) "
             "SELECT node, journal, max(number), max(dropped) FROM come GROUP BY node, journal "
             "ON CONFLICT (node, journal) DO UPDATE SET contiguous = excluded.contiguous, "
             "dropped = greatest(journal.dropped, excluded.dropped)) "
             "INSERT INTO row (node, journal, number, at, historical, reading) "
             "SELECT node, journal, number, to_timestamp(ms / 1000), historical, reading FROM come",
             {nodes.text(), journals.text(), numbers.text(), times.text(), dropped.text(),
              historical.text(), readings.text()}) &&
         store_newest(batch) && take_each(batch, Item::kSignatureHash, kWorn) &&
         take_each(batch, Item::kDocumentText, kDocument) &&
         take_each(batch, Item::kResidualX, kDrift, kMeasured);
}

// The last value of every quantity of each arm.
bool Database::store_newest(const Batch& batch) {
  std::map<std::string_view, Readings> newest;
  for (const StoredRow& row : batch.rows) {
    Readings& known = newest[row.node];
    const bool names = names_signature(row.readings);
    if (names) forget_signature(known);
    for (const Reading& reading : row.readings) {
      if (is_of_document(reading.item)) continue;
      if (is_of_signature(reading.item) && !names) continue;
      auto* const before =
          std::ranges::find(known.begin(), known.end(), reading.item, &Reading::item);
      if (before != known.end()) {
        *before = reading;
      } else if (!known.full()) {
        known.push_back(reading);
      }
    }
  }
  ArrayText nodes;
  ArrayText current;
  for (const auto& [node, readings] : newest) {
    nodes.add(node);
    current.add(json_of(readings));
  }
  return run(
      "UPDATE arm SET current = (CASE WHEN come.current ? 'signature' THEN arm.current - "
      "$3::text[] ELSE arm.current END) || come.current FROM unnest($1::text[], $2::jsonb[]) "
      "AS come(node, current) WHERE arm.node = come.node",
      {nodes.text(), current.text(), signature_keys()});
}

// Hands rows that tell `item` to a function of the record.
bool Database::take_each(const Batch& batch, Item item, std::string_view function,
                         std::string_view where) {
  ArrayText nodes;
  ArrayText times;
  ArrayText readings;
  bool any = false;
  for (const StoredRow& row : batch.rows) {
    if (std::ranges::find(row.readings, item, &Reading::item) == row.readings.end()) continue;
    any = true;
    nodes.add(row.node);
    times.add(std::to_string(row.time_ms));
    readings.add(json_of(row.readings));
  }
  const std::string question = std::string(function).append(kEach).append(where);
  return !any || run(question.c_str(), {nodes.text(), times.text(), readings.text()});
}

}  // namespace armsig::fleet
