// SPDX-License-Identifier: Apache-2.0
// Decodes the picture on a mesh: PNG (libspng) or JPEG (libjpeg-turbo), told apart by their first bytes.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <span>
#include <string>

namespace sextant {

/// Largest accepted width and height of a texture, pixels.
inline constexpr int kMaxTextureSide = 8192;

/// Returns CV_8UC3, RGB, first row on top; transparency is dropped. Throws InputError(where) for anything
/// but a complete PNG or JPEG of at most kMaxTextureSide squared.
cv::Mat decode_texture(std::span<const std::byte> bytes, const std::string& where);

}  // namespace sextant
