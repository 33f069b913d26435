// SPDX-License-Identifier: Apache-2.0
#include "hal/record/append_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "runtime/base/error.h"

namespace sextant {
namespace {

std::string last_error() { return std::generic_category().message(errno); }

}  // namespace

AppendFile::AppendFile(std::filesystem::path file) : file_(std::move(file)) {
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw InputError(file_.string(), "cannot be made (" + last_error() + ")");
}

AppendFile::~AppendFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AppendFile::append(const std::string& record) {
  std::size_t done = 0;
  while (done < record.size()) {
    const ssize_t n =
        ::pwrite(descriptor_, record.data() + done, record.size() - done, static_cast<off_t>(size_ + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const std::string reason = n < 0 ? last_error() : "nothing was written";
      if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) {
        throw DeviceError(file_.string(), "cannot be written and not be repaired (" + last_error() + ")");
      }
      throw DeviceError(file_.string(), "cannot be written (" + reason + ")", "make space on the disk");
    }
    done += static_cast<std::size_t>(n);
  }
  size_ += record.size();
}

}  // namespace sextant
