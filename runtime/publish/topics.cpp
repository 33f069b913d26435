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

struct NamedKind {
  const char* name;
  TopicKind kind;
};
constexpr NamedKind kKinds[] = {{"detections", TopicKind::kDetections},
                                {"object_pose", TopicKind::kObjectPose},
                                {"pose_estimates", TopicKind::kPoseEstimates},
                                {"tf", TopicKind::kTf},
                                {"markers", TopicKind::kMarkers},
                                {"image_raw", TopicKind::kAnnotated},
                                {"table_estimate", TopicKind::kTableEstimate},
                                {"diagnostics", TopicKind::kDiagnostics},
                                {"command", TopicKind::kCommand},
                                {"command_answer", TopicKind::kCommandAnswer}};

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

bool is_topic_path(const std::string& name) {
  return is_topic_name(!name.empty() && name.front() == '/' ? name.substr(1) : name);
}

std::string dds_topic_name(const std::string& name_space, const std::string& name) {
  const bool absolute = !name.empty() && name.front() == '/';
  const std::string full = absolute ? name.substr(1) : name_space.empty() ? name : name_space + "/" + name;
  if (!is_topic_name(full)) {
    throw UsageError(fmt::format("'{}' is not a topic name", full),
                     "use letters, digits and underscores, tokens separated by '/', at most one leading '/'");
  }
  return "rt/" + full;
}

std::vector<std::string> topic_kind_names() {
  std::vector<std::string> names;
  for (const NamedKind& named : kKinds) names.emplace_back(named.name);
  return names;
}

TopicKind topic_kind_of(const std::string& name) {
  const std::string last = name.substr(name.find_last_of('/') + 1);
  for (const NamedKind& named : kKinds) {
    if (last == named.name) return named.kind;
  }
  throw UsageError(
      fmt::format("cannot tell what the topic '{}' carries", name),
      fmt::format("its last token must be one of {}, or give --type", fmt::join(topic_kind_names(), ", ")));
}

}  // namespace sextant
