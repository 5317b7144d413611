// SPDX-License-Identifier: MIT
#include "core/layout.hpp"

namespace armsig {

std::span<const TypeLayout> library_layout() { return kLayout; }

}  // namespace armsig
