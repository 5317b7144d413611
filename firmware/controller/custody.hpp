// SPDX-License-Identifier: MIT
// Which signature is in use: the one that the store says is active, where it can be read and is of
// this machine; otherwise the drawing, which an operator has to acknowledge before the tool moves
// by it.
#pragma once

#include <optional>

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/machine.hpp"
#include "firmware/controller/signature_store.hpp"

namespace armsig::controller {

class Custody {
 public:
  Custody(const Arm& drawing, hal::NonvolatileMemory& memory) : drawing_(drawing), store_(memory) {
    load();
  }

  // What the store has now. It is not believed to be of another machine before that is known.
  void load();
  // The machine is `found`: a signature that is not of it is no longer in use.
  void compare(const Machine& found);

  // The signature servoed with; empty: the drawing.
  [[nodiscard]] const std::optional<SignatureRecord>& active() const { return active_; }
  // The same; null: the nominal model.
  [[nodiscard]] const SignatureRecord* in_use() const { return active_ ? &*active_ : nullptr; }
  // CRC-32 at the end of its record. Precondition: active().
  [[nodiscard]] std::uint32_t active_crc() const { return store_.active_crc(); }
  [[nodiscard]] const std::optional<Machine>& machine() const { return machine_; }
  // Why what is stored is not in use, or what is wrong with the store although it is.
  [[nodiscard]] std::optional<Error> trouble() const { return trouble_; }
  // What is told of it to the operator; nothing where there is no trouble.
  void tell_trouble(const Announcer& announcer) const;

  [[nodiscard]] bool needs_acknowledgement() const { return unused_ && !acknowledged_; }
  void acknowledge() { acknowledged_ = true; }

  // Changes of the store; one step is one erase or one page. Errors as in SignatureStore.
  [[nodiscard]] bool fits() const { return store_.fits(); }
  void begin_write(const SignatureRecord& record) { store_.begin_write(record); }
  [[nodiscard]] Result<void> begin_rollback() { return store_.begin_rollback(); }
  [[nodiscard]] Result<bool> step() { return store_.step(); }
  // Sectors that the signatures take, from the first on.
  [[nodiscard]] std::size_t sectors() const { return store_.sectors(); }

 private:
  void reject_other_machine();

  const Arm& drawing_;
  SignatureStore store_;
  std::optional<SignatureRecord> active_;
  std::optional<Machine> machine_;
  std::optional<MachineDifference> difference_;
  std::optional<Error> trouble_;
  bool unused_ = false;  // something is stored, and the drawing is servoed with
  bool acknowledged_ = false;
};

}  // namespace armsig::controller
