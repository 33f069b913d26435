// SPDX-License-Identifier: Apache-2.0
#include "hal/image/file_bytes.h"

#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "runtime/base/error.h"

namespace sextant {

std::vector<std::byte> read_file_bytes(const std::filesystem::path& file, std::size_t max_bytes) {
  const std::string where = file.string();
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(where, "the file does not exist", "check the path");
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(where, "this is not a regular file", "give a file, no folder or device");
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw InputError(where, "cannot be read (" + error.message() + ")");
  if (size > max_bytes) {
    throw InputError(
        where, "has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(max_bytes));
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(where, "cannot be opened", "check its permissions");
  std::vector<std::byte> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) {
    throw InputError(where, "became shorter while it was read", "wait until it is written");
  }
  return bytes;
}

void write_file_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  std::filesystem::path temporary = file;
  temporary += ".part" + std::to_string(::getpid());
  std::error_code error;
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) {
      std::filesystem::remove(temporary, error);
      throw InputError(file.string(), "cannot be written", "check that its folder exists and has space");
    }
  }
  std::filesystem::rename(temporary, file, error);
  if (error) {
    const std::string reason = error.message();
    std::filesystem::remove(temporary, error);
    throw InputError(file.string(), "cannot be written (" + reason + ")");
  }
}

}  // namespace sextant
