// SPDX-License-Identifier: MIT
// The commit of a signature: a change of what the store holds, a bounded step at a time, until the
// servo goes by what is stored.
#pragma once

#include <optional>

#include "firmware/controller/custody.hpp"
#include "firmware/controller/identification_sequence.hpp"
#include "firmware/controller/mover.hpp"

namespace armsig::controller {

class Commit {
 public:
  // All must outlive it. The servo begins with the model of what `custody` holds now.
  Commit(const Configuration& configuration, Custody& custody,
         IdentificationSequence& identification, Mover& mover, Link& link);

  // The candidate becomes the active signature, of the machine that it was measured on.
  // Errors: kNoCandidate, kCandidateNoBetter, kAddressOutOfRange (the memory is too small),
  // kDrivesNotReady (the machine is not known). Precondition: not is_running().
  // `confirmed`: by a second person; of a candidate from outside that was not compared.
  Result<void> begin_accept(bool confirmed = false);
  // The signature before becomes active, or the drawing. Errors as SignatureStore::begin_rollback.
  // Precondition: not is_running().
  Result<void> begin_rollback();
  [[nodiscard]] bool is_running() const { return stage_ != Stage::kResting; }

  // One erase, one page, or a look at the servo. What became of the change, once: in the step in
  // which it is over. Errors: those of the memory, and why what is stored is not in use.
  [[nodiscard]] std::optional<Result<void>> step();

 private:
  enum class Stage : std::uint8_t { kResting, kWriting, kAdopting };

  void write();
  void adopt();
  void make_model_in_use(Model& model) const;

  const Configuration& configuration_;
  Custody& custody_;
  IdentificationSequence& identification_;
  Mover& mover_;
  Link& link_;
  Stage stage_ = Stage::kResting;
  bool asked_for_ = false;  // by an operator
  bool accepts_ = false;    // the candidate is what is stored
  Result<void> written_;
  std::size_t model_ = 0;  // to be adopted
  Ticket ticket_ = 0;      // of the command to adopt it
};

}  // namespace armsig::controller
