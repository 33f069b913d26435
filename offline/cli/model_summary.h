// SPDX-License-Identifier: Apache-2.0
// A model in words and in JSON, for `sextant inspect`.
#pragma once

#include <cstddef>
#include <string>

#include "runtime/model/model_file.h"

namespace sextant {

/// Several lines for people; at most max_bins bins are listed. Standard deviations of visual parts are given
/// in pixels at 1 m with a focal length of 525 px, those of depth parts in millimetres.
std::string model_as_text(const ModelFileContent& content, const std::string& file, std::size_t max_bins);

/// One JSON object on one line: file, identity, provenance, geometry, all bins with part counts and quantiles
/// of the parts' variances (px^2 at 1 m with f = 525; m^2). 64-bit hashes are hexadecimal strings.
std::string model_as_json(const ModelFileContent& content, const std::string& file);

/// Share 0..1 -> value: linear interpolation between the sorted values; 0 for none.
double quantile(const std::vector<double>& sorted, double share);

}  // namespace sextant
