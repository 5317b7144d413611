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
    " joint=2 fault=blocked, joint=2 push_deg=3, sensor=silent, air_c=30, can=down";
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
    std::string_view("multipath"), std::string_view("can")};

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

Result<void> push(VirtualCabinet& cabinet, std::size_t joint, const Values& values, Line& out) {
  constexpr double kFarthest_deg = 90;
  constexpr double kFarthest_mm = 1000;
  const auto by_deg = values.number("push_deg", -kFarthest_deg, kFarthest_deg, out);
  if (!by_deg) return std::unexpected(by_deg.error());
  const auto by_mm = values.number("push_mm", -kFarthest_mm, kFarthest_mm, out);
  if (!by_mm) return std::unexpected(by_mm.error());
  const cia402::Scaling& scaling = cabinet.scaling(joint);
  const double counts_per_unit = 1 / (scaling.reading(1) - scaling.reading(0));
  const double by = by_deg->has_value() ? radians(**by_deg) : by_mm->value_or(0) / 1e3;
  if (by != 0) cabinet.drive(joint).push(by * counts_per_unit);
  return {};
}

Result<void> change_joint(VirtualCabinet& cabinet, const Values& values, Line& out) {
  constexpr double kLargestCode = 1e9;
  const auto joint = values.number("joint", 1, static_cast<double>(cabinet.joint_count()), out);
  if (!joint) return std::unexpected(joint.error());
  const auto fault = values.text("fault");
  const auto code = values.number("code", -kLargestCode, kLargestCode, out);
  if (!code) return std::unexpected(code.error());
  if (!*joint) return fault ? refused(out, "fault", " needs joint=2") : Result<void>{};
  const double number = **joint;
  if (number != std::floor(number)) return std::unexpected(Error::kOutOfRange);
  const auto index = static_cast<std::size_t>(number) - 1;
  if (auto pushed = push(cabinet, index, values, out); !pushed) return pushed;
  if (!fault) return {};
  const auto kind = simulated::drive_fault(*fault);
  if (!kind) return refused(out, *fault, " is no fault of a drive");
  cabinet.drive(index).inject(*kind, static_cast<std::int32_t>(code->value_or(0)));
  return {};
}

Result<void> change_sensor(VirtualCabinet& cabinet, const Values& values, Line& out) {
  if (const auto name = values.text("sensor")) {
    const SensorFault* found = nullptr;
    for (const SensorFault& fault : kSensorFaults) {
      if (fault.name == *name) found = &fault;
    }
    if (found == nullptr) return refused(out, *name, " is no fault of the sensor");
    cabinet.sensor().set_error(found->error);
  }
  struct Setting {
    std::string_view key;
    double highest;
    double scale;
    double simulated::UltrasonicConfig::* value;
  };
  constexpr double kHottestCelsius = 100;
  for (const Setting& setting :
       {Setting{"air_c", kHottestCelsius, 1, &simulated::UltrasonicConfig::air_celsius},
        Setting{"sigma_mm", 100, 1e-3, &simulated::UltrasonicConfig::range_sigma_m},
        Setting{"dropout", 1, 1, &simulated::UltrasonicConfig::dropout_probability},
        Setting{"multipath", 1, 1, &simulated::UltrasonicConfig::multipath_probability}}) {
    const double lowest = setting.key == "air_c" ? -kHottestCelsius : 0;
    const auto number = values.number(setting.key, lowest, setting.highest, out);
    if (!number) return std::unexpected(number.error());
    if (*number) cabinet.sensor().field().*setting.value = **number * setting.scale;
  }
  return {};
}

Result<void> change_bus(VirtualCabinet& cabinet, const Values& values, Line& out) {
  const auto state = values.text("can");
  if (!state) return {};
  if (*state == "off") {
    cabinet.master_port().go_bus_off();
  } else if (*state == "up" || *state == "down") {
    cabinet.master_port().set_up(*state == "up");
  } else {
    return refused(out, *state, " is neither up, down nor off");
  }
  return {};
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
  for (const auto change : {change_joint, change_sensor, change_bus}) {
    if (auto done = change(cabinet, values, out); !done) return done;
  }
  return {};
}

std::optional<hal::ConsoleLine> EmulationConsole::do_read_line() {
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
  Line reply;
  if (done) {
    reply.text("ok");
  } else {
    reply.text("error ").text(name(done.error())).text(" ").text(describe(done.error()));
    reply.text(details.view());
  }
  (void)inner_->write_line(client, reply.view());
}

}  // namespace armsig::cabinet
