// SPDX-License-Identifier: MIT
#include "firmware/linux/daemon.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <fmt/format.h>

#include "firmware/controller/controller.hpp"
#include "firmware/controller/length_points.hpp"
#include "firmware/linux/attendance.hpp"
#include "firmware/linux/can_sensor.hpp"
#include "firmware/linux/check_file.hpp"
#include "firmware/linux/places.hpp"
#include "firmware/linux/real_time_loop.hpp"
#include "firmware/linux/self_calibrating.hpp"
#include "firmware/linux/shut_down.hpp"
#include "hal/canopen/master.hpp"
#include "hal/linux/line_server.hpp"
#include "hal/linux/register_client.hpp"
#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

// What measures, however it is connected; nothing of it where nothing does.
struct SensorBackend {
  std::unique_ptr<linux_hal::PointServer> points;
  std::unique_ptr<linux_hal::ModbusPoints> point_registers;
  std::unique_ptr<linux_hal::LengthServer> lengths;
  std::unique_ptr<linux_hal::ModbusLengths> length_registers;
  std::unique_ptr<controller::LengthPoints> of_lengths;
  std::unique_ptr<linux_hal::RtuRangeSensor> serial;
  std::unique_ptr<CanSensor> can;

  [[nodiscard]] controller::Instrument instrument() const {
    if (serial) return *serial;
    if (can) return *can;
    if (points) return *points;
    if (point_registers) return *point_registers;
    if (of_lengths) return *of_lengths;
    return {};
  }
};

// One of points, or one of lengths where the configuration has anchors.
template <typename Points, typename Lengths>
void start_instrument(const auto& link, const DaemonConfiguration& c,
                      std::unique_ptr<Points>& points, std::unique_ptr<Lengths>& lengths,
                      std::unique_ptr<controller::LengthPoints>& of_lengths) {
  if (c.length_offsets_m.empty()) {
    points = std::make_unique<Points>(link);
    return;
  }
  lengths = std::make_unique<Lengths>(link);
  of_lengths = std::make_unique<controller::LengthPoints>(c.controller.sensor.receivers,
                                                          c.length_offsets_m, *lengths);
}

Result<SensorBackend> start_sensor(const DaemonConfiguration& configuration) {
  SensorBackend backend;
  if (const auto* node = std::get_if<canopen::RangeNodeConfiguration>(&configuration.sensor)) {
    backend.can = std::make_unique<CanSensor>(*node);
    return backend;
  }
  if (std::holds_alternative<std::monostate>(configuration.sensor)) return backend;
  if (const auto* told = std::get_if<linux_hal::LineServerConfiguration>(&configuration.sensor)) {
    start_instrument(*told, configuration, backend.points, backend.lengths, backend.of_lengths);
    return backend;
  }
  if (const auto* asked =
          std::get_if<linux_hal::RegisterClientConfiguration>(&configuration.sensor)) {
    start_instrument(*asked, configuration, backend.point_registers, backend.length_registers,
                     backend.of_lengths);
    return backend;
  }
  auto started = linux_hal::RtuRangeSensor::start(
      std::get<linux_hal::RtuRangeSensorConfiguration>(configuration.sensor));
  if (!started) return std::unexpected(started.error());
  backend.serial = std::move(*started);
  return backend;
}

// Every tick puts a burst into the queue of the interface: SYNC, a frame a drive, a heartbeat, an
// SDO; and where a tick is late, the next one follows before it is empty. By default Linux gives a
// CAN interface ten places.
void warn_about_queue(const DaemonConfiguration& configuration, std::uint8_t bus,
                      Journal& journal) {
  const std::string& interface = configuration.can_interfaces[bus];
  const auto places = linux_hal::send_queue_frames(interface);
  const auto drives = static_cast<std::size_t>(
      std::ranges::count(configuration.drives.axes, bus, &canopen::AxisConfiguration::bus));
  const std::size_t needed = 2 * (drives + 3);
  if (!places || *places == 0 || *places >= needed) return;
  journal.tell(
      Priority::kWarning,
      fmt::format("warning: {} queues {} frames where {} may come at once: commands may be "
                  "lost (ip link set {} txqueuelen 64)",
                  interface, *places, needed, interface));
}

// The interfaces, opened as soon as they are there.
class SocketBuses {
 public:
  // `configuration` must outlive it.
  SocketBuses(const DaemonConfiguration& configuration, Journal& journal) {
    const auto& interfaces = configuration.can_interfaces;
    for (std::uint8_t bus = 0; bus < configuration.drives.buses.count; ++bus) {
      warn_about_queue(configuration, bus, journal);
      sockets_[bus].emplace(linux_hal::SocketCanConfiguration{
          .interface_name = interfaces[bus], .filters = {}, .maintained = true});
      all_.push_back(&*sockets_[bus]);
      named_.push_back({&*sockets_[bus], interfaces[bus]});
    }
  }
  SocketBuses(const SocketBuses&) = delete;
  SocketBuses& operator=(const SocketBuses&) = delete;

  [[nodiscard]] std::span<linux_hal::SocketCan* const> all() const {
    return {all_.data(), all_.size()};
  }
  [[nodiscard]] const canopen::NamedBuses& named() const { return named_; }

 private:
  std::array<std::optional<linux_hal::SocketCan>, canopen::kMostBuses> sockets_;
  FixedVector<linux_hal::SocketCan*, canopen::kMostBuses> all_;
  canopen::NamedBuses named_;
};

std::string first_words(const DaemonConfiguration& configuration) {
  return fmt::format("{}: {} joints on {}, console at {}", configuration.name,
                     configuration.drives.axes.size(), interfaces_in_words(configuration),
                     configuration.console);
}

}  // namespace

int run_cabinet(const DaemonConfiguration& configuration, const volatile std::sig_atomic_t& stop) {
  const auto drives = canopen::check(configuration.drives);
  if (!drives) return 1;  // refused when the file was read
  auto places = open_places(configuration);
  if (!places) return 1;
  auto backend = start_sensor(configuration);
  if (!backend) {
    fmt::print(stderr, "armsigd: sensor: {}\n", describe(backend.error()));
    return 1;
  }

  Attendance attendance(configuration, *places->console, places->reporting.get());
  linux_hal::SteadyClock clock;
  SocketBuses sockets(configuration, attendance.journal());
  canopen::Master master(*drives, sockets.named(), backend->can.get());
  const auto refinement = std::make_unique<SelfCalibrating>(configuration);
  CheckFile checks(configuration.store);
  const auto controller = std::make_unique<controller::Controller>(
      configuration.controller, master, backend->instrument(), clock, places->store,
      attendance.consoles(), &refinement->refinement(), &checks);
  attendance.begin(*controller);
  const RealTimeLoop loop{.controller = *controller,
                          .clock = clock,
                          .period = configuration.controller.period,
                          .priority = configuration.priority,
                          .watch = attendance.watch(),
                          .journal = attendance.journal(),
                          .buses = sockets.all(),
                          .master = &master};
  bool at_rest = false;
  const bool served = run_in_real_time(
      loop, [&] { attendance.started(first_words(configuration)); },
      [&] { at_rest = shut_down(master, clock, configuration.controller.period); }, stop);
  if (served) controller->finish();
  attendance.end(stop, at_rest);
  return served ? 0 : 1;
}

}  // namespace armsig::daemon
