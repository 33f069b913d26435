// SPDX-License-Identifier: Apache-2.0
// The model of one viewpoint bin from rendered views (Davies 2015, Procs. 6 and 9).
#pragma once

#include <vector>

#include "offline/learn/parameters.h"
#include "offline/learn/part_statistics.h"
#include "offline/learn/training_view.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Learns visual and depth parts of one bin from `views`, and puts them to the test in `scenes`: the most
/// informative are chosen. Without scenes nothing is measured, and the surest are (the thesis's rule).
/// bounding_radius_m: of the object. Bins one degree wide in an angle get no coefficient for it. Positions in
/// the result are in tangent * metre.
ViewpointBin learn_bin(const std::vector<TrainingView>& views, const std::vector<TestScene>& scenes,
                       const LearnParameters& parameters, const RotationBox& box, double bounding_radius_m);

}  // namespace sextant
