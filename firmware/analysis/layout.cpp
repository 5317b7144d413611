// SPDX-License-Identifier: MIT
#include "firmware/analysis/layout.hpp"

namespace armsig {

std::span<const TypeLayout> library_layout() { return kLayout; }

}  // namespace armsig
