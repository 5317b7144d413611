// SPDX-License-Identifier: MIT
// A vector of fixed capacity and run-time count, without a heap.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>

#include "core/base/check.hpp"

namespace armsig {

// Elements must be default-constructible and cheap to copy. Exceeding the capacity is a mistake of
// the caller (trap); where the count comes from outside, compare it with capacity() first.
template <typename T, std::size_t kCapacity>
class FixedVector {
 public:
  constexpr FixedVector() = default;
  constexpr explicit FixedVector(std::size_t count, const T& value = T{}) { resize(count, value); }
  constexpr FixedVector(std::initializer_list<T> values) {
    for (const T& value : values) push_back(value);
  }

  [[nodiscard]] static constexpr std::size_t capacity() { return kCapacity; }
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const { return size_ == kCapacity; }

  constexpr void push_back(const T& value) {
    ARMSIG_CHECK(size_ < kCapacity);
    items_[size_++] = value;
  }
  constexpr void resize(std::size_t count, const T& value = T{}) {
    ARMSIG_CHECK(count <= kCapacity);
    for (std::size_t i = size_; i < count; ++i) items_[i] = value;
    size_ = count;
  }
  constexpr void clear() { size_ = 0; }

  [[nodiscard]] constexpr T& operator[](std::size_t i) {
    ARMSIG_CHECK(i < size_);
    return items_[i];
  }
  [[nodiscard]] constexpr const T& operator[](std::size_t i) const {
    ARMSIG_CHECK(i < size_);
    return items_[i];
  }
  [[nodiscard]] constexpr T& back() { return (*this)[size_ - 1]; }
  [[nodiscard]] constexpr const T& back() const { return (*this)[size_ - 1]; }

  [[nodiscard]] constexpr T* data() { return items_.data(); }
  [[nodiscard]] constexpr const T* data() const { return items_.data(); }
  [[nodiscard]] constexpr T* begin() { return items_.data(); }
  [[nodiscard]] constexpr T* end() { return items_.data() + size_; }
  [[nodiscard]] constexpr const T* begin() const { return items_.data(); }
  [[nodiscard]] constexpr const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t size_ = 0;
};

}  // namespace armsig
