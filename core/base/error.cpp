// SPDX-License-Identifier: MIT
#include "core/base/error.hpp"

namespace armsig {

std::string_view describe(Error error) {
  switch (error) {
#define ARMSIG_ERROR(code, words) \
  case Error::code:               \
    return words;
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
  }
  return "unknown error";
}

}  // namespace armsig
