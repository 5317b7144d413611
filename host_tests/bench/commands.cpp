// SPDX-License-Identifier: MIT
#include "host_tests/bench/commands.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "hal/simulated/drive_fault.hpp"
#include "host_tests/bench/request.hpp"

namespace armsig::bench {
namespace {

template <typename T, std::size_t kCount>
const T* named(const std::array<std::pair<std::string_view, T>, kCount>& names,
               std::string_view name) {
  for (const auto& [word, value] : names) {
    if (word == name) return &value;
  }
  return nullptr;
}

constexpr std::array kSensorFaults{
    std::pair{std::string_view("none"), SensorFault::kNone},
    std::pair{std::string_view("stale"), SensorFault::kStale},
    std::pair{std::string_view("silent"), SensorFault::kSilent},
};
constexpr std::array kLineFaults{
    std::pair{std::string_view("crc"), LineFault::kBadCrc},
    std::pair{std::string_view("unit"), LineFault::kWrongUnit},
    std::pair{std::string_view("exception"), LineFault::kException},
    std::pair{std::string_view("short"), LineFault::kShort},
    std::pair{std::string_view("unplugged"), LineFault::kUnplugged},
};

std::string refused(std::string_view what) { return fmt::format("error REQUEST {}", what); }

std::string status(Plant& plant, Request& request) {
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  const Vector3 target_S = plant.target_S();
  const JointVector readings = plant.readings();
  std::string text = fmt::format("ok target_S={:.9f},{:.9f},{:.9f} joints=", target_S.x(),
                                 target_S.y(), target_S.z());
  for (std::size_t i = 0; i < readings.size(); ++i) {
    text += fmt::format("{}{:.9f}", i == 0 ? "" : ",", readings[i]);
  }
  text += " states=";
  for (std::size_t i = 0; i < plant.joints(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ",", static_cast<int>(plant.drive(i).state()));
  }
  const hal::CanStatus bus = plant.bus_status();
  return text + fmt::format(" peak_counts_per_s={:.0f} can_received={} can_lost={}",
                            plant.take_peak_speed(), bus.received, bus.lost);
}

std::string hand(Plant& plant, Request& request) {
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  const Pose X_SH = plant.hand_S();
  const Eigen::Quaterniond q(X_SH.R);
  return fmt::format("ok p_S={:.9f},{:.9f},{:.9f} qw={:.9f} qx={:.9f} qy={:.9f} qz={:.9f}",
                     X_SH.p.x(), X_SH.p.y(), X_SH.p.z(), q.w(), q.x(), q.y(), q.z());
}

std::string drive_fault(Plant& plant, Request& request) {
  const std::string kind = request.text("kind");
  const bool with_code = kind == "emergency" || kind == "jump" || kind == "bits-clear" ||
                         kind == "bits-set" || kind == "information";
  const int code = with_code ? request.integer("code", -1'000'000'000, 1'000'000'000) : 0;
  const int joint = request.integer("joint", 1, static_cast<int>(plant.joints()));
  const auto fault = simulated::drive_fault(kind);
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  if (!fault) return refused("no such fault of a drive: " + kind);
  plant.inject(static_cast<std::size_t>(joint - 1), *fault, code);
  return "ok";
}

std::string sensor_fault(Plant& plant, Request& request) {
  const std::string kind = request.text("kind");
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  if (const SensorFault* fault = named(kSensorFaults, kind)) {
    plant.set_sensor_fault(*fault);
    return "ok";
  }
  const LineFault* fault = named(kLineFaults, kind);
  if (fault == nullptr) return refused("no such fault of the sensor: " + kind);
  if (plant.line() == nullptr) return refused("the sensor is on no serial line");
  plant.set_sensor_fault(SensorFault::kNone);
  plant.line()->set_fault(*fault);
  return "ok";
}

std::string field(Plant& plant, Request& request) {
  simulated::UltrasonicConfig changed = plant.field();
  const auto set = [&](std::string_view key, double& value, double scale = 1) {
    if (const auto number = request.find_number(key)) value = *number * scale;
  };
  set("air_c", changed.air_celsius);
  set("thermometer_error_k", changed.thermometer_error_kelvin);
  set("sigma_mm", changed.range_sigma_m, 1e-3);
  set("dropout", changed.dropout_probability);
  set("multipath", changed.multipath_probability);
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  const auto share = [](double value) { return value >= 0 && value <= 1; };
  if (!share(changed.dropout_probability) || !share(changed.multipath_probability) ||
      changed.range_sigma_m < 0 || changed.air_celsius < -100 || changed.air_celsius > 200) {
    return refused("a value is out of its range");
  }
  plant.field() = changed;
  return "ok";
}

std::string lose_sync(Plant& plant, Request& request) {
  const int frames = request.integer("frames", 0, 1'000'000);
  if (const std::string wrong = request.wrong(); !wrong.empty()) return refused(wrong);
  plant.lose_sync(static_cast<unsigned>(frames));
  return "ok";
}

constexpr std::string_view kHelp =
    "ok status | hand | drive joint=N kind=none|emergency|silent|heartbeat|feedback|blocked|power|"
    "reboot|deaf|jump|pre-operational|sdo|sync|ignores|bits-clear|bits-set|information [code=N] | "
    "sensor kind=none|stale|silent|crc|unit|"
    "exception|short|unplugged | field [air_c=] [thermometer_error_k=] [sigma_mm=] [dropout=] "
    "[multipath=] | lose-sync frames=N";

}  // namespace

std::string answer(Plant& plant, std::string_view line) {
  Request request(line);
  if (request.verb() == "status") return status(plant, request);
  if (request.verb() == "hand") return hand(plant, request);
  if (request.verb() == "drive") return drive_fault(plant, request);
  if (request.verb() == "sensor") return sensor_fault(plant, request);
  if (request.verb() == "field") return field(plant, request);
  if (request.verb() == "lose-sync") return lose_sync(plant, request);
  if (request.verb() == "help") return std::string(kHelp);
  return refused("no such request: " + request.verb());
}

}  // namespace armsig::bench
