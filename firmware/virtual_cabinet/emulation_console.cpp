// SPDX-License-Identifier: MIT
#include "firmware/virtual_cabinet/emulation_console.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error_name.hpp"
#include "core/base/pose.hpp"
#include "firmware/controller/verbs.hpp"
#include "hal/simulated/drive_fault.hpp"

namespace armsig::cabinet {
namespace {

using controller::Line;
using controller::Request;

constexpr std::string_view kVerb = "emulate";
constexpr std::string_view kExample =
    " joint=2 fault=blocked, joint=2 push_deg=3, sensor=silent, air_c=30, can=down, place=A1";
constexpr std::string_view kHelpReply = "ok verbs=";

struct SensorFault {
  std::string_view name;
  std::optional<Error> error;
};
constexpr std::array kSensorFaults{
    SensorFault{"none", std::nullopt},
    SensorFault{"silent", Error::kSensorSilent},
    SensorFault{"stale", Error::kSensorStale},
    SensorFault{"crc", Error::kSensorBadCrc},
    SensorFault{"unit", Error::kSensorWrongUnit},
    SensorFault{"exception", Error::kSensorException},
    SensorFault{"short", Error::kSensorMalformed},
    SensorFault{"unplugged", Error::kSensorPortGone},
};

std::unexpected<Error> refused(Line& out, std::string_view key, std::string_view words) {
  out.text(" why=\"").text(key).text(words).text("\"");
  return std::unexpected(Error::kUnknownRequest);
}

constexpr std::array kKeys{
    std::string_view("joint"),     std::string_view("fault"),    std::string_view("code"),
    std::string_view("push_deg"),  std::string_view("push_mm"),  std::string_view("sensor"),
    std::string_view("air_c"),     std::string_view("sigma_mm"), std::string_view("dropout"),
    std::string_view("multipath"), std::string_view("can"),      std::string_view("can2"),
    std::string_view("place"),     std::string_view("slip_mm")};
constexpr std::array<std::string_view, canopen::kMostBuses> kBusKeys{"can", "can2"};

class Values {
 public:
  explicit Values(const Request& request) : request_(request) {}

  [[nodiscard]] std::optional<std::string_view> text(std::string_view key) const {
    for (const auto& [name, value] : request_.arguments) {
      if (name == key) return value;
    }
    return std::nullopt;
  }
  [[nodiscard]] Result<std::optional<double>> number(std::string_view key, double lowest,
                                                     double highest, Line& out) const {
    const auto value = text(key);
    if (!value) return std::nullopt;
    const auto number = controller::needed_number(key, *value, out);
    if (!number) return std::unexpected(number.error());
    if (*number < lowest || *number > highest) return std::unexpected(Error::kOutOfRange);
    return *number;
  }
  // Empty: all are known.
  [[nodiscard]] std::string_view unknown() const {
    for (const auto& argument : request_.arguments) {
      if (std::ranges::find(kKeys, argument.first) == kKeys.end()) return argument.first;
    }
    return {};
  }

 private:
  const Request& request_;
};

// What an `emulate` asks for, all of it known to be possible.
struct Changes {
  std::optional<std::size_t> joint;  // from 0
  std::optional<simulated::DriveFault> fault;
  std::int32_t code = 0;
  std::optional<double> push;  // radians or metres
  std::optional<SensorFault> sensor;
  simulated::UltrasonicConfig field;
  std::array<std::string_view, canopen::kMostBuses> buses;  // empty: as it is
};

Result<void> read_push(const VirtualCabinet& cabinet, const Values& values, Line& out,
                       Changes& changes) {
  constexpr double kFarthestDegrees = 90;
  constexpr double kFarthestMillimetres = 1000;
  const bool turns = cabinet.joint_type(*changes.joint) == JointType::kRevolute;
  const std::string_view other = turns ? "push_mm" : "push_deg";
  if (values.text(other)) return refused(out, other, " is of the other type of joint");
  const double farthest = turns ? kFarthestDegrees : kFarthestMillimetres;
  const auto by = values.number(turns ? "push_deg" : "push_mm", -farthest, farthest, out);
  if (!by) return std::unexpected(by.error());
  if (*by) changes.push = turns ? radians(**by) : **by / 1e3;
  return {};
}

Result<void> read_joint(const VirtualCabinet& cabinet, const Values& values, Line& out,
                        Changes& changes) {
  constexpr double kLargestCode = 1e9;
  const auto joint = values.number("joint", 1, static_cast<double>(cabinet.joint_count()), out);
  if (!joint) return std::unexpected(joint.error());
  if (!*joint) {
    for (const std::string_view key : {"fault", "code", "push_deg", "push_mm"}) {
      if (values.text(key)) return refused(out, key, " needs joint=2");
    }
    return {};
  }
  if (**joint != std::floor(**joint)) return std::unexpected(Error::kOutOfRange);
  changes.joint = static_cast<std::size_t>(**joint) - 1;
  if (auto read = read_push(cabinet, values, out, changes); !read) return read;
  if (const auto name = values.text("fault")) {
    changes.fault = simulated::drive_fault(*name);
    if (!changes.fault) return refused(out, *name, " is no fault of a drive");
  }
  const auto code = values.number("code", -kLargestCode, kLargestCode, out);
  if (!code) return std::unexpected(code.error());
  if (*code && !changes.fault) return refused(out, "code", " needs fault=emergency");
  if (!changes.fault && !changes.push) return refused(out, "joint", " needs fault= or push_deg=");
  changes.code = static_cast<std::int32_t>(code->value_or(0));
  return {};
}

Result<void> read_sensor(const Values& values, Line& out, Changes& changes) {
  if (const auto name = values.text("sensor")) {
    const auto found = std::ranges::find(kSensorFaults, *name, &SensorFault::name);
    if (found == kSensorFaults.end()) return refused(out, *name, " is no fault of the sensor");
    changes.sensor = *found;
  }
  struct Setting {
    std::string_view key;
    double lowest;
    double highest;
    double scale;
    double simulated::UltrasonicConfig::* value;
  };
  using Field = simulated::UltrasonicConfig;
  for (const Setting& setting : {Setting{"air_c", -100, 100, 1, &Field::air_celsius},
                                 Setting{"sigma_mm", 0, 100, 1e-3, &Field::range_sigma_m},
                                 Setting{"dropout", 0, 1, 1, &Field::dropout_probability},
                                 Setting{"multipath", 0, 1, 1, &Field::multipath_probability}}) {
    const auto number = values.number(setting.key, setting.lowest, setting.highest, out);
    if (!number) return std::unexpected(number.error());
    if (*number) changes.field.*setting.value = **number * setting.scale;
  }
  return {};
}

Result<void> read_buses(const VirtualCabinet& cabinet, const Values& values, Line& out,
                        Changes& changes) {
  for (std::size_t bus = 0; bus < kBusKeys.size(); ++bus) {
    const auto state = values.text(kBusKeys[bus]);
    if (!state) continue;
    if (bus >= cabinet.bus_count()) return refused(out, kBusKeys[bus], " is not configured");
    if (*state != "up" && *state != "down" && *state != "off") {
      return refused(out, *state, " is neither up, down nor off");
    }
    changes.buses[bus] = *state;
  }
  return {};
}

// Into a socket, by hand.
Result<void> lead(VirtualCabinet& cabinet, const Request& request, const Values& values,
                  std::string_view place, Line& out) {
  constexpr double kLargestSlip_mm = 100;
  const auto slip_mm = values.number("slip_mm", 0, kLargestSlip_mm, out);
  if (!slip_mm) return std::unexpected(slip_mm.error());
  if (request.arguments.size() > (*slip_mm ? 2U : 1U)) {
    return refused(out, "place", " goes with slip_mm alone");
  }
  const EmulatedSocket* const socket = cabinet.hand().find(place);
  if (socket == nullptr) return refused(out, place, " is no socket of the emulated world");
  const controller::Mode mode = cabinet.state().snapshot().mode;
  if (mode != controller::Mode::kIdle || cabinet.hand().is_leading()) {
    out.text(" mode=").text(name(mode));
    if (mode == controller::Mode::kIdle) out.text(" why=\"the arm is being led\"");
    return std::unexpected(Error::kWrongMode);
  }
  return cabinet.hand().begin(*socket, 1e-3 * slip_mm->value_or(0), cabinet.clock().now());
}

void change_bus(simulated::VirtualCanPort& port, std::string_view state) {
  if (state == "off") port.go_bus_off();
  if (state == "up" || state == "down") port.set_up(state == "up");
}

void make(const Changes& changes, VirtualCabinet& cabinet) {
  if (changes.push) {
    const cia402::Scaling& scaling = cabinet.scaling(*changes.joint);
    const double counts_per_unit = 1 / (scaling.reading(1) - scaling.reading(0));
    cabinet.drive(*changes.joint).push(*changes.push * counts_per_unit);
  }
  if (changes.fault) cabinet.inject(*changes.joint, *changes.fault, changes.code);
  if (changes.sensor) cabinet.sensor().set_error(changes.sensor->error);
  cabinet.sensor().field() = changes.field;
  for (std::size_t bus = 0; bus < changes.buses.size(); ++bus) {
    change_bus(cabinet.master_port(bus), changes.buses[bus]);
  }
}

}  // namespace

Result<void> emulate(VirtualCabinet& cabinet, const Request& request, Line& out) {
  const Values values(request);
  if (!request.subject.empty() || request.arguments.empty()) {
    return refused(out, kVerb, kExample);
  }
  if (const auto key = values.unknown(); !key.empty()) {
    return refused(out, key, " is no key of emulate");
  }
  if (const auto place = values.text("place")) {
    return lead(cabinet, request, values, *place, out);
  }
  if (values.text("slip_mm")) return refused(out, "slip_mm", " needs place=A1");
  Changes changes;
  changes.field = cabinet.sensor().field();
  if (auto read = read_joint(cabinet, values, out, changes); !read) return read;
  if (auto read = read_sensor(values, out, changes); !read) return read;
  if (auto read = read_buses(cabinet, values, out, changes); !read) return read;
  make(changes, cabinet);
  return {};
}

std::optional<hal::ConsoleLine> EmulationConsole::do_read_line() {
  watch_hand();
  auto line = inner_->read_line();
  if (!line || line->error) return line;
  const auto request = controller::parse_request(line->text());
  if (!request) return line;
  if (request->verb == "help" && request->subject == kVerb) {
    help(line->client);
  } else if (request->verb == kVerb) {
    answer(line->client, *request);
  } else {
    return line;
  }
  return std::nullopt;
}

// The controller's own list, and this verb.
Result<void> EmulationConsole::do_write_line(hal::ConsoleClient client, std::string_view text) {
  if (cabinet_ == nullptr || !text.starts_with(kHelpReply)) return inner_->write_line(client, text);
  return inner_->write_line(client, Line().text(text).text(",").text(kVerb).view());
}

void EmulationConsole::help(hal::ConsoleClient client) {
  Line reply;
  reply.text("ok verb=").text(kVerb);
  controller::tell_modes(controller::kInAnyMode, reply);
  (void)inner_->write_line(client, reply.text(" alone=no does=\"a fault of the emulated world:")
                                       .text(kExample)
                                       .text("; fault=none ends it\"")
                                       .view());
}

void EmulationConsole::answer(hal::ConsoleClient client, const Request& request) {
  Line details;
  Result<void> done = std::unexpected(Error::kUnsupported);
  if (cabinet_ != nullptr) done = emulate(*cabinet_, request, details);
  const bool leads = Values(request).text("place").has_value();
  if (done && leads) {
    led_for_ = client;
  } else {
    reply(client, done, details);
  }
}

void EmulationConsole::reply(hal::ConsoleClient client, const Result<void>& done,
                             const Line& details) {
  Line line;
  if (done) {
    line.text("ok");
  } else {
    line.text("error ").text(name(done.error())).text(" ").text(describe(done.error()));
    line.text(details.view());
  }
  (void)inner_->write_line(client, line.view());
}

// Whoever had the arm led is answered when the ball sits, or the arm has got torque meanwhile.
void EmulationConsole::watch_hand() {
  if (!led_for_) return;
  const controller::Mode mode = cabinet_->state().snapshot().mode;
  const bool has_torque = mode != controller::Mode::kIdle;
  if (cabinet_->hand().is_leading() && !has_torque) return;
  cabinet_->hand().let_go();
  Line details;
  if (has_torque) details.text(" mode=").text(name(mode));
  reply(*led_for_, has_torque ? std::unexpected(Error::kWrongMode) : Result<void>(), details);
  led_for_.reset();
}

}  // namespace armsig::cabinet
