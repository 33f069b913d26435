// SPDX-License-Identifier: Apache-2.0
// The tree of frames that tf and tf_static describe, as far as we need it: where one frame was in another at
// a time, with a limit on how old the answer may be.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <tl/expected.hpp>

#include "runtime/frame/capture_time.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// parent_from_child at a time.
struct StampedTransform {
  std::string parent, child;
  CaptureTime at;
  RigidTransform parent_from_child = RigidTransform::Identity();
};

/// Bounded: at most 1000 frames, 10 s and 1000 transforms of each. Not thread-safe.
class TfBuffer {
 public:
  /// A transform of tf (is_static false) or tf_static. False: refused (no rigid motion, the frame in itself,
  /// a child with another parent is given that one, too many frames).
  bool add(const StampedTransform& transform, bool is_static);

  /// target_from_source at that time: interpolated between the transforms around it; where the newest is
  /// older, that one, if it is at most max_age old. The reason where there is no answer.
  tl::expected<RigidTransform, std::string> lookup(const std::string& target, const std::string& source,
                                                   CaptureTime at, std::chrono::milliseconds max_age) const;

 private:
  struct Node {
    std::string parent;
    bool is_static = false;
    std::deque<std::pair<CaptureTime, RigidTransform>> history;  ///< ascending times
  };
  tl::expected<RigidTransform, std::string> at_time(const std::string& child, const Node& node,
                                                    CaptureTime at, std::chrono::milliseconds max_age) const;

  std::map<std::string, Node> nodes_;  ///< by child
};

}  // namespace sextant
