// SPDX-License-Identifier: MIT
// Each error and verdict has words of its own.
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/error_name.hpp"
#include "core/calibration/refined.hpp"
#include "core/drift/check_drift.hpp"
#include "core/drift/course.hpp"
#include "core/drift/reference.hpp"

namespace armsig {
namespace {

// Of the enumerators from 0 to `last`; none may have the words of what is none of them.
template <typename Enum>
void expect_words_of_their_own(Enum last) {
  const auto count = static_cast<std::size_t>(last) + 1;
  std::set<std::string_view> words{describe(static_cast<Enum>(200))};
  for (std::size_t k = 0; k < count; ++k) {
    const std::string_view said = describe(static_cast<Enum>(k));
    EXPECT_FALSE(said.empty()) << k;
    EXPECT_TRUE(words.insert(said).second) << k << ": " << said;
  }
}

TEST(Words, of_each_error_are_its_own) {
  expect_words_of_their_own(static_cast<Error>(error_name_detail::kCount - 1));
}

TEST(Words, of_what_is_left_open_are_its_own) {
  expect_words_of_their_own(calibration::Open::kReceiverOffset);
}

TEST(Words, of_a_drift_are_its_own) {
  expect_words_of_their_own(drift::DriftVerdict::kSensorWorse);
  expect_words_of_their_own(drift::Course::kRamp);
  expect_words_of_their_own(drift::Moved::kUndecided);
}

TEST(Words, of_a_number_that_is_no_error_are_told_apart) {
  EXPECT_EQ(name(static_cast<Error>(200)), "ERROR");
  EXPECT_EQ(name(static_cast<Error>(error_name_detail::kCount)), "ERROR");
}

TEST(Words, for_programs_are_the_enumerators) {
  EXPECT_EQ(name(Error::kNotFinite), "NOT_FINITE");
  EXPECT_EQ(name(Error::kRecordUnsuitable), "RECORD_UNSUITABLE");
}

TEST(Words, for_programs_are_of_capitals_and_each_its_own) {
  std::set<std::string_view> names;
  for (std::size_t k = 0; k < error_name_detail::kCount; ++k) {
    const std::string_view said = name(static_cast<Error>(k));
    EXPECT_EQ(said.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"), said.npos) << said;
    EXPECT_TRUE(names.insert(said).second) << said;
  }
}

}  // namespace
}  // namespace armsig
