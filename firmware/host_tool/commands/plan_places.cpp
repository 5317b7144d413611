// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/plan_places.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/file_roles.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/touches.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/places/place_drawing.hpp"
#include "firmware/host_tool/places/place_plan.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// Touches of a place that are looked at.
constexpr std::size_t kLookedAt = 40;
// Of the counts of touches in the table, each so many times the one before.
constexpr double kNextCount = 1.5;
constexpr std::size_t kFirstCount = 20;

struct PlannedPlaces {
  PlaceLayout layout;
  PlacePlan plan;

  [[nodiscard]] std::size_t touches_of(std::size_t place) const {
    return static_cast<std::size_t>(std::ranges::count_if(plan.touches, [&](std::size_t touch) {
      return layout.task.touches[touch].place == place;
    }));
  }
};

std::vector<Touch> touches_of(const PlannedPlaces& planned) {
  const PlaceTask& task = planned.layout.task;
  std::vector<Touch> touches;
  for (const std::size_t k : planned.plan.touches) {
    const TouchRow& row = task.touches[k];
    touches.push_back({.place = task.places[row.place].name, .q = row.q, .length_m = row.length_m});
  }
  return touches;
}

Table places_table(const PlannedPlaces& planned) {
  Table table({"Place", "x, mm", "y, mm", "z, mm", "Touches"});
  for (std::size_t k = 0; k < planned.layout.middle_B.size(); ++k) {
    const Vector3 mm = 1e3 * planned.layout.middle_B[k];
    table.add_row({planned.layout.task.places[k].name, fmt::format("{:.0f}", mm.x()),
                   fmt::format("{:.0f}", mm.y()), fmt::format("{:.0f}", mm.z()),
                   fmt::format("{}", planned.touches_of(k))});
  }
  return table;
}

Table errors_table(const PlacePlan& plan) {
  Table table({"Touches", "Expected tool error, mm"});
  const auto add = [&](std::size_t count) {
    table.add_row(
        {fmt::format("{}", count), fmt::format("{:.2f}", 1e3 * plan.expected_rms_m[count - 1])});
  };
  std::size_t count = kFirstCount;
  for (; count < plan.touches.size();
       count = static_cast<std::size_t>(kNextCount * static_cast<double>(count))) {
    add(count);
  }
  add(plan.touches.size());
  return table;
}

nlohmann::ordered_json json_of(const PlannedPlaces& planned, const std::string& name,
                               const std::string& out) {
  auto places = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < planned.layout.middle_B.size(); ++k) {
    const Vector3& at = planned.layout.middle_B[k];
    places.push_back({{"name", planned.layout.task.places[k].name},
                      {"p_B_m", {at.x(), at.y(), at.z()}},
                      {"touches", planned.touches_of(k)}});
  }
  return {{"status", 0},
          {"arm", name},
          {"places", std::move(places)},
          {"touches", planned.plan.touches.size()},
          {"expected_rms_m", planned.plan.expected_rms_m},
          {"out", out}};
}

void print_planned(const PoseOptions& poses, const PlacePlanOptions& options,
                   const std::string& named, const ArmDescription& arm,
                   const PlannedPlaces& planned, const clearance::Surroundings& around) {
  say("{}: {} touches of {}\n\n{}\n{}\n", arm.name, planned.plan.touches.size(),
      counted(planned.layout.middle_B.size(), "place"), places_table(planned).render(),
      errors_table(planned.plan).render());
  say("{}\n", paragraph(fmt::format(
                  "The error is that of the tool wherever the arm is clear, 1 sigma, RMS, for "
                  "touches that are "
                  "true to {:g} mm and an arm of ordinary make. identify states what was reached.",
                  options.sigma_mm)));
  say("{}\n", paragraph("Set the places up as listed, in the base frame; 50 mm beside is near "
                        "enough, for where they stand is found. The touches are in the order of "
                        "their worth. Lead the arm to each, and write down the readings there."));
  say("{}\n", paragraph(fmt::format("The arm is clear at every touch: {}. The way there is yours.",
                                    surroundings_in_words(around))));
  say("Written: {}\n", file_in_words(poses.out));
  if (!options.drawing.empty()) say("Written: {}\n", file_in_words(options.drawing));
  say_next(TypedCommand("identify")
               .file_option("--arm", named)
               .file_option("--instrument", options.instrument)
               .option("--measurements", "touches.csv")
               .option("--out", "signature.yaml"));
}

Read<void> check_place_plan(const PoseOptions& poses, const PlacePlanOptions& options,
                            const std::string& named) {
  if (poses.format != "csv") {
    return std::unexpected(
        Problem{"--format", 0, 0, poses.format, "csv: a person leads the arm to the touches"});
  }
  return check_roles({{"--arm", named}, {"--instrument", options.instrument}},
                     {{"--out", poses.out}, {"--drawing", options.drawing}});
}

// Why a plan is not whole.
Problem not_reached(const PlannedPlaces& planned, const PlacePlanOptions& options) {
  const std::size_t count = planned.plan.touches.size();
  const double left_mm = 1e3 * planned.plan.expected_rms_m.back();
  if (left_mm <= options.accuracy_mm) {
    return {options.instrument, 0, 0,
            fmt::format("{} touches are too few to check {}", count,
                        counted(planned.layout.middle_B.size(), "place")),
            "more --touches, or fewer places"};
  }
  return {options.instrument, 0, 0,
          fmt::format("{} touches leave a tool error of {:.3f} mm", count, left_mm),
          "a larger --accuracy-mm, more --touches, longer or more bars, or lengths and touches "
          "that are known better"};
}

Attempt<PlannedPlaces> planned_places(const PlacePlanOptions& options, const Arm& arm,
                                      const InstrumentDescription& description,
                                      const TouchSearch& search) {
  const double sigma_m = 1e-3 * options.sigma_mm;
  auto layout = lay_out(arm, description, search, sigma_m, kLookedAt, options.instrument);
  if (!layout) return no_answer(std::move(layout).error());
  PlannedPlaces planned{*std::move(layout), {}};
  planned.plan = plan_touches(planned.layout, sigma_m, 1e-3 * options.accuracy_mm, options.most);
  if (planned.plan.is_whole) return planned;
  return no_answer(not_reached(planned, options));
}

}  // namespace

Attempt<ExitStatus> plan_places(const PoseOptions& poses, const PlacePlanOptions& options,
                                const std::string& named, const ArmDescription& arm) {
  if (auto checked = check_place_plan(poses, options, named); !checked) {
    return std::unexpected(std::move(checked).error());
  }
  ARMSIG_TRY(description, read_instrument_file(options.instrument));
  const clearance::Surroundings around = poses.around(arm.arm, arm.mounting, 0);
  const TouchSearch search(arm.arm, description.tool_F, around);
  ARMSIG_TRY(planned, planned_places(options, arm.arm, description, search));
  if (auto written = write_text_file(
          poses.out, touches_text(touches_of(planned), types_of(arm.arm.joints), description));
      !written) {
    return std::unexpected(std::move(written).error());
  }
  if (!options.drawing.empty()) {
    const std::string title = fmt::format("{}: {}", arm.name, description.name);
    auto drawn = write_text_file(options.drawing, place_drawing(planned.layout, search, title));
    if (!drawn) return std::unexpected(std::move(drawn).error());
  }
  if (poses.json) {
    print_json(json_of(planned, arm.name, poses.out));
  } else {
    print_planned(poses, options, named, arm, planned, around);
  }
  return kDone;
}

}  // namespace armsig::tool
