// SPDX-License-Identifier: MIT
// The record in PostgreSQL: its schema, batches of rows in one transaction, and the questions of
// the page.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/fleet/host/intake.hpp"

struct pg_conn;
struct pg_result;

namespace armsig::fleet {

struct DriftSettings {
  double sigma_mm = 0;
  double reference = 0;
  double threshold = 0;
  int baseline = 0;
};

class Database {
 public:
  // Text of every column of every row; absent where it is null.
  using Table = std::vector<std::vector<std::optional<std::string>>>;

  // Connects, waiting for at most `connect_timeout` of the description or 5 s, brings the schema up
  // to date and keeps `drift`. None: what is wrong stands in `problem`.
  [[nodiscard]] static std::optional<Database> open(const std::string& connection,
                                                    const DriftSettings& drift,
                                                    std::string& problem);

  // All journals; none where the connection has failed. The same of the others.
  [[nodiscard]] std::optional<std::vector<Intake::Journal>> journals();
  // In one transaction, with how far each journal has come. True: it is committed. A row that the
  // record cannot take is set aside in its table row_refused, and the others are stored.
  [[nodiscard]] bool store(const Batch& batch);
  // The first row that the last store() set aside, in words; empty: none.
  [[nodiscard]] const std::string& set_aside() const { return set_aside_; }
  [[nodiscard]] std::optional<Table> ask(const char* question,
                                         const std::vector<std::string>& arguments = {});
  [[nodiscard]] std::string problem() const;

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  struct Clear {
    void operator()(pg_result* result) const;
  };
  using Result = std::unique_ptr<pg_result, Clear>;

  explicit Database(pg_conn* connection) : connection_(connection) {}
  [[nodiscard]] bool run(const char* command);
  [[nodiscard]] bool run(const char* command, const std::vector<std::string>& arguments);
  [[nodiscard]] bool migrate();
  [[nodiscard]] bool keep(const DriftSettings& drift);
  enum class Attempt : std::uint8_t {
    kStored,
    kRefused,  // for what was to be stored; nothing of it is there
    kFailed    // for the record itself, or for a key that is there already
  };
  template <typename Store>
  [[nodiscard]] Attempt attempt(const Store& store);
  void note_failure(const pg_result* result);
  [[nodiscard]] bool store_whole(const Batch& batch);
  [[nodiscard]] bool store_by_arm(const Batch& batch);
  [[nodiscard]] bool store_by_row(const Batch& arm);
  [[nodiscard]] bool set_aside(const StoredRow& row);
  [[nodiscard]] bool store_states(const Batch& batch);
  [[nodiscard]] bool store_rows(const Batch& batch);
  [[nodiscard]] bool store_newest(const Batch& batch);
  [[nodiscard]] bool take_each(const Batch& batch, Item item, std::string_view function,
                               std::string_view where = {});

  std::unique_ptr<pg_conn, Close> connection_;
  std::string failed_;        // why the last question was not answered
  std::string failed_state_;  // its SQLSTATE; empty: there was no answer
  std::string set_aside_;
};

}  // namespace armsig::fleet
