// SPDX-License-Identifier: Apache-2.0
#include "hal/table/table_locator.h"

#include <algorithm>
#include <cmath>

#include "hal/dds/tf_listener.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr char kPoseChild[] = "camera (pose topic)";

/// What two configured deviations mean for the plane, seen from the camera.
TableUncertainty uncertainty_of(const TableGeometry& table, double height_m, double tilt_rad) {
  TableUncertainty u;
  const double level = std::max(0.1, std::cos(table.pitch_rad()));
  const double reach = table.camera_height_m / std::max(0.2, std::sin(std::abs(table.pitch_rad())));
  u.height_m = height_m;
  u.tilt_rad = tilt_rad;
  u.pitch_rad = tilt_rad;
  u.roll_rad = tilt_rad / level;
  // Where the optical axis meets the table.
  u.surface_m = std::hypot(height_m, tilt_rad * reach);
  return u;
}

}  // namespace

std::optional<TableGeometry> table_below(const RigidTransform& world_from_camera, double table_height_m) {
  TableGeometry table;
  table.up_in_camera = world_from_camera.linear().transpose() * Eigen::Vector3d::UnitZ();
  table.camera_height_m = world_from_camera.translation().z() - table_height_m;
  if (!(table.camera_height_m > 0.01)) return std::nullopt;
  return table;
}

struct TableLocator::Impl {
  TableLocatorOptions options;
  std::optional<TfListener> tf;
  TableFilter filter;
  std::optional<TableEstimate> last;

  explicit Impl(const TableLocatorOptions& o) : options(o), filter(o.filtering) {
    const bool estimate_with_dds =
        o.origin == TableOrigin::kEstimate && o.prior == TableLocatorOptions::Prior::kDds;
    if (o.origin == TableOrigin::kDds || estimate_with_dds) {
      tf.emplace(std::make_shared<DdsParticipant>(o.domain), TfListenerOptions{"", o.pose_topic, kPoseChild});
    }
  }

  RigidTransform camera_in_world(const RgbdFrame& frame) {
    tf->update();
    const std::string camera = options.pose_topic.empty() ? frame.frame_id : kPoseChild;
    const auto found = tf->buffer().lookup(options.world_frame, camera, frame.captured_at, options.max_age);
    if (found) return *found;
    throw InputError("table", "the camera's pose from DDS: " + found.error(),
                     options.pose_topic.empty()
                         ? "publish tf from " + options.world_frame + " to " + camera
                         : "publish " + options.pose_topic + " in " + options.world_frame);
  }

  KnownTable from_dds(const RgbdFrame& frame) {
    const auto table = table_below(camera_in_world(frame), options.table_height_m);
    if (!table)
      throw InputError("table", "DDS says that the camera is not above the table", "check table_height_m");
    return {*table, uncertainty_of(*table, options.height_deviation_m, options.tilt_deviation_rad)};
  }

  KnownTable estimated(const RgbdFrame& frame) {
    TableEstimateOptions estimate = options.estimate;
    if (options.prior == TableLocatorOptions::Prior::kFixed)
      estimate.up_in_camera = options.fixed.up_in_camera;
    if (options.prior == TableLocatorOptions::Prior::kDds) {
      estimate.up_in_camera = camera_in_world(frame).linear().transpose() * Eigen::Vector3d::UnitZ();
    }
    const auto found = estimate_table(table_points(frame), estimate);
    last = found ? std::optional(*found) : std::nullopt;
    const TableFilter::Time time = frame.captured_monotonic.time_since_epoch();
    if (!options.filter) {
      if (!found) throw InputError("table", found.error().reason);
      return {found->table, found->uncertainty};
    }
    if (found) filter.update({found->table, found->uncertainty}, time);
    if (const auto known = filter.at(time)) return *known;
    throw InputError("table",
                     found ? "the estimates do not agree; hold the camera still" : found.error().reason);
  }
};

TableLocator::TableLocator(const TableLocatorOptions& options) : impl_(std::make_unique<Impl>(options)) {}
TableLocator::~TableLocator() = default;

void TableLocator::locate(RgbdFrame& frame) {
  KnownTable known;
  switch (impl_->options.origin) {
    case TableOrigin::kFrame:
      if (frame.table) return;
      throw InputError("table", "the source does not say where the table is",
                       "let it be estimated, or configure it");
    case TableOrigin::kFixed:
      known = {impl_->options.fixed, uncertainty_of(impl_->options.fixed, impl_->options.height_deviation_m,
                                                    impl_->options.tilt_deviation_rad)};
      break;
    case TableOrigin::kDds:
      known = impl_->from_dds(frame);
      break;
    case TableOrigin::kEstimate:
      known = impl_->estimated(frame);
      break;
  }
  frame.table = known.table;
  frame.table_uncertainty = known.uncertainty;
}

const std::optional<TableEstimate>& TableLocator::last_estimate() const { return impl_->last; }

}  // namespace sextant
