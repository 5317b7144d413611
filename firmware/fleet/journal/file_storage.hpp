// SPDX-License-Identifier: MIT
// A storage in one file, which this process alone may write.
#pragma once

#include <string>

#include "firmware/fleet/journal/storage.hpp"

namespace armsig::fleet {

class FileStorage final : public Storage {
 public:
  // Makes the file, readable by its owner and group, where there is none; `bytes` of the disk are
  // taken at once, so that a disk that fills up later is no concern of its. Errors: kStorageFull,
  // kStorageFault (also where another process has it).
  [[nodiscard]] static Result<FileStorage> open(const std::string& path, std::uint64_t bytes);

  FileStorage(FileStorage&& other) noexcept : file_(other.file_) { other.file_ = -1; }
  FileStorage& operator=(FileStorage&&) = delete;
  FileStorage(const FileStorage&) = delete;
  FileStorage& operator=(const FileStorage&) = delete;
  ~FileStorage();

 private:
  explicit FileStorage(int file) : file_(file) {}

  Result<void> do_read(std::uint64_t at, std::span<std::byte> bytes) override;
  Result<void> do_write(std::uint64_t at, std::span<const std::byte> bytes) override;
  Result<void> do_sync() override;

  int file_;
};

}  // namespace armsig::fleet
