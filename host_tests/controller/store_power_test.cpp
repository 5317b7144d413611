// SPDX-License-Identifier: MIT
// The store on flash that tears: all short histories of it, torn at every byte of every operation
// in every way that the emulated flash knows. What is found after the restart is what was there
// before the operation or what is there after it, it stays so, and an `ok` was no lie.
#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "firmware/controller/record_store.hpp"
#include "hal/simulated/flash.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

using simulated::Flash;
using simulated::Tearing;

constexpr int kStranger = -1;  // neither of those that were stored, or a mixture
constexpr int kHidden = -2;    // the store does not open

// Of which record, 0: none, is active, and which one was before it.
struct State {
  int active = 0;
  int former = 0;
  friend bool operator==(const State&, const State&) = default;
};

enum class Kind : std::uint8_t { kAccept, kRollback };
struct Operation {
  Kind kind = Kind::kAccept;
  int id = 0;  // of the record accepted
};

State after(const State& state, const Operation& operation) {
  if (operation.kind == Kind::kAccept) return {.active = operation.id, .former = state.active};
  return {.active = state.former, .former = 0};
}

RecordImage image_of(int id) {
  RecordImage image{};
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = static_cast<std::uint8_t>(29 * i + 113 * static_cast<std::size_t>(id));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    image[8 + i] = static_cast<std::uint8_t>(kRecordBytes >> (8 * i));
  }
  const auto content = std::as_bytes(std::span(image).first(kRecordBytes - 4));
  const std::uint32_t crc = crc32(content);
  for (std::size_t i = 0; i < 4; ++i) {
    image[kRecordBytes - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
  return image;
}

constexpr int kIds = 10;
const std::array<RecordImage, kIds> kRecords = [] {
  std::array<RecordImage, kIds> records{};
  for (int id = 0; id < kIds; ++id) records[static_cast<std::size_t>(id)] = image_of(id);
  return records;
}();

int id_of(const RecordImage& image) {
  for (int id = 1; id < kIds; ++id) {
    if (image == kRecords[static_cast<std::size_t>(id)]) return id;
  }
  return kStranger;
}

State state_of(Flash& flash) {
  RecordStore store(flash);
  if (!store.open()) return {.active = kHidden, .former = kHidden};
  State state;
  if (store.active()) state.active = id_of(store.last_read());
  if (store.former()) {
    state.former = store.read(*store.former()) ? id_of(store.last_read()) : kStranger;
  }
  return state;
}

// True if the store said that it is done.
bool perform(RecordStore& store, const Operation& operation) {
  if (operation.kind == Kind::kRollback) {
    if (!store.begin_rollback()) return false;
  } else {
    store.begin_write() = kRecords[static_cast<std::size_t>(operation.id)];
  }
  for (Result<bool> done = false;;) {
    done = store.step();
    if (!done || *done) return done.has_value();
  }
}

// In a session of its own.
bool perform(Flash& flash, const Operation& operation) {
  RecordStore store(flash);
  return store.open().has_value() && perform(store, operation);
}

struct Count {
  std::size_t cases = 0;
  std::size_t violations = 0;
  std::array<std::size_t, simulated::kTearings> of{};
};

// What may be found after a restart, and whether the operation was told to be done.
struct Claim {
  State before;
  State then;
  bool told = false;

  [[nodiscard]] bool allows(const State& found) const {
    return found == then || (found == before && !told);
  }
};

// What was found stays as it is over restarts, in either turn of unstable pages.
bool is_steady(Flash& flash, const State& found) {
  for (int restart = 0; restart < 2; ++restart) {
    flash.power_up();
    if (state_of(flash) != found) return false;
  }
  return true;
}

// It can be rolled back and stored again as if nothing had happened.
bool goes_on(Flash& flash, const State& found) {
  if (found.active != 0) {
    const Operation back{.kind = Kind::kRollback};
    if (!perform(flash, back) || state_of(flash) != after(found, back)) return false;
  }
  return perform(flash, {.id = kIds - 1}) && state_of(flash).active == kIds - 1;
}

void judge(Flash& torn, const Claim& claim, Tearing tearing, bool further, Count& count) {
  ++count.cases;
  torn.power_up();
  const State found = state_of(torn);
  if (claim.allows(found) && is_steady(torn, found) && (!further || goes_on(torn, found))) return;
  ++count.violations;
  ++count.of[static_cast<std::size_t>(tearing)];
}

// The repair after the restart is torn as well; nobody has been told anything by then.
void tear_again(const Flash& torn, const Claim& claim, Tearing tearing, Count& count) {
  Flash whole = torn;
  whole.power_up();
  const std::size_t before = whole.changed();
  (void)state_of(whole);
  const std::size_t all = whole.changed() - before;
  for (std::size_t cut = 1; cut < all; cut += all / 7 + 1) {
    Flash again = torn;
    again.power_up();
    again.cut_power_after(cut, tearing);
    (void)state_of(again);
    judge(again, claim, tearing, false, count);
  }
}

// Pages torn as a whole differ only by which pages are done.
std::size_t step_of(Tearing tearing) {
  return tearing == Tearing::kForward || tearing == Tearing::kBackward ||
                 tearing == Tearing::kAnyOrder || tearing == Tearing::kPartialBits
             ? 1
             : 16;
}

// `operation` in `flash`, torn at every byte.
void tear(const Flash& flash, const State& before, const Operation& operation, Count& count) {
  Flash whole = flash;
  ASSERT_TRUE(RecordStore{whole}.open());
  const std::size_t began = flash.changed();
  ASSERT_TRUE(perform(whole, operation));
  const State then = after(before, operation);
  ASSERT_EQ(state_of(whole), then);
  const std::size_t all = whole.changed() - began;
  for (std::size_t kind = 0; kind < simulated::kTearings; ++kind) {
    const auto tearing = static_cast<Tearing>(kind);
    for (std::size_t cut = 0; cut <= all; cut += step_of(tearing)) {
      Flash torn = flash;
      torn.cut_power_after(cut, tearing);
      const bool told = perform(torn, operation);
      const Claim claim{.before = before, .then = then, .told = told};
      if (cut % 64 == 0) tear_again(torn, claim, tearing, count);
      judge(torn, claim, tearing, cut % 32 == 0, count);
    }
  }
}

constexpr unsigned kLongest = 5;

// Every history of accepts and roll backs up to the longest, restarts between all of them.
void tear_histories(Count& count) {
  for (unsigned length = 1; length <= kLongest; ++length) {
    for (unsigned history = 0; history < (1U << length); ++history) {
      Flash flash;
      State state;
      bool possible = true;
      for (unsigned i = 0; i < length && possible; ++i) {
        const Operation operation{
            .kind = (history >> i & 1U) != 0 ? Kind::kRollback : Kind::kAccept,
            .id = static_cast<int>(i) + 1};
        possible = operation.kind == Kind::kAccept || state.active != 0;
        if (!possible) break;
        if (i + 1 == length) {
          tear(flash, state, operation, count);
        } else {
          ASSERT_TRUE(perform(flash, operation));
          state = after(state, operation);
        }
      }
    }
  }
}

TEST(StorePower, has_the_old_or_the_new_state_wherever_and_however_an_operation_is_torn) {
  Count count;
  tear_histories(count);
  std::printf("%zu cases, %zu violations; by tearing", count.cases, count.violations);
  for (const std::size_t violations : count.of) std::printf(" %zu", violations);
  std::printf("\n");
  EXPECT_GT(count.cases, 500'000U);
  EXPECT_EQ(count.violations, 0U);
}

// Accept, accept, roll back, accept: in one session, each torn here and there.
TEST(StorePower, keeps_what_it_told_within_a_session_as_well) {
  const std::array<Operation, 4> operations{
      {{.id = 1}, {.id = 2}, {.kind = Kind::kRollback}, {.id = 3}}};
  Count count;
  for (std::size_t last = 0; last < operations.size(); ++last) {
    for (std::size_t cut = 0; cut < 6000; cut += 17) {
      const auto tearing = static_cast<Tearing>(cut % simulated::kTearings);
      Flash flash;
      RecordStore store(flash);
      ASSERT_TRUE(store.open());
      State state;
      for (std::size_t i = 0; i < last; ++i) {
        ASSERT_TRUE(perform(store, operations[i]));
        state = after(state, operations[i]);
      }
      flash.cut_power_after(cut, tearing);
      const bool told = perform(store, operations[last]);
      judge(flash, {.before = state, .then = after(state, operations[last]), .told = told}, tearing,
            true, count);
    }
  }
  EXPECT_GT(count.cases, 1000U);
  EXPECT_EQ(count.violations, 0U);
}

// Erases and programs that fail although the power stays: opened again, the store tells what is so.
TEST(StorePower, tells_after_a_failed_erase_or_program_what_is_stored) {
  constexpr std::size_t kOfAnAccept = 21;  // three erases, 16 pages of the record, two entries
  for (std::size_t failing = 0; failing <= kOfAnAccept; ++failing) {
    for (const std::size_t bytes : {0U, 1U, 31U, 100U, 256U}) {
      Flash flash;
      ASSERT_TRUE(perform(flash, {.id = 1}));
      ASSERT_TRUE(perform(flash, {.id = 2}));
      const State before{.active = 2, .former = 1};
      RecordStore store(flash);
      ASSERT_TRUE(store.open());
      flash.fail_after(failing, bytes);
      const bool told = perform(store, {.id = 3});
      const Claim claim{.before = before, .then = after(before, {.id = 3}), .told = told};
      const State found = state_of(flash);
      EXPECT_TRUE(claim.allows(found)) << failing << ' ' << bytes;
      EXPECT_EQ(told, failing == kOfAnAccept);
      EXPECT_TRUE(is_steady(flash, found)) << failing << ' ' << bytes;
      if (told) continue;  // and so the failure is still to come
      EXPECT_TRUE(goes_on(flash, found)) << failing << ' ' << bytes;
    }
  }
}

TEST(StorePower, refuses_to_store_on_worn_out_sectors_and_keeps_what_is_active) {
  Flash flash({.endurance = 4});
  State state;
  int stored = 0;
  for (int id = 1; id < kIds && stored == 0; ++id) {
    if (perform(flash, {.id = id})) {
      state = after(state, {.id = id});
    } else {
      stored = id - 1;
    }
  }
  for (int more = 0; stored == 0 && more < 20; ++more) {
    if (perform(flash, {.id = 1 + more % 2})) {
      state = after(state, {.id = 1 + more % 2});
    } else {
      stored = kIds;
    }
  }
  EXPECT_NE(stored, 0) << "it never wore out";
  EXPECT_EQ(state_of(flash), state);
}

// One unreadable page never hides both records, nor does a record that was rolled back come back.
TEST(StorePower, one_rotten_page_costs_at_most_the_record_that_it_is_of) {
  for (std::size_t page = 0; page < 80; ++page) {
    Flash flash;
    for (const Operation& operation :
         std::array<Operation, 4>{{{.id = 1}, {.id = 2}, {.id = 3}, {.kind = Kind::kRollback}}}) {
      ASSERT_TRUE(perform(flash, operation));
    }
    ASSERT_TRUE(perform(flash, {.id = 4}));  // before it 2
    flash.rot(256 * page);
    const State found = state_of(flash);
    EXPECT_TRUE(found.active == 4 || found.active == 2) << page << ": " << found.active;
  }
}

TEST(StorePower, a_store_of_another_layout_is_not_taken_for_an_empty_one) {
  Flash flash;
  std::array<std::uint8_t, 256> page{};
  page.fill('A');
  for (std::size_t i = 0; i < 4; ++i) ASSERT_TRUE(flash.program_page(256 * i, page));
  RecordStore store(flash);
  const auto opened = store.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(test::failure_of(opened), Error::kRecordCorrupt);
  EXPECT_TRUE(perform(store, {.id = 1})) << "what is stored next begins a new one";
  EXPECT_EQ(state_of(flash), (State{.active = 1, .former = 0}));
}

}  // namespace
}  // namespace armsig::controller
