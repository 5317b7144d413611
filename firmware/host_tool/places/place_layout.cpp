// SPDX-License-Identifier: MIT
#include "firmware/host_tool/places/place_layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "core/base/low_discrepancy.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "firmware/host_tool/places/place_accuracy.hpp"

namespace armsig::tool {
namespace {

constexpr double kOrdinaryRotation = 1e-3;
constexpr double kOrdinaryShift_m = 0.5e-3;
constexpr double kOrdinaryZero = 3e-3;
constexpr double kOrdinaryDeflection = 0.3e-3;  // a metre of lever, by the weight of each link
constexpr double kOrdinaryMap = 0.7;            // in units of map_unit()

constexpr int kPlacesTried = 24;       // for each bar
constexpr int kMostPlacesTried = 400;  // where it can stand at none of these
constexpr std::size_t kProbes = 6;     // touches of a place that is tried
constexpr std::size_t kLeastPostures = 3;
constexpr double kPatch_m = 0.2;  // what is touched of a plane, to either side
constexpr double kSteepestPlane_rad = radians(60);
constexpr double kShortestWire_m = 0.1;
// A wire leaves the tool away from the arm.
constexpr double kWireToStem_rad = radians(80);
// What stands on a stand is in the lower part of the heights that the tool gets to.
constexpr double kLowPart = 0.45;
// Parts of the reach.
constexpr double kFromFoot = 0.2;
constexpr double kApart = 0.15;
constexpr double kBesideReach = 1.2;  // an anchor

constexpr double by_itself(double x) { return x * x; }

// What is placed as one: a bar of two sockets, or a single place.
struct Piece {
  std::vector<std::string> names;
  const KnownLength* length = nullptr;

  [[nodiscard]] std::string words() const {
    return length == nullptr ? names.front()
                             : fmt::format("the bar {} to {}", length->from, length->to);
  }
};

Read<std::vector<Piece>> pieces_of(const InstrumentDescription& description,
                                   const std::string& file) {
  std::vector<Piece> pieces;
  const auto is_named = [&](const std::string& name) {
    return std::ranges::any_of(pieces, [&](const Piece& piece) {
      return std::ranges::find(piece.names, name) != piece.names.end();
    });
  };
  for (const KnownLength& length : description.lengths) {
    for (const std::string& name : {length.from, length.to}) {
      if (!is_named(name)) continue;
      return std::unexpected(Problem{file, length.line, 0,
                                     fmt::format("a second length with {}", name),
                                     "bars of two sockets each: one length a socket"});
    }
    pieces.push_back({.names = {length.from, length.to}, .length = &length});
  }
  for (const auto& [name, instrument] : description.place_instruments) {
    if (!is_named(name)) pieces.push_back({.names = {name}});
  }
  if (!pieces.empty()) return pieces;
  return std::unexpected(
      Problem{file, 0, 0, "no place is named", "lengths of bars, or places with the name of each"});
}

class LayingOut {
 public:
  LayingOut(const Arm& nominal, const InstrumentDescription& description, const TouchSearch& search,
            double sigma_m)
      : search_(search), description_(description), sigma_m_(sigma_m) {
    layout_.task = place_task(nominal, description, {});
    for (const TouchSearch::Stand& stand : search.stands()) {
      if (layout_.judged.size() < kJudgedConfigurations) layout_.judged.push_back(stand.q);
      reach_m_ = std::max(reach_m_, across(stand.p_B).norm());
      highest_m_ = std::max(highest_m_, up().dot(stand.p_B));
      lowest_m_ = std::min(lowest_m_, up().dot(stand.p_B));
    }
    const double low_m = lowest_m_ + kLowPart * (highest_m_ - lowest_m_);
    for (const TouchSearch::Stand& stand : search.stands()) {
      if (up().dot(stand.p_B) <= low_m) low_.push_back(stand.p_B);
    }
  }

  // False: it can stand nowhere.
  bool add(const Piece& piece) {
    std::optional<PlaceLayout> best;
    double least_m = 0;
    for (int n = 1; n <= kPlacesTried || (!best && n <= kMostPlacesTried); ++n) {
      std::optional<PlaceLayout> tried = placed(piece, n);
      if (!tried) continue;
      const double error_m = expected_error_m(tried->task);
      if (best && error_m >= least_m) continue;
      best = std::move(tried);
      least_m = error_m;
    }
    if (!best) return false;
    layout_ = *std::move(best);
    return true;
  }

  // With all touches that are possible.
  PlaceLayout with_touches(std::size_t most) {
    layout_.task.touches.clear();
    for (std::size_t place = 0; place < layout_.task.places.size(); ++place) {
      add_touches(layout_, place, most);
    }
    return std::move(layout_);
  }

 private:
  [[nodiscard]] const Vector3& up() const { return layout_.task.nominal.up_0; }
  [[nodiscard]] Vector3 across(const Vector3& p_B) const { return p_B - up().dot(p_B) * up(); }
  [[nodiscard]] Vector3 around_up(double turns) const {
    return Eigen::AngleAxisd(2 * kPi * turns, up()) * up().unitOrthogonal();
  }

  [[nodiscard]] double expected_error_m(const PlaceTask& task) const {
    const PlaceScales scales = expected_scales(task, sigma_m_);
    PlaceFit fit(task, nominal_state(task), {.maps = false}, &scales);
    std::vector<std::size_t> all(task.touches.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    fit.foresee(all);
    return tool_knowledge(fit, layout_.judged).rms_m;
  }

  // The piece at the n-th of the places that are tried.
  [[nodiscard]] std::optional<PlaceLayout> placed(const Piece& piece, int n) const {
    PlaceLayout layout = layout_;
    const std::size_t first = layout.task.places.size();
    for (const std::string& name : piece.names) {
      const std::size_t instrument = description_.instrument_of(name);
      layout.task.places.push_back({.name = name,
                                    .instrument = instrument,
                                    .kind = description_.instruments[instrument].kind});
    }
    const InstrumentKind kind = layout.task.places[first].kind;
    const Vector3 middle_B = a_middle(kind, n);
    const double apart_m = piece.length == nullptr ? 0 : piece.length->length_m;
    const Vector3 half = apart_m / 2 * around_up(halton(1, n));
    if (kind != InstrumentKind::kWire && !is_apart(middle_B - half, middle_B + half)) {
      return std::nullopt;
    }
    for (std::size_t k = first; k < layout.task.places.size(); ++k) {
      layout.middle_B.emplace_back(middle_B + (k == first ? -1 : 1) * half);
      if (!set(layout, k, n) || add_touches(layout, k, kProbes) < kLeastPostures) {
        return std::nullopt;
      }
    }
    if (piece.length != nullptr) {
      layout.task.lengths.push_back({first, first + 1, apart_m, piece.length->sigma_m});
    }
    return layout;
  }

  [[nodiscard]] Vector3 a_middle(InstrumentKind kind, int n) const {
    if (kind == InstrumentKind::kWire) {
      const double height_m = lowest_m_ + halton(2, n) * (highest_m_ - lowest_m_);
      return kBesideReach * reach_m_ * around_up(halton(0, n)) + height_m * up();
    }
    const auto count = static_cast<double>(low_.size());
    return low_[static_cast<std::size_t>(halton(0, n) * count)];
  }

  bool set(PlaceLayout& layout, std::size_t index, int n) const {
    TouchedPlace& place = layout.task.places[index];
    const Vector3& middle_B = layout.middle_B[index];
    place.point_B = middle_B;
    if (place.kind == InstrumentKind::kWire) return true;
    if (place.kind == InstrumentKind::kPlane) {
      const double lean_rad = kSteepestPlane_rad * halton(3, n);
      place.point_B = std::cos(lean_rad) * up() + std::sin(lean_rad) * around_up(halton(2, n));
      place.distance_m = place.point_B.dot(middle_B);
    }
    return search_.has_room(middle_B);
  }

  // Whether what stands from `from_B` to `to_B` is apart from the arm's foot, and from the bars and
  // places that stand already.
  [[nodiscard]] bool is_apart(const Vector3& from_B, const Vector3& to_B) const {
    const double apart_m = kApart * reach_m_;
    const auto steps = static_cast<int>(std::ceil(2 * (to_B - from_B).norm() / apart_m));
    for (int k = 0; k <= steps; ++k) {
      const Vector3 at_B = from_B + (to_B - from_B) * k / std::max(steps, 1);
      if (across(at_B).norm() < kFromFoot * reach_m_) return false;
      for (const Vector3& other_B : layout_.middle_B) {
        if ((at_B - other_B).norm() < apart_m) return false;
      }
      for (const SocketLength& bar : layout_.task.lengths) {
        const Eigen::ParametrizedLine<double, 3> line = Eigen::ParametrizedLine<double, 3>::Through(
            layout_.middle_B[bar.from], layout_.middle_B[bar.to]);
        const double along_m = line.direction().dot(at_B - line.origin());
        if (along_m > 0 && along_m < bar.length_m && line.distance(at_B) < apart_m) return false;
      }
    }
    return true;
  }

  // How many.
  std::size_t add_touches(PlaceLayout& layout, std::size_t index, std::size_t most) const {
    const TouchedPlace& place = layout.task.places[index];
    const Vector3& middle_B = layout.middle_B[index];
    std::vector<TouchRow> touches;
    const auto add = [&](const JointVector& q, double length_m = 0) {
      touches.push_back({.line = 0, .place = index, .q = q, .length_m = length_m});
    };
    switch (place.kind) {
      case InstrumentKind::kSocket:
        for (const JointVector& q : search_.touches(middle_B, up(), most)) add(q);
        break;
      case InstrumentKind::kPlane:
        for (std::size_t k = 0; k < most; ++k) {
          for (const JointVector& q :
               search_.touches(on_plane(place, middle_B, k), place.point_B, 1, k)) {
            add(q);
          }
        }
        break;
      case InstrumentKind::kWire:
        for (const TouchSearch::Stand& stand : search_.stands()) {
          if (touches.size() == most) break;
          const Vector3 wire = place.point_B - stand.p_B;
          const double read_m = wire.norm() - layout.task.instruments[place.instrument].zero_m;
          const Vector3 stem = search_.stem_B(stand.q);
          if (std::min(read_m, wire.norm()) < kShortestWire_m) continue;
          if (stem.dot(wire.normalized()) > std::cos(kWireToStem_rad)) continue;
          add(stand.q, read_m);
        }
        break;
    }
    layout.task.touches.insert(layout.task.touches.end(), touches.begin(), touches.end());
    return touches.size();
  }

  [[nodiscard]] static Vector3 on_plane(const TouchedPlace& place, const Vector3& middle_B,
                                        std::size_t k) {
    const Vector3 first = place.point_B.unitOrthogonal();
    const Vector3 second = place.point_B.cross(first);
    const int n = static_cast<int>(k) + 1;
    return middle_B + kPatch_m * ((2 * halton(0, n) - 1) * first + (2 * halton(1, n) - 1) * second);
  }

  const TouchSearch& search_;
  const InstrumentDescription& description_;
  double sigma_m_;
  PlaceLayout layout_;
  double reach_m_ = 0;
  double highest_m_ = -std::numeric_limits<double>::infinity();
  double lowest_m_ = std::numeric_limits<double>::infinity();
  std::vector<Vector3> low_;  // where the tool may stand there
};

}  // namespace

PlaceScales expected_scales(const PlaceTask& task, double sigma_m) {
  PlaceScales scales;
  scales.prior.rotation = by_itself(kOrdinaryRotation) / PlaceFit::usual_variance(3);
  scales.prior.shift = by_itself(kOrdinaryShift_m) / PlaceFit::usual_variance(5);
  scales.prior.zero = by_itself(kOrdinaryZero) / PlaceFit::usual_variance(7);
  scales.prior.gravity =
      by_itself(kOrdinaryDeflection / calibration::map_unit(JointType::kRevolute));
  scales.prior.map.fill(by_itself(kOrdinaryMap));
  scales.sigma_squared.assign(task.instruments.size(), by_itself(sigma_m));
  return scales;
}

Read<PlaceLayout> lay_out(const Arm& nominal, const InstrumentDescription& description,
                          const TouchSearch& search, double sigma_m, std::size_t most,
                          const std::string& file) {
  auto pieces = pieces_of(description, file);
  if (!pieces) return std::unexpected(std::move(pieces).error());
  LayingOut laying(nominal, description, search, sigma_m);
  for (const Piece& piece : *pieces) {
    if (!search.stands().empty() && laying.add(piece)) continue;
    return std::unexpected(
        Problem{file, 0, 0, fmt::format("{} can stand nowhere that was tried", piece.words()),
                "a shorter bar, a larger --box-mm, or a tool that is not in the way"});
  }
  return laying.with_touches(most);
}

}  // namespace armsig::tool
