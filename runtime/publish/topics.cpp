// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/topics.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/base/error.h"

namespace sextant {

namespace {

constexpr unsigned kLargestDomain = 230;
constexpr std::size_t kLongestName = 200;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

void check_domain(unsigned domain) {
  if (domain > kLargestDomain) {
    throw UsageError(fmt::format("DDS domain {} does not exist", domain), "use 0..230");
  }
}

bool is_topic_name(const std::string& name) {
  if (name.size() > kLongestName) return false;
  bool at_start = true;
  for (const char c : name) {
    if (at_start ? !is_letter(c) : !(is_letter(c) || is_digit(c) || c == '/')) return false;
    at_start = c == '/';
  }
  return !at_start;  // neither empty nor ending with a slash
}

std::string dds_topic_name(const std::string& name_space, const std::string& name) {
  const std::string full = name_space.empty() ? name : name_space + "/" + name;
  if (!is_topic_name(full)) {
    throw UsageError(fmt::format("'{}' is not a topic name", full),
                     "use letters, digits and underscores, tokens separated by '/', no leading '/'");
  }
  return "rt/" + full;
}

TopicKind topic_kind_of(const std::string& name) {
  const std::string last = name.substr(name.find_last_of('/') + 1);
  if (last == "detections") return TopicKind::kDetections;
  if (last == "object_pose") return TopicKind::kObjectPose;
  if (last == "pose_estimates") return TopicKind::kPoseEstimates;
  throw UsageError(fmt::format("cannot tell what the topic '{}' carries", name),
                   "its last token must be detections, object_pose or pose_estimates, or give --type");
}

}  // namespace sextant
