// SPDX-License-Identifier: MIT
// What can go wrong in the world: one enumeration for core, hal and the controller.
//
// Mistakes of ours are assertions (core/base/check.hpp); what a sensor, a drive, a file or a person
// can do to us is an Error inside a std::expected, and every function lists the ones it can return.
#pragma once

#include <cstdint>
#include <expected>
#include <string_view>
#include <utility>

namespace armsig {

enum class Error : std::uint8_t {
#define ARMSIG_ERROR(code, words) code,
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};

// Its words.
[[nodiscard]] std::string_view describe(Error error);

template <typename T>
using Result = std::expected<T, Error>;

// An error with the two numbers that a person needs to see: what was found, and what was needed (SI
// units; for kArcTooShort the arc and the least arc, for kRadiusTooSmall the radius and the least
// radius, ...).
struct Refusal {
  Error error = Error::kNotFinite;
  double found = 0;
  double needed = 0;
};

template <typename T>
using Judged = std::expected<T, Refusal>;

}  // namespace armsig

// NOLINTBEGIN(bugprone-macro-parentheses): `name` is declared, and can't be in parentheses
// ARMSIG_TRY(name, expression): binds `name` to the value of a Result, or returns its error from
// this function.
#define ARMSIG_TRY(name, expression)                                                \
  auto name##_or_error = (expression);                                              \
  if (!name##_or_error) return std::unexpected(std::move(name##_or_error).error()); \
  auto& name = *name##_or_error
// NOLINTEND(bugprone-macro-parentheses)
