// SPDX-License-Identifier: Apache-2.0
// Model files on disk: mapped for reading, replaced atomically for writing.
#include "runtime/model/model_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "runtime/base/error.h"

namespace sextant {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  /// Closes and says whether that went well: late errors of writing appear here.
  bool close() {
    const int number = number_;
    number_ = -1;
    return ::close(number) == 0;
  }

 private:
  int number_;
};

/// A whole file, mapped read-only.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file) {
    // Non-blocking: opening a pipe must not wait for a writer.
    const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (descriptor.number() < 0) {
      throw InputError(file.string(), std::strerror(errno), "give a model file that `sextant compile` made");
    }
    struct stat status {};
    if (::fstat(descriptor.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
      throw InputError(file.string(), "is not a file", "give a model file that `sextant compile` made");
    }
    if (status.st_size <= 0 || static_cast<std::uint64_t>(status.st_size) > kMaxModelFileBytes) {
      throw InputError(file.string(),
                       "has " + std::to_string(status.st_size) + " bytes, which is no size of a model file",
                       "give a model file that `sextant compile` made");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    address_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor.number(), 0);
    if (address_ == MAP_FAILED) throw InputError(file.string(), "cannot be mapped", std::strerror(errno));
  }
  ~MappedFile() { ::munmap(address_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(address_), size_}; }

 private:
  void* address_ = nullptr;
  std::size_t size_ = 0;
};

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

ObjectModel read_model(const std::filesystem::path& file) { return read_model_file(file).model; }

ModelFileContent read_model_file(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  return {decode_model(mapped.bytes(), file.string()), model_hash(mapped.bytes()), mapped.bytes().size()};
}

void write_model(const ObjectModel& model, const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = encode_model(model);
  // One temporary name per process: a stale one of a process that died is overwritten.
  const std::string temporary = file.string() + ".tmp-" + std::to_string(::getpid());
  const auto fail = [&](const std::string& what) {
    const std::string reason = std::strerror(errno);
    ::unlink(temporary.c_str());
    throw InputError(file.string(), what + ": " + reason, "choose a place with room that you may write to");
  };
  Descriptor descriptor(
      ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (descriptor.number() < 0) fail("cannot be written");
  if (!write_all(descriptor.number(), bytes) || ::fsync(descriptor.number()) != 0 || !descriptor.close()) {
    fail("cannot be written");
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) fail("cannot be replaced");
}

}  // namespace sextant
