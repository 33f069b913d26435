// SPDX-License-Identifier: Apache-2.0
// Where the table is, for every frame of a live source: as the source says, as configured, from DDS, or
// estimated from the depth image and filtered over time.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/frame/table_estimate.h"
#include "runtime/frame/table_filter.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Where the table is known from.
enum class TableOrigin : std::uint8_t {
  kFrame,     ///< the source says so with each frame (scene_table.json, a recording)
  kFixed,     ///< configured
  kDds,       ///< the camera's pose in a gravity-aligned frame, from tf or a PoseStamped
  kEstimate,  ///< the depth image
};

struct TableLocatorOptions {
  TableOrigin origin = TableOrigin::kEstimate;
  TableGeometry fixed;            ///< of kFixed
  double height_deviation_m = 0;  ///< of kFixed and kDds: how well the camera's height is known
  double tilt_deviation_rad = 0;  ///< and the direction of gravity
  // kDds
  unsigned domain = 0;
  std::string pose_topic;                  ///< PoseStamped of the camera's optical frame; empty: tf
  std::string world_frame = "base_link";   ///< z up; the pose topic's own frame_id where that is used
  double table_height_m = 0;               ///< of the table's surface in the world frame
  std::chrono::milliseconds max_age{200};  ///< of a transform, against the frame's capture
  // kEstimate
  TableEstimateOptions estimate;
  /// Gravity for the estimate: none, `fixed`'s direction, or that of kDds.
  enum class Prior : std::uint8_t { kNone, kFixed, kDds } prior = Prior::kNone;
  bool filter = true;  ///< average over time; off: every frame for itself
  TableFilterOptions filtering;
};

/// One thread.
class TableLocator {
 public:
  /// Throws UsageError / DeviceError where DDS cannot start.
  explicit TableLocator(const TableLocatorOptions& options);
  ~TableLocator();
  TableLocator(const TableLocator&) = delete;
  TableLocator& operator=(const TableLocator&) = delete;

  /// Fills table and table_uncertainty of the frame. Throws InputError where there is no table, with the
  /// reason and what to do: a frame is never searched against a table that is a guess.
  void locate(RgbdFrame& frame);
  /// The estimate of the last frame, before the filter.
  const std::optional<TableEstimate>& last_estimate() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The table from the camera's pose in a frame whose z points up. Nothing where the camera is not above it.
std::optional<TableGeometry> table_below(const RigidTransform& world_from_camera, double table_height_m);

}  // namespace sextant
