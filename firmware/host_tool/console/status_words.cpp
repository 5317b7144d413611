// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/status_words.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/arm.hpp"
#include "core/base/error_name.hpp"
#include "core/base/tool_accuracy.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/console_line.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/presentation/entries.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// The words for `key`, one of `pairs`; `key` where it is none.
template <std::size_t kCount>
std::string translated(std::string_view key,
                       const std::array<std::array<std::string_view, 2>, kCount>& pairs) {
  for (const auto& [known, words] : pairs) {
    if (known == key) return std::string(words);
  }
  return shown(key);
}

std::string mode_in_words(std::string_view mode) {
  constexpr std::array<std::array<std::string_view, 2>, 7> kModes{{
      {"starting", "the drives are set up"},
      {"idle", "no torque"},
      {"holding", "torque on, the arm stands"},
      {"servoing", "torque on, the arm moves"},
      {"sweeping", "torque on, a sequence moves the arm"},
      {"homing", "torque on, a drive finds its reference"},
      {"faulted", "stopped by a fault; `reset` when its cause is gone"},
  }};
  return translated(mode, kModes);
}

std::string error_in_words(std::string_view name) {
  for (std::size_t number = 0; number < error_name_detail::kCount; ++number) {
    const auto error = static_cast<Error>(number);
    if (armsig::name(error) == name) return fmt::format("{} ({})", describe(error), name);
  }
  return std::string(name);
}

// A reply whose values are taken one after the other; what is left is not known here.
class Status {
 public:
  explicit Status(std::string_view reply) {
    ConsoleLine words(reply);
    while (const auto word = words.next()) {
      if (!word->key.empty()) values_.push_back(*word);
    }
  }

  // Empty: there is none.
  std::string take(std::string_view key) {
    const auto found = std::ranges::find(values_, key, &ConsoleLine::Value::key);
    if (found == values_.end()) return {};
    std::string value = shown(found->value);
    values_.erase(found);
    return value;
  }

  // The value between `before` and `after`; empty where there is none.
  std::string phrase(std::string_view key, std::string_view before, std::string_view after = "") {
    const std::string value = take(key);
    return value.empty() ? value : fmt::format("{}{}{}", before, value, after);
  }

  [[nodiscard]] const std::vector<ConsoleLine::Value>& left() const { return values_; }

 private:
  std::vector<ConsoleLine::Value> values_;
};

std::string fault_in_words(Status& status) {
  const std::string fault = status.take("fault");
  if (fault.empty()) return {};
  std::string words = error_in_words(fault);
  words += status.phrase("fault_joint", "; joint ");
  words += status.phrase("fault_says", ": ");
  words += status.phrase("fault_code", " [code ", "]");
  words += status.phrase("fault_register", " [error register ", "]");
  words += status.phrase("fault_own", " [maker's bytes ", "]");
  words += status.phrase("fault_object", "; object ");
  words += status.phrase("fault_found", " is ");
  words += status.phrase("fault_wanted", ", wanted ");
  return words;
}

void add_warnings(Status& status, Entries& out) {
  out.add("fault", fault_in_words(status));
  out.add("faulted", status.phrase("faulted", "the drives of joints ", " have faults"));
  out.add("unreferenced", status.phrase("unreferenced", "joints ",
                                        " may stand elsewhere than they read: look, then "
                                        "`confirm` each (`help confirm`)"));
  out.add("warning", status.phrase("warning", "the drives of joints ", " warn"));
  out.add("unsupervised",
          status.phrase("unsupervised", "joints ",
                        " keep torque if armsigd dies; the emergency stop must end it"));
  out.add("torque", status.phrase("torque_percent", "", " % of the rated one, by joint"));
  out.add("sequence torque", status.phrase("largest_torque_percent", "at most ", " %, by joint"));
  out.add("limits", status.phrase("limits_active", "the drives of joints ",
                                  " limit the motion by themselves"));
  const std::string store = status.take("store");
  if (!store.empty()) out.add("store", error_in_words(store));
  if (!status.take("acknowledge").empty()) {
    out.add("store",
            "the stored signature is not in use; `acknowledge` permits tool moves by the nominal "
            "model");
  }
}

// "q1 12.0000°", as many in a line as it has room for.
void add_readings(Status& status, Entries& out) {
  constexpr std::size_t kCell = 16;
  std::string line;
  std::size_t cells = 0;
  std::string_view name = "readings";
  for (std::size_t joint = 1; joint <= kMaxJoints; ++joint) {
    std::string value = status.phrase(fmt::format("q{}_deg", joint), "", "°");
    if (value.empty()) value = status.phrase(fmt::format("q{}_mm", joint), "", " mm");
    if (value.empty()) continue;
    if (cells == std::max<std::size_t>(1, out.text_width() / kCell)) {
      out.add_line(std::exchange(name, ""), std::exchange(line, {}));
      cells = 0;
    }
    const std::string cell = fmt::format("q{} {}", joint, value);
    if (cells++ > 0) line += ' ';
    line += fmt::format("{:<{}}", cell, kCell - 1);
  }
  while (line.ends_with(' ')) line.pop_back();
  if (!line.empty()) out.add_line(name, line);
  const std::string x = status.take("x_mm");
  const std::string y = status.take("y_mm");
  const std::string z = status.take("z_mm");
  if (!x.empty()) out.add("tool", fmt::format("x {} mm, y {} mm, z {} mm", x, y, z));
}

// "over the joint limits"; a region of another version as it is called.
std::string over_region(std::string_view called) {
  const auto* const region = std::ranges::find(kPredictedRegions, called);
  if (region == kPredictedRegions.end()) return fmt::format(" over {}", called);
  const auto number = static_cast<std::size_t>(region - kPredictedRegions.begin());
  return " over " + region_in_words(static_cast<PredictedRegion>(number));
}

void add_model(Status& status, Entries& out) {
  const bool nominal = status.take("model") == "nominal";
  std::string words = nominal ? "nominal" : status.phrase("signature", "signature ");
  if (status.take("maps") == "yes") words += ", with gravity and joint error maps";
  const std::string predicted = status.take("predicted_tool_error_mm");
  if (!predicted.empty()) {
    words += fmt::format("; tool error {} mm (1 sigma, predicted)", predicted);
    const std::string region = status.take("predicted_region");
    if (!region.empty()) words += over_region(region);
  }
  const std::string validation = status.take("validation_rms_mm");
  if (!validation.empty()) {
    words += fmt::format("; {} mm RMS on ", validation);
    words += status.take("validation_poses") + " validation poses, sensor noise included";
  }
  words += status.phrase("air_c", "; identified at ", " °C of air");
  out.add("model", words);
}

void add_sensor(Status& status, Entries& out) {
  const std::string sensor = status.take("sensor");
  if (sensor.empty()) return;
  std::string words = sensor == "well" ? "reads well" : error_in_words(sensor);
  words += status.phrase("sensor_says", ": ");
  out.add("sensor", words);
}

std::string candidate_in_words(Status& status) {
  std::string words =
      status.phrase("candidate_predicted_tool_error_mm", "; tool error so far ", " mm (predicted)");
  const std::string region = status.take("candidate_predicted_region");
  return region.empty() ? words : words + over_region(region);
}

void add_sequence(Status& status, Entries& out) {
  constexpr std::array<std::array<std::string_view, 2>, 4> kSequences{{
      {"identifying", "identification"},
      {"paused", "identification, paused: `resume` goes on"},
      {"touching", "grid touching"},
      {"checking", "check"},
  }};
  const std::string sequence = status.take("sequence");
  if (!sequence.empty() && sequence != "none") {
    std::string words = translated(sequence, kSequences);
    words += status.phrase("points", "; ");
    words += status.phrase("planned", " of ", " points");
    words += status.phrase("touched", "; ", " vertices touched");
    words += status.phrase("sweep", "; joint ", " is swept");
    words += status.phrase("axis_sigma_deg", ", its axis known to ", "°");
    if (status.take("refining") == "yes") words += "; further poses for the accuracy asked for";
    words += candidate_in_words(status);
    const auto left_s = parse_number(status.take("left_s"));
    if (left_s) words += fmt::format("; {} left", duration_in_words(*left_s));
    out.add("sequence", words);
  }
  out.add("last check", status.take("check"));
}

void add_times(Status& status, Entries& out) {
  std::string words = status.phrase("ticks", "", " since the start");
  words += status.phrase("late_mean_us", "; late by ", " us on average");
  words += status.phrase("late_max_us", ", ", " us at most");
  words += status.phrase("exec_mean_us", "; each takes ", " us on average");
  words += status.phrase("exec_max_us", ", ", " us at most");
  out.add("ticks", words);
  out.add("background", status.phrase("step_max_us", "longest step ", " us"));
  out.add("black box", status.take("black_box"));
  // For programs: `raw status` has them.
  (void)status.take("late_bins");
  (void)status.take("exec_bins");
}

}  // namespace

std::string status_in_words(std::string_view reply, std::size_t width) {
  Status status(reply);
  Entries out(width);
  const std::string mode = status.take("mode");
  const bool moving = status.take("moving") == "yes";
  out.add(mode, mode_in_words(mode) + (moving && mode == "holding" ? ", a move is under way" : ""));
  add_warnings(status, out);
  add_readings(status, out);
  add_model(status, out);
  add_sensor(status, out);
  add_sequence(status, out);
  add_times(status, out);
  std::string further;
  for (const auto& [key, value] : status.left()) {
    further += fmt::format("{}{}={}", further.empty() ? "" : " ", shown(key), shown(value));
  }
  out.add("further", further);
  return out.lines();
}

}  // namespace armsig::tool
