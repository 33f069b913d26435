// SPDX-License-Identifier: Apache-2.0
// How an object can lie on a table: the stable facets of its convex hull and how likely each is
// (Goldberg, Mirtich, Zhuang, Craig, Carlisle, Canny 1999, "Part pose statistics: estimators and
// experiments"; quasi-static rolling after Wiegley, Rao, Goldberg 1992, "Computing a statistical distribution
// of stable poses").
#pragma once

#include <string>
#include <vector>

#include "offline/mesh/convex_hull.h"
#include "offline/mesh/standing_object.h"

namespace sextant {

/// Stable poses, most likely first (among equals: the mesh's +z, then +y, then +x up first).
/// - Hull facets within 1 deg of the largest among them are one face.
/// - A face is stable if the centre of mass lies above its polygon; an unstable one tips over its edge
///   closest to the centre of mass onto the next face, and so on.
/// - A face's probability is the solid angle under which the centre of mass sees it, over 4 pi; an unstable
///   face hands its own on to where it comes to rest. The sum over all poses is 1.
/// - A pose that the object leaves when its centre of mass rises by less than 0.5 % of the radius (one facet
/// of
///   a barrel, a book on its edge) is none: its share goes to the deeper pose beyond.
/// - Poses less than 5 deg apart are one (the likelier stands for both); so are those that differ by a turn
///   about an axis of revolution of the hull (a can that lies on its side): the object's look from above may
///   then still differ by its print, and the likeliest face stands for all.
/// `rattle` is that 0.5 %, as a share of the largest distance from the centre of mass.
std::vector<RestingPose> resting_poses(const ConvexHull& hull, const Eigen::Vector3d& centre_of_mass,
                                       double rattle = 0.005);

/// The unit vector of the mesh's frame that points up in a pose.
Eigen::Vector3d up_in_mesh(const RestingPose& pose);

/// The rotation that turns `up` (unit, mesh frame) to z by the shortest way (about x where it is a half
/// turn).
Eigen::Matrix3d rotation_that_raises(const Eigen::Vector3d& up);

/// One line per pose: number, probability, height, which direction of the mesh is up.
std::string describe_resting_poses(const std::vector<RestingPose>& poses);

}  // namespace sextant
