// SPDX-License-Identifier: MIT
// All mutants are compiled into one program; the environment chooses the one that lives:
// ARMSIG_MUTANT=NUMBER. With ARMSIG_MUTANTS_REACHED=FILE the numbers of those that were passed are
// added to FILE when the program ends. Included by mutated sources only (toolchain/mutate).
#pragma once

// What the compiler would say of mutants is so: they are wrong on purpose.
#pragma clang diagnostic ignored "-Weverything"

#include <stdio.h>
#include <stdlib.h>

namespace armsig::mutants {

inline constexpr int kCapacity = 65536;
inline unsigned char reached[kCapacity] = {};

inline void write_reached() {
  FILE* file = fopen(getenv("ARMSIG_MUTANTS_REACHED"), "a");
  if (file == nullptr) return;
  for (int i = 0; i < kCapacity; ++i) {
    if (reached[i] != 0) fprintf(file, "%d\n", i);
  }
  fclose(file);
}

inline int chosen() {
  if (getenv("ARMSIG_MUTANTS_REACHED") != nullptr) atexit(write_reached);
  const char* number = getenv("ARMSIG_MUTANT");
  return number == nullptr ? -1 : atoi(number);
}

inline const int living = chosen();

}  // namespace armsig::mutants

inline bool armsig_mutant(int number) {
  armsig::mutants::reached[number] = 1;
  return armsig::mutants::living == number;
}

// The place beside.
template <typename Index>
Index armsig_other_index(int number, Index index) {
  if (!armsig_mutant(number)) return index;
  return index > 0 ? index - 1 : index + 1;
}
