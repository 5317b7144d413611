// SPDX-License-Identifier: MIT
#include "core/calibration/servo_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/base/lanes.hpp"

namespace armsig::calibration {

namespace {

// Whole periods that readings are moved up by, so that cutting off the fraction rounds down. There
// a reading still has 1e-11 of the way between two knots.
constexpr double kUp = 1000.0 * kKnots;

// Whole numbers as a pack.
template <typename V, std::size_t kCount>
[[gnu::always_inline]] inline V numbers(const std::array<std::int32_t, kCount>& whole) {
  if constexpr (std::is_same_v<V, double>) {
    return whole[0];
  } else {
    using Whole [[gnu::vector_size(kCount * sizeof(std::int32_t))]] = std::int32_t;
    return __builtin_convertvector(load<Whole>(whole.data()), V);
  }
}

template <typename V>
[[gnu::always_inline]] inline PackMask<double> less(const V& a, const V& b) {
  if constexpr (std::is_same_v<V, double>) {
    return a < b ? ~PackMask<double>{} : PackMask<double>{};
  } else {
    return a < b;
  }
}

// The four splines that are not zero between two knots, t of the way from the second of them to
// the third, times six; and their derivatives, times two.
template <typename V>
struct Splines {
  std::array<V, kSplines> weight;

  [[gnu::always_inline]] static Splines at(const V& t) {
    const V left = 1.0 - t;
    const V first = left * left * left;
    const V last = t * t * t;
    const V second = 4.0 + t * t * (3.0 * t - 6.0);
    return {{first, second, 6.0 - first - second - last, last}};
  }
  [[gnu::always_inline]] static Splines slopes_at(const V& t) {
    const V left = 1.0 - t;
    const V first = -left * left;
    const V last = t * t;
    const V second = t * (3.0 * t - 4.0);
    return {{first, second, -(first + second + last), last}};
  }
  [[gnu::always_inline]] [[nodiscard]] V times(const std::array<V, kSplines>& c) const {
    return weight[0] * c[0] + weight[1] * c[1] + weight[2] * c[2] + weight[3] * c[3];
  }
};

}  // namespace

void ServoMaps::set(const PackedDeflections& deflections) {
  joint_count_ = deflections.maps.size();
  origin_.fill(0);
  knots_per_length_.fill(0);
  sixth_.fill(0);
  for (Table& table : tables_) table.fill(0);
  for (std::size_t i = 0; i < deflections.maps.size(); ++i) {
    const PackedMap& map = deflections.maps[i];
    origin_[i] = map.domain.origin;
    knots_per_length_[i] = map.domain.per_length;
    sixth_[i] = map.step / 6;
    for (std::size_t k = 0; k < tables_[i].size(); ++k) tables_[i][k] = map.steps[k % kKnots];
  }
}

template <typename Slopes>
[[gnu::always_inline]] inline bool ServoMaps::evaluate(const Values& readings, Values& values,
                                                       Slopes& slopes) const {
  using V = Pack<double>;
  using Bits = PackMask<double>;
  constexpr std::size_t kCount = Lanes<double>::kCount;
  constexpr auto kNoSign = std::numeric_limits<typename Lanes<double>::Integer>::max();
  Bits in_reach = ~Bits{};
  for (std::size_t j = 0; j < joint_count_; j += kCount) {
    const V per_length = load<V>(knots_per_length_.data() + j);
    const V from_origin = (load<V>(readings.data() + j) - load<V>(origin_.data() + j)) * per_length;
    // Written so that a NaN is not in reach; there is a table behind every number that is left.
    const Bits known = less(bits_as<V>(bits_as<Bits>(from_origin) & kNoSign), V{} + kUp);
    in_reach &= known;
    alignas(32) std::array<double, kCount> at;
    store(at.data(), bits_as<V>(bits_as<Bits>(from_origin) & known) + kUp);
    alignas(32) std::array<std::int32_t, kCount> whole;
    alignas(32) std::array<std::array<std::int32_t, kCount>, kSplines> c;
    for (std::size_t lane = 0; lane < kCount; ++lane) {
      whole[lane] = static_cast<std::int32_t>(at[lane]);
      const std::int16_t* table =
          tables_[j + lane].data() + static_cast<std::uint32_t>(whole[lane]) % kKnots;
      for (std::size_t k = 0; k < kSplines; ++k) c[k][lane] = table[k];
    }
    const V t = load<V>(at.data()) - numbers<V>(whole);
    const std::array<V, kSplines> coefficients{numbers<V>(c[0]), numbers<V>(c[1]), numbers<V>(c[2]),
                                               numbers<V>(c[3])};
    const V sixth = load<V>(sixth_.data() + j);
    store(values.data() + j, sixth * Splines<V>::at(t).times(coefficients));
    if constexpr (std::is_same_v<Slopes, Values>) {
      const V half = 3.0 * sixth * per_length;
      store(slopes.data() + j, half * Splines<V>::slopes_at(t).times(coefficients));
    }
  }
  return all(in_reach);
}

bool ServoMaps::at(const Values& readings, Values& values) const {
  NoSlopes none;
  return evaluate(readings, values, none);
}

bool ServoMaps::at(const Values& readings, Values& values, Values& slopes) const {
  return evaluate(readings, values, slopes);
}

double ServoMaps::largest(std::size_t joint) const {
  double largest = 0;
  for (const std::int16_t step : tables_[joint]) {
    largest = std::max(largest, std::abs(static_cast<double>(step)));
  }
  return 6 * sixth_[joint] * largest;
}

// Between two knots the second derivative runs straight from one second difference to the next.
double ServoMaps::most_bent(std::size_t joint) const {
  const Table& c = tables_[joint];
  int most = 0;
  for (std::size_t k = 0; k + 2 < c.size(); ++k) {
    most = std::max(most, std::abs(c[k] - 2 * c[k + 1] + c[k + 2]));
  }
  return 6 * sixth_[joint] * most * knots_per_length_[joint] * knots_per_length_[joint];
}

}  // namespace armsig::calibration
