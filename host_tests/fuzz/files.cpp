// SPDX-License-Identifier: MIT
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {

File::File(std::string_view text) : descriptor_(::memfd_create("armsig-fuzz", 0)) {
  FUZZ_CHECK(descriptor_ >= 0);
  for (std::string_view left = text; !left.empty();) {
    const ssize_t written = ::write(descriptor_, left.data(), left.size());
    FUZZ_CHECK(written > 0);
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  path_ = "/proc/self/fd/" + std::to_string(descriptor_);
}

File::~File() { (void)::close(descriptor_); }

Scratch::Scratch() {
  std::array<char, 32> name{"/dev/shm/armsig-fuzz-XXXXXX"};
  FUZZ_CHECK(::mkdtemp(name.data()) != nullptr);
  folder_ = name.data();
  path_ = folder_ + "/file";
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string Scratch::content() const {
  std::ifstream file(path_, std::ios::binary);
  FUZZ_CHECK(file.good());
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace armsig::fuzz
