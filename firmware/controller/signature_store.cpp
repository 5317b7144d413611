// SPDX-License-Identifier: MIT
#include "firmware/controller/signature_store.hpp"

namespace armsig::controller {

Result<void> SignatureStore::load(const Arm& drawing, SignatureRecord& record) {
  if (auto opened = records_.open(); !opened) return opened;
  if (!records_.active()) return std::unexpected(Error::kNoSignature);
#ifndef ARMSIG_SMALL_IMAGE
  record.persons = records_.read_persons();
#endif
  return decode(records_.last_read(), drawing, record);
}

}  // namespace armsig::controller
