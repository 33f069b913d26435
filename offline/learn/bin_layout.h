// SPDX-License-Identifier: Apache-2.0
// Which viewpoint bins a model needs (Davies 2015, Proc. 10; METHOD.md section 6): every (rx, ry) that an
// upright object can show to the declared cameras, tolerance included, and no others.
#pragma once

#include <vector>

#include "offline/learn/parameters.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Bins sorted by (rx, ry, rz). rx is cut at -r_w/2 + k r_w (one bin is centred on 0), ry at -90 + k r_w, rz
/// from 0 to the symmetry angle in equal steps of at most r_w (symmetry 0: the single bin [0, 1)).
std::vector<RotationBox> lay_out_bins(const LearnParameters& parameters, int symmetry_deg);

}  // namespace sextant
