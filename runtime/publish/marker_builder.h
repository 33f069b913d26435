// SPDX-License-Identifier: Apache-2.0
// The poses as pictures for RViz and Foxglove: each object's mesh or box coloured by confidence, its axes,
// its name and score.
#pragma once

#include <string>
#include <vector>

#include "runtime/publish/message_types.h"
#include "runtime/publish/object_shape.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// How objects are drawn.
struct MarkerStyle {
  bool mesh = true;       ///< the model's mesh; else (and where there is none) its box
  double lifetime_s = 1;  ///< then a viewer forgets them, also when we are gone
  double axis_length_m = 0.05;
};

/// Red 0 over yellow 0.5 to green 1.
std_msgs_msg_dds__ColorRGBA_ confidence_colour(double score, float alpha);

/// One message that replaces all markers of the frame before it: first a DELETEALL, then three markers for
/// each pose, in the namespaces "shape", "axes" and "text". Points into the result and the shapes.
class MarkersBuilder {
 public:
  MarkersBuilder(const FrameResult& result, const ObjectShapes& shapes, const MarkerStyle& style);
  const MarkerArrayMessage& message() const { return message_; }

 private:
  MarkerMessage start(const FrameResult& result, const char* name_space, int type) const;
  void add_shape(const FrameResult& result, const PoseEstimate& estimate, const ObjectShape* shape,
                 bool mesh);
  void add_axes(const FrameResult& result, const PoseEstimate& estimate, double length_m);
  void add_text(const FrameResult& result, const PoseEstimate& estimate, const ObjectShape* shape);

  std::string empty_;
  double lifetime_s_;
  int next_id_ = 0;
  std::vector<std::string> texts_;
  std::vector<std::vector<geometry_msgs_msg_dds__Point_>> points_;
  std::vector<std_msgs_msg_dds__ColorRGBA_> axis_colours_;
  std::vector<MarkerMessage> markers_;
  MarkerArrayMessage message_{};
};

}  // namespace sextant
