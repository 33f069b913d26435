// SPDX-License-Identifier: Apache-2.0
// An OpenGL 4.5 core context without a window: EGL surfaceless on Mesa (a GPU where there is one, else
// llvmpipe), or the EGL device platform that proprietary drivers offer.
#pragma once

#include <string>

namespace sextant {

class EglContext {
 public:
  EglContext();  ///< Throws DeviceError.
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  /// Makes the context current in the calling thread.
  void make_current() const;
  /// Renderer string of the driver, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string driver() const;

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace sextant
