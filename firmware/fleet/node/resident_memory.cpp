// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/resident_memory.hpp"

#include <malloc.h>
#include <sys/mman.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>

namespace armsig::fleet {

void let_go_of_start() {
  ::malloc_trim(0);
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> maps(std::fopen("/proc/self/maps", "re"));
  if (!maps) return;
  std::array<char, 512> line{};
  while (std::fgets(line.data(), line.size(), maps.get()) != nullptr) {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    std::array<char, 5> access{};
    std::array<char, 2> path{};
    // Code of a file: private, never written, so that a page read again is the same page.
    if (std::sscanf(line.data(), "%jx-%jx %4s %*s %*s %*s %1s", &begin, &end, access.data(),
                    path.data()) == 4 &&
        std::string_view(access.data()) == "r-xp" && path[0] == '/') {
      (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
    }
  }
}

}  // namespace armsig::fleet
