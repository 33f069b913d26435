// SPDX-License-Identifier: Apache-2.0
// What `sextant detect` does, for other programs that do the same with another search policy.
#pragma once

#include <functional>

#include "offline/cli/detect_options.h"
#include "runtime/base/error.h"

namespace sextant {

/// Called with every frame before it is searched; may change the call.
using BeforeDetect = std::function<void(const RgbdFrame&, DetectCall&)>;

/// Detects in all frames and prints and writes what was asked for.
ExitCode run_detect(const DetectArguments& arguments, const BeforeDetect& before = {});

}  // namespace sextant
