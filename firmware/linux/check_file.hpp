// SPDX-License-Identifier: MIT
// What checks have shown, in a file beside the store: `STORE.checks`.
//
// Written anew under another name, brought to the device and then renamed: whenever the power goes,
// the old or the new stands there as a whole.
#pragma once

#include <string>
#include <string_view>

#include "firmware/controller/check_keeper.hpp"

namespace armsig::daemon {

class CheckFile final : public controller::CheckKeeper {
 public:
  explicit CheckFile(std::string_view store);

 private:
  Result<controller::Recalled> do_read(const controller::CheckSubject& subject,
                                       controller::CheckState& state) override;
  Result<void> do_write(const controller::CheckSubject& subject,
                        const controller::CheckState& state) override;

  // All made at the start: the controller runs without the heap.
  std::string path_;
  std::string unfinished_;
  std::string folder_;
};

}  // namespace armsig::daemon
