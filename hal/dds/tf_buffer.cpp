// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/tf_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace sextant {
namespace {

constexpr std::size_t kMostFrames = 1000;
constexpr std::size_t kMostTransforms = 1000;
constexpr std::chrono::seconds kHistory{10};
constexpr double kFarthest = 1e6;  ///< metres

RigidTransform between(const std::pair<CaptureTime, RigidTransform>& a,
                       const std::pair<CaptureTime, RigidTransform>& b, CaptureTime at) {
  const double share =
      std::chrono::duration<double>(at - a.first) / std::chrono::duration<double>(b.first - a.first);
  RigidTransform t = RigidTransform::Identity();
  const Eigen::Quaterniond qa(a.second.linear());
  const Eigen::Quaterniond qb(b.second.linear());
  t.linear() = qa.slerp(share, qb).toRotationMatrix();
  t.translation() = (1 - share) * a.second.translation() + share * b.second.translation();
  return t;
}

bool is_rigid(const RigidTransform& t) {
  const Eigen::Matrix3d r = t.linear();
  return t.matrix().allFinite() && t.translation().norm() < kFarthest &&
         (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
         r.determinant() > 0;
}

}  // namespace

bool TfBuffer::add(const StampedTransform& t, bool is_static) {
  if (t.child.empty() || t.parent.empty() || t.child == t.parent || !is_rigid(t.parent_from_child))
    return false;
  const auto found = nodes_.find(t.child);
  if (found == nodes_.end() && nodes_.size() >= kMostFrames) return false;
  Node& node = nodes_[t.child];
  if (node.parent != t.parent || node.is_static != is_static) {
    node = Node{t.parent, is_static, {}};
  }
  if (is_static) {
    node.history = {{t.at, t.parent_from_child}};
    return true;
  }
  // A clock that was set back: what was known is of another time.
  if (!node.history.empty() && t.at + kHistory < node.history.back().first) node.history.clear();
  const auto place = std::lower_bound(node.history.begin(), node.history.end(), t.at,
                                      [](const auto& entry, CaptureTime at) { return entry.first < at; });
  if (place != node.history.end() && place->first == t.at) {
    place->second = t.parent_from_child;
  } else {
    node.history.insert(place, {t.at, t.parent_from_child});
  }
  while (node.history.size() > kMostTransforms ||
         node.history.front().first + kHistory < node.history.back().first) {
    node.history.pop_front();
  }
  return true;
}

tl::expected<RigidTransform, std::string> TfBuffer::at_time(const std::string& child, const Node& node,
                                                            CaptureTime at,
                                                            std::chrono::milliseconds max_age) const {
  const auto& history = node.history;
  if (node.is_static) return history.front().second;
  const auto after = std::lower_bound(history.begin(), history.end(), at,
                                      [](const auto& entry, CaptureTime t) { return entry.first < t; });
  if (after != history.end() && after->first == at) return after->second;
  if (after == history.end()) {
    const auto age = at - history.back().first;
    if (age > max_age) {
      return tl::make_unexpected(fmt::format("the transform of {} is {:.1f} s old", child,
                                             std::chrono::duration<double>(age).count()));
    }
    return history.back().second;
  }
  if (after == history.begin()) {
    return tl::make_unexpected(fmt::format("the transform of {} is known only for later times", child));
  }
  return between(*(after - 1), *after, at);
}

tl::expected<RigidTransform, std::string> TfBuffer::lookup(const std::string& target,
                                                           const std::string& source, CaptureTime at,
                                                           std::chrono::milliseconds max_age) const {
  // Ancestors of a frame, itself first.
  const auto chain = [&](const std::string& frame) {
    std::vector<std::string> up{frame};
    for (auto node = nodes_.find(frame); node != nodes_.end() && up.size() <= kMostFrames;
         node = nodes_.find(up.back())) {
      up.push_back(node->second.parent);
    }
    return up;
  };
  const std::vector<std::string> from = chain(source);
  const std::vector<std::string> to = chain(target);
  const auto shared = std::find_if(from.begin(), from.end(), [&](const std::string& frame) {
    return std::find(to.begin(), to.end(), frame) != to.end();
  });
  if (shared == from.end()) {
    return tl::make_unexpected(fmt::format("no transform connects {} and {}", source, target));
  }
  const auto up_to_shared =
      [&](const std::vector<std::string>& frames) -> tl::expected<RigidTransform, std::string> {
    RigidTransform shared_from_frame = RigidTransform::Identity();
    for (const std::string& frame : frames) {
      if (frame == *shared) break;
      const auto step = at_time(frame, nodes_.at(frame), at, max_age);
      if (!step) return step;
      shared_from_frame = *step * shared_from_frame;
    }
    return shared_from_frame;
  };
  const auto shared_from_source = up_to_shared(from);
  if (!shared_from_source) return shared_from_source;
  const auto shared_from_target = up_to_shared(to);
  if (!shared_from_target) return shared_from_target;
  return shared_from_target->inverse() * *shared_from_source;
}

}  // namespace sextant
