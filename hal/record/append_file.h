// SPDX-License-Identifier: Apache-2.0
// A file that only grows, by whole records: a record that cannot be written whole leaves nothing behind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace sextant {

class AppendFile {
 public:
  /// Creates the file; it must not exist. Throws InputError(file).
  explicit AppendFile(std::filesystem::path file);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Throws DeviceError(file) where the record could not be written (disk full); the file ends with the
  /// record before it.
  void append(const std::string& record);
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace sextant
