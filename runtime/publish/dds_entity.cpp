// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_entity.h"

#include <fmt/format.h>

#include "runtime/base/error.h"
#include "runtime/publish/topics.h"

namespace sextant {

dds_return_t check_dds(dds_return_t code, const std::string& doing, const std::string& advice) {
  if (code >= 0) return code;
  throw DeviceError(
      "DDS", fmt::format("{}: {}", doing, dds_strretcode(code)),
      code == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY
          ? "this identity's permissions do not allow it (roles: config/security/make-identities)"
          : advice);
}

DdsEntity create_participant(unsigned domain) {
  check_domain(domain);
  return {
      dds_create_participant(domain, nullptr, nullptr), fmt::format("cannot join domain {}", domain),
      "check the network and the file or text in CYCLONEDDS_URI (config/cyclonedds.xml is for one machine)"};
}

}  // namespace sextant
