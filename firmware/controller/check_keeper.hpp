// SPDX-License-Identifier: MIT
// Keeps what checks have shown in a place that a program has, and tells when what is there is of no
// use:
//
//   # check history recalled learnt=12 of=20
//   # check history unused error=RECORD_CORRUPT reason="..."; the reference is learnt anew
#pragma once

#include "firmware/controller/check_memory.hpp"

namespace armsig::controller {

// What checks were of. What others have shown says nothing.
struct CheckSubject {
  std::uint32_t record_crc = 0;  // of the active signature, as it is stored
  std::uint32_t poses_crc = 0;   // of the readings of all poses of the plan

  friend bool operator==(const CheckSubject&, const CheckSubject&) = default;
};

enum class Recalled : std::uint8_t {
  kEverything,
  kNothing,         // nothing was kept
  kOtherSignature,  // what was kept is of another one
  kOtherPoses,      // of the same one, at other poses
};

class CheckKeeper : public CheckMemory {
 public:
  // Fills `state`, whose signature it is, where it returns kEverything; else leaves it. Errors:
  // kRecordCorrupt (what was kept is torn, of another version, or nothing that checks can show),
  // kStorageFault.
  [[nodiscard]] Result<Recalled> read(const CheckSubject& subject, CheckState& state) {
    return do_read(subject, state);
  }
  // In place of what was kept before, as a whole or not at all. Errors: kStorageFull,
  // kStorageFault.
  [[nodiscard]] Result<void> write(const CheckSubject& subject, const CheckState& state) {
    return do_write(subject, state);
  }

 protected:
  ~CheckKeeper() = default;

 private:
  // Here, for a program with RTTI: it needs what the compiler writes where the first one is
  // defined.
  void do_recall(const Context& context, CheckState& state) final { recall_as(context, state); }
  void do_keep(const Context& context, const CheckState& state) final { keep_as(context, state); }
  void recall_as(const Context& context, CheckState& state);
  void keep_as(const Context& context, const CheckState& state);
  virtual Result<Recalled> do_read(const CheckSubject& subject, CheckState& state) = 0;
  virtual Result<void> do_write(const CheckSubject& subject, const CheckState& state) = 0;
};

}  // namespace armsig::controller
