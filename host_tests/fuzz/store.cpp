// SPDX-License-Identifier: MIT
// The store of signatures on an emulated flash that tears, wears and rots as the bytes say, and on
// one whose content is the bytes.
#include <array>

#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/simulated/flash.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using controller::SignatureRecord;
using controller::SignatureStore;
using simulated::Flash;
using simulated::Tearing;

// What a record of this history is told by.
constexpr std::uint8_t kNone = 0;

SignatureRecord record_of(std::uint8_t id) {
  SignatureRecord record;
  const KnownTarget target{1, 6, Vector3(0.1, 0.2, 0.3)};
  record.signature = signature_of(tool::table2_robot(1), JointVector{0, -1, 1, 0.5, 0.2, 0},
                                  Pose{rotation_x(0.3), Vector3(1, 2, 3)}, {&target, 1});
  record.air_celsius = id;
  return record;
}

const Arm& drawing() {
  static const Arm arm = tool::puma560();
  return arm;
}

// What is active, or nothing where the store can't tell.
std::optional<std::uint8_t> active_in(Flash& flash) {
  SignatureStore store(flash);
  SignatureRecord record;
  const auto loaded = store.load(drawing(), record);
  if (loaded) return static_cast<std::uint8_t>(record.air_celsius);
  if (loaded.error() == Error::kNoSignature) return kNone;
  return std::nullopt;
}

struct History {
  Flash flash;
  std::uint8_t active = kNone;
  std::uint8_t former = kNone;
  std::uint8_t next = 1;
};

// One change; with the power cut in it, what was before or what is after is allowed.
void change(History& history, Tape& tape) {
  const std::uint8_t kind = tape.byte();
  const bool rolls_back = kind % 4 == 0;
  if (kind >= 128) {
    history.flash.cut_power_after(tape.word() % 3000U,
                                  static_cast<Tearing>(tape.below(simulated::kTearings)));
  }
  SignatureStore store(history.flash);
  SignatureRecord record;
  const auto loaded = store.load(drawing(), record);
  Result<bool> done = false;
  const std::uint8_t wanted = rolls_back ? history.former : history.next;
  if (!loaded && loaded.error() != Error::kNoSignature) {
    done = std::unexpected(loaded.error());
  } else if (rolls_back) {
    if (const auto begun = store.begin_rollback(); !begun) done = std::unexpected(begun.error());
  } else {
    store.begin_write(record_of(history.next));
  }
  for (int steps = 0; done && !*done; ++steps) {
    FUZZ_CHECK(steps < 1000);
    done = store.step();
  }
  history.flash.power_up();
  const auto found = active_in(history.flash);
  FUZZ_CHECK(found);  // torn, not rotten: it can always tell
  FUZZ_CHECK(active_in(history.flash) == found);
  if (done) FUZZ_CHECK(*found == wanted);
  FUZZ_CHECK(*found == history.active || *found == wanted);
  // With equal names there is nothing to be told apart.
  if (*found == wanted && wanted != history.active) {
    history.former = rolls_back ? kNone : history.active;
    history.active = *found;
  }
  if (!rolls_back) history.next = static_cast<std::uint8_t>(history.next % 200 + 1);
}

void fuzz_store(Bytes bytes) {
  Tape tape(bytes);
  History history{.flash = Flash({.seed = 1U + tape.byte()})};
  for (int changes = 0; !tape.empty() && changes < 12; ++changes) change(history, tape);
}

// A memory that somebody else wrote, or that rots: words, a record that is whole, or nothing.
class Given final : public hal::NonvolatileMemory {
 public:
  explicit Given(Tape& tape) {
    bytes_.fill(hal::kErasedByte);
    SignatureStore store(*this);
    SignatureRecord record;
    (void)store.load(drawing(), record);
    store.begin_write(record_of(1));
    for (Result<bool> done = false; done && !*done;) done = store.step();
    while (!tape.empty()) {
      const std::size_t at = (tape.byte() * 256U + tape.byte()) % bytes_.size();
      const Bytes over = tape.take(1U + tape.below(32));
      std::copy_n(over.begin(), std::min(over.size(), bytes_.size() - at),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }

 private:
  static constexpr hal::MemoryLayout kLayout{
      .page_bytes = 256, .pages_per_sector = 8, .sectors = 10};

  [[nodiscard]] hal::MemoryLayout do_layout() const override { return kLayout; }
  Result<void> do_read(std::size_t address, std::span<std::uint8_t> into) override {
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(address), into.size(), into.begin());
    return {};
  }
  Result<void> do_erase_sector(std::size_t sector) override {
    std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(sector * kLayout.sector_bytes()),
                kLayout.sector_bytes(), hal::kErasedByte);
    return {};
  }
  Result<void> do_program_page(std::size_t address, std::span<const std::uint8_t> page) override {
    std::ranges::copy(page, bytes_.begin() + static_cast<std::ptrdiff_t>(address));
    return {};
  }

  std::array<std::uint8_t, kLayout.bytes()> bytes_{};
};

void fuzz_stored(Bytes bytes) {
  Tape tape(bytes);
  Given memory(tape);
  SignatureStore store(memory);
  SignatureRecord record;
  const auto loaded = store.load(drawing(), record);
  if (loaded) {
    FUZZ_CHECK(record.signature.joint_count() == 6);
    for (const double reading : record.signature.configuration) FUZZ_CHECK(std::isfinite(reading));
  }
  if (loaded || loaded.error() == Error::kNoSignature) {
    store.begin_write(record_of(2));
    Result<bool> done = false;
    for (int steps = 0; done && !*done; ++steps) {
      FUZZ_CHECK(steps < 1000);
      done = store.step();
    }
    FUZZ_CHECK(done);
  }
}

constexpr std::array kTargets{Target{"store", fuzz_store}, Target{"stored", fuzz_stored}};

}  // namespace

std::span<const Target> store_targets() { return kTargets; }

}  // namespace armsig::fuzz
