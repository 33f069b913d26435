// SPDX-License-Identifier: Apache-2.0
// Random images of unit variance: the material of sensor noise and of procedural textures.
#pragma once

#include <opencv2/core.hpp>

#include "offline/synthesize/random.h"

namespace sextant {

/// CV_32FC1, independent pixels of unit variance, bell-shaped (sum of four uniforms: within +-3.5).
cv::Mat white_noise(const cv::Size& size, Random& random);

/// CV_32FC1, normal pixels of unit variance, white noise blurred by a Gaussian of `sigma_px`: correlation
/// exp(-d^2 / (4 sigma^2)) at a distance of d pixels. Costs the same for any sigma (made coarse, then
/// enlarged).
cv::Mat smooth_noise(const cv::Size& size, double sigma_px, Random& random);

}  // namespace sextant
