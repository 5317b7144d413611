// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_task.hpp"

#include <algorithm>
#include <numeric>

namespace armsig::tool {
namespace {

std::size_t place_index(PlaceTask& task, const InstrumentDescription& description,
                        const std::string& name) {
  const auto found = std::ranges::find(task.places, name, &TouchedPlace::name);
  if (found != task.places.end()) return static_cast<std::size_t>(found - task.places.begin());
  const std::size_t instrument = description.instrument_of(name);
  task.places.push_back(
      {.name = name, .instrument = instrument, .kind = description.instruments[instrument].kind});
  return task.places.size() - 1;
}

}  // namespace

bool PlaceTask::has_wires() const {
  return std::ranges::find(places, InstrumentKind::kWire, &TouchedPlace::kind) != places.end();
}

bool PlaceTask::uses(std::size_t instrument) const {
  return std::ranges::find(places, instrument, &TouchedPlace::instrument) != places.end();
}

std::vector<std::size_t> PlaceTask::placements() const {
  std::vector<std::size_t> of(places.size());
  std::iota(of.begin(), of.end(), std::size_t{0});
  for (const SocketLength& length : lengths) {
    const std::size_t gone = std::max(of[length.from], of[length.to]);
    const std::size_t kept = std::min(of[length.from], of[length.to]);
    std::ranges::replace(of, gone, kept);
  }
  std::vector<std::size_t> numbers = of;
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  for (std::size_t& placement : of) {
    placement = static_cast<std::size_t>(std::ranges::find(numbers, placement) - numbers.begin());
  }
  return of;
}

PlaceTask place_task(const Arm& nominal, const InstrumentDescription& description,
                     const std::vector<Touch>& touches) {
  PlaceTask task{.nominal = nominal,
                 .tool_F = description.tool_F,
                 .instruments = description.instruments,
                 .places = {},
                 .touches = {},
                 .lengths = {}};
  for (const Touch& touch : touches) {
    task.touches.push_back(
        {touch.line, place_index(task, description, touch.place), touch.q, touch.length_m});
  }
  for (const KnownLength& length : description.lengths) {
    const auto from = std::ranges::find(task.places, length.from, &TouchedPlace::name);
    const auto to = std::ranges::find(task.places, length.to, &TouchedPlace::name);
    if (from == task.places.end() || to == task.places.end()) continue;
    task.lengths.push_back({static_cast<std::size_t>(from - task.places.begin()),
                            static_cast<std::size_t>(to - task.places.begin()), length.length_m,
                            length.sigma_m});
  }
  return task;
}

Vector3 PlaceState::tool_at(const JointVector& q) const {
  calibration::ChainFrames frames;
  evaluate_chain(arm, q, tool.link, frames);
  return frames.X_SL * tool.p_L;
}

PlaceState nominal_state(const PlaceTask& task) {
  PlaceState state{.arm = calibration::model_of(task.nominal, Pose{}),
                   .tool = {.link = task.nominal.joints.size(),
                            .p_L = task.tool_F,
                            .start_L = task.tool_F,
                            .rows = task.touches.size()},
                   .places = task.places,
                   .scales = {}};
  calibration::choose_gravity_terms(task.nominal, state.arm);
  for (const Instrument& instrument : task.instruments) {
    state.scales.push_back({0, instrument.zero_m});
  }
  return state;
}

}  // namespace armsig::tool
