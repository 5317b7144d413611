// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/resident_memory.hpp"

#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace armsig::fleet {
namespace {

// Every segment of the program and its libraries that nobody may write is as its file is: a page
// that is read again is the same page.
int let_go_of(dl_phdr_info* object, std::size_t /*size*/, void* /*none*/) {
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  for (unsigned i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_W) != 0) continue;
    const std::uintptr_t begin = (object->dlpi_addr + segment.p_vaddr) / page * page;
    const std::uintptr_t end = object->dlpi_addr + segment.p_vaddr + segment.p_memsz;
    (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
  }
  return 0;
}

}  // namespace

void let_go_of_start() {
  (void)::malloc_trim(0);
  ::dl_iterate_phdr(let_go_of, nullptr);
}

}  // namespace armsig::fleet
