// SPDX-License-Identifier: Apache-2.0
// Which frame and which model a proof is about: 64-bit XXH3, as 16 hexadecimal digits. They tell a changed
// input from the right one; they are no protection against someone who wants them to collide.
#pragma once

#include <filesystem>
#include <string>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// Of everything that the search reads: colour, depth, calibration, and the table with its uncertainty.
std::string frame_fingerprint(const RgbdFrame& frame);
/// Of a file's bytes. Throws InputError where it cannot be read.
std::string file_fingerprint(const std::filesystem::path& file);
std::string text_fingerprint(const std::string& text);

}  // namespace sextant
