// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_rows.hpp"

#include "core/calibration/standing_still.hpp"

namespace armsig::tool {

using calibration::kDeviations;

namespace {

constexpr std::size_t kOfTheBase = 6;  // columns of the engine that are none here

bool has_moved(const PlaceTask& task, std::size_t joint, JointType type) {
  return !calibration::stood_still(
      task.touches, [](const TouchRow& row) -> const JointVector& { return row.q; }, joint, type);
}

}  // namespace

PlaceColumns::PlaceColumns(const PlaceTask& task, const PlaceState& state,
                           const PlaceParts& parts) {
  const std::size_t n = state.arm.joint_count();
  gravity = 3 + (parts.geometry ? static_cast<Eigen::Index>(kDeviations * n) : 0);
  geometry = gravity + (parts.gravity ? static_cast<Eigen::Index>(state.arm.gravity.size()) : 0);
  places = geometry;
  for (std::size_t j = 0; j < n && parts.maps; ++j) {
    const calibration::JointModel& joint = state.arm.joints[j];
    if (!(joint.domain.per_length > 0) || !has_moved(task, j, joint.type)) continue;
    maps.emplace_back(j, places);
    places += static_cast<Eigen::Index>(calibration::kKnots);
  }
  size = places + 3 * static_cast<Eigen::Index>(task.places.size());
  for (const Instrument& instrument : task.instruments) {
    const bool wire = instrument.kind == InstrumentKind::kWire;
    scales.push_back(wire ? size : -1);
    size += wire ? 2 : 0;
  }
}

double PlaceScalar::times(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const auto& [column, value] : J) sum += value * x[column];
  return sum;
}

PlaceRows::PlaceRows(const PlaceTask& task, PlaceState& state, const PlaceColumns& columns)
    : task_(task), state_(state), columns_(columns) {
  using calibration::Engine;
  matrix_.resize(calibration::matrix_size(Engine::columns(state.arm, 1)));
  engine_ = std::make_unique<Engine>(state.arm, std::span(&state.tool, 1),
                                     std::span<calibration::FitRow>{},
                                     std::span<calibration::ChainFrames>{}, matrix_, *work_);
}

InstrumentRow PlaceRows::row_of(const TouchRow& touch, const Vector3& p_B) const {
  const TouchedPlace& place = state_.places[touch.place];
  return instrument_row(place, state_.scales[place.instrument], p_B, touch.length_m);
}

void PlaceRows::add_tool(const calibration::ChainFrames& frames, const JointVector& q,
                         const Matrix3& by_point, Eigen::Index scalars, PlaceScalar* rows) const {
  calibration::GeometryColumns by;
  calibration::FitRow row;
  row.readings = q;
  engine_->fill(row, frames, by);
  const auto derivative = [&](std::size_t column) {
    return Vector3(by_point * Vector3(by.d[0][column], by.d[1][column], by.d[2][column]));
  };
  const auto add = [&](Eigen::Index column, const Vector3& value) {
    for (Eigen::Index i = 0; i < scalars; ++i) {
      if (value[i] != 0) rows[i].J.emplace_back(static_cast<int>(column), value[i]);
    }
  };
  for (Eigen::Index c = 0; c < columns_.gravity; ++c) {
    add(c, derivative(kOfTheBase + static_cast<std::size_t>(c)));
  }
  for (Eigen::Index c = columns_.gravity; c < columns_.geometry; ++c) {
    add(c, derivative(engine_->gravity_column() + static_cast<std::size_t>(c - columns_.gravity)));
  }
  for (const auto& [joint, first] : columns_.maps) {
    const Vector3 motion = calibration::map_unit(state_.arm.joints[joint].type) *
                           derivative(engine_->joint_column(joint) + kDeviations - 1);
    const calibration::SplineSupport& support = frames.support[joint];
    for (std::size_t k = 0; k < calibration::kSplines; ++k) {
      add(first + static_cast<Eigen::Index>(support.knot(k)), support.weight[k] * motion);
    }
  }
}

std::vector<PlaceScalar> PlaceRows::touches() const {
  std::vector<PlaceScalar> all;
  for (std::size_t k = 0; k < task_.touches.size(); ++k) {
    const TouchRow& touch = task_.touches[k];
    calibration::ChainFrames frames;
    evaluate_chain(state_.arm, touch.q, state_.tool.link, frames);
    const InstrumentRow row = row_of(touch, frames.X_SL * state_.tool.p_L);
    std::array<PlaceScalar, 3> scalars;
    add_tool(frames, touch.q, row.by_point, row.scalars, scalars.data());
    for (Eigen::Index i = 0; i < row.scalars; ++i) {
      PlaceScalar& scalar = scalars[static_cast<std::size_t>(i)];
      scalar.touch = k;
      scalar.residual = row.residual[i];
      for (Eigen::Index c = 0; c < 3; ++c) {
        if (row.by_place(i, c) == 0) continue;
        scalar.J.emplace_back(static_cast<int>(columns_.place(touch.place) + c),
                              row.by_place(i, c));
      }
      const Eigen::Index scale = columns_.scales[state_.places[touch.place].instrument];
      for (Eigen::Index c = 0; c < 2 && scale >= 0; ++c) {
        scalar.J.emplace_back(static_cast<int>(scale + c), row.by_scale(i, c));
      }
      all.push_back(std::move(scalar));
    }
  }
  return all;
}

std::vector<PlaceScalar> PlaceRows::lengths() const {
  std::vector<PlaceScalar> all;
  for (const SocketLength& length : task_.lengths) {
    const LengthRow row =
        length_row(state_.places[length.from], state_.places[length.to], length.length_m);
    PlaceScalar scalar;
    scalar.residual = row.residual_m / length.sigma_m;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double by = row.by_second[c] / length.sigma_m;
      scalar.J.emplace_back(static_cast<int>(columns_.place(length.to) + c), by);
      scalar.J.emplace_back(static_cast<int>(columns_.place(length.from) + c), -by);
    }
    all.push_back(std::move(scalar));
  }
  return all;
}

std::array<PlaceScalar, 3> PlaceRows::tool(const JointVector& q) const {
  calibration::ChainFrames frames;
  evaluate_chain(state_.arm, q, state_.tool.link, frames);
  std::array<PlaceScalar, 3> rows;
  add_tool(frames, q, Matrix3::Identity(), 3, rows.data());
  return rows;
}

std::vector<double> PlaceRows::touch_residuals() const {
  std::vector<double> all;
  for (const TouchRow& touch : task_.touches) {
    const InstrumentRow row = row_of(touch, state_.tool_at(touch.q));
    for (Eigen::Index i = 0; i < row.scalars; ++i) all.push_back(row.residual[i]);
  }
  return all;
}

std::vector<double> PlaceRows::length_residuals() const {
  std::vector<double> all;
  for (const SocketLength& length : task_.lengths) {
    const LengthRow row =
        length_row(state_.places[length.from], state_.places[length.to], length.length_m);
    all.push_back(row.residual_m / length.sigma_m);
  }
  return all;
}

void PlaceRows::move(const Eigen::VectorXd& step, double fraction) {
  const auto by = [&](Eigen::Index column) { return fraction * step[column]; };
  for (Eigen::Index c = 0; c < 3; ++c) state_.tool.p_L[c] += by(c);
  for (Eigen::Index c = 3; c < columns_.gravity; ++c) {
    const auto k = static_cast<std::size_t>(c - 3);
    state_.arm.joints[k / kDeviations].deviation[k % kDeviations] += by(c);
  }
  for (Eigen::Index c = columns_.gravity; c < columns_.geometry; ++c) {
    state_.arm.gravity[static_cast<std::size_t>(c - columns_.gravity)].coefficient += by(c);
  }
  for (const auto& [joint, first] : columns_.maps) {
    for (std::size_t k = 0; k < calibration::kKnots; ++k) {
      state_.arm.joints[joint].map[k] += by(first + static_cast<Eigen::Index>(k));
    }
  }
  for (std::size_t s = 0; s < state_.places.size(); ++s) {
    const Eigen::Index first = columns_.place(s);
    armsig::tool::move(state_.places[s], {by(first), by(first + 1), by(first + 2)});
  }
  for (std::size_t i = 0; i < state_.scales.size(); ++i) {
    if (columns_.scales[i] < 0) continue;
    state_.scales[i].gain += by(columns_.scales[i]);
    state_.scales[i].zero_m += by(columns_.scales[i] + 1);
  }
}

}  // namespace armsig::tool
