// SPDX-License-Identifier: MIT
// armsig-fleet: keeps what the cabinets of one plant report, and shows it. One thread.
#include <chrono>
#include <cstdio>
#include <string>

#include "core/base/error_name.hpp"
#include "core/drift/cusum.hpp"
#include "firmware/analysis/evaluation/threshold.hpp"
#include "firmware/fleet/host/configuration.hpp"
#include "firmware/fleet/host/database.hpp"
#include "firmware/fleet/host/http_server.hpp"
#include "firmware/fleet/host/session.hpp"
#include "firmware/fleet/program.hpp"
#include "firmware/formats/wrapping.hpp"

namespace armsig::fleet {
namespace {

constexpr std::uint64_t kRetry_ms = 1'000;
constexpr std::uint64_t kCommitEvery_ms = 50;
constexpr std::size_t kRowsAtOnce = 1'000;
constexpr int kWait_ms = 20;
constexpr const char* kThere = "the record is there";

template <typename Clock>
std::uint64_t ms_of() {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch())
          .count());
}

Result<DriftSettings> settings_of(const DriftPlan& plan) {
  DriftSettings settings{.sigma_mm = drift::check_sigma(plan.pose_sigma_mm, plan.poses),
                         .baseline = plan.baseline};
  settings.reference = drift::reference_value(plan.shift_mm, settings.sigma_mm);
  ARMSIG_TRY(threshold,
             drift::threshold(settings.reference,
                              {.baseline = plan.baseline,
                               .correlation = plan.correlation,
                               .sigma_ratio = plan.sigma_ratio},
                              {.checks_per_month = plan.checks_per_month,
                               .per_month = 1e-3 * plan.false_alarms_per_1000_arm_months}));
  settings.threshold = threshold;
  return settings;
}

class Host {
 public:
  Host(const HostConfiguration& configuration, const DriftSettings& drift, HttpServer server)
      : configuration_(configuration),
        drift_(drift),
        session_(configuration.broker, configuration.group, configuration.host),
        server_(std::move(server)) {}

  void run() {
    while (stop_asked == 0) step();
    commit(ms_of<std::chrono::steady_clock>());
    session_.end();
  }

 private:
  void step() {
    MqttConnection& connection = session_.connection();
    std::vector<pollfd> ready{{.fd = connection.descriptor(), .events = POLLIN, .revents = 0}};
    if (connection.wants_write()) ready[0].events |= POLLOUT;
    server_.add_to(ready);
    (void)::poll(ready.data(), ready.size(), kWait_ms);
    const std::uint64_t steady = ms_of<std::chrono::steady_clock>();
    connection.service((ready[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0,
                       (ready[0].revents & POLLOUT) != 0);
    if (!database_ && steady >= database_due_ms_) open_database(steady);
    session_.step(steady, ms_of<std::chrono::system_clock>(), intake_);
    const Batch& waiting = intake_.waiting();
    if (waiting.rows.size() >= kRowsAtOnce ||
        (!waiting.empty() && steady - committed_ms_ >= kCommitEvery_ms)) {
      commit(steady);
    }
    server_.service(ready.data() + 1, steady, [&](std::string_view path) {
      return answer(path, intake_, database_ ? &*database_ : nullptr);
    });
  }

  void open_database(std::uint64_t steady) {
    database_due_ms_ = steady + kRetry_ms;
    std::string problem;
    database_ = Database::open(configuration_.database, drift_, problem);
    const auto journals = database_ ? database_->journals() : std::nullopt;
    if (journals) {
      intake_.begin(*journals);
      if (!in_doubt_) tell(kThere);
    } else {
      if (database_) problem = database_->problem();
      database_.reset();
      tell("no record: " + problem);
    }
  }

  // What can't be committed is forgotten: nobody was told that it is kept.
  void commit(std::uint64_t steady) {
    committed_ms_ = steady;
    if (!database_) return;
    const Batch batch = intake_.take_batch();
    if (batch.empty()) return;
    if (database_->store(batch)) {
      intake_.stored(batch);
      in_doubt_ = false;
      tell(database_->set_aside().empty() ? kThere : database_->set_aside());
      return;
    }
    in_doubt_ = true;
    tell("the record took nothing: " + database_->problem());
    database_.reset();
    intake_.end();
    database_due_ms_ = steady + kRetry_ms;
  }

  // Once, however often it is so.
  void tell(const std::string& text) {
    if (text == told_) return;
    told_ = text;
    std::fprintf(stderr, "armsig-fleet: %s\n", text.c_str());
  }

  const HostConfiguration& configuration_;
  DriftSettings drift_;
  HostSession session_;
  HttpServer server_;
  Intake intake_;
  std::optional<Database> database_;
  std::uint64_t database_due_ms_ = 0;
  std::uint64_t committed_ms_ = 0;
  bool in_doubt_ = false;  // it answers, and has not taken what it refused: its disk may be full
  std::string told_;
};

int run(const char* path, bool check_only) {
  const auto configuration = read_host_configuration(path);
  if (!configuration) {
    std::fputs(
        tool::for_standard_error("armsig-fleet: " + tool::render(configuration.error())).c_str(),
        stderr);
    return kWrongUsage;
  }
  const auto drift = settings_of(configuration->drift);
  if (!drift) {
    std::fprintf(stderr, "armsig-fleet: %s: drift: no threshold for these settings: %s\n", path,
                 std::string(describe(drift.error())).c_str());
    return kWrongUsage;
  }
  if (check_only) {
    std::printf("drift: sigma %.4f mm, reference value %.2f, threshold %.2f\n", drift->sigma_mm,
                drift->reference, drift->threshold);
    return 0;
  }
  auto server = HttpServer::open(configuration->page_port, configuration->page_names);
  if (!server) {
    std::fprintf(stderr, "armsig-fleet: port %d is taken\n", configuration->page_port);
    return 1;
  }
  Host(*configuration, *drift, *std::move(server)).run();
  return 0;
}

}  // namespace
}  // namespace armsig::fleet

int main(int argc, char** argv) {
  return armsig::fleet::run_program("armsig-fleet", ARMSIG_VERSION, argc, argv, armsig::fleet::run);
}
