// SPDX-License-Identifier: Apache-2.0
#include "offline/render/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <cstdlib>
#include <mutex>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr const char* kAdvice = "install libegl1 and libgl1-mesa-dri (software rendering is enough)";

/// The process' EGL display, initialised once and never terminated: contexts come and go.
EGLDisplay shared_display() {
  static std::mutex mutex;
  static EGLDisplay display = EGL_NO_DISPLAY;
  const std::lock_guard lock(mutex);
  if (display != EGL_NO_DISPLAY) return display;
  // Our threads render many small views at once; llvmpipe's own threads would only get in their way.
  setenv("LP_NUM_THREADS", "0", 0);
  EGLDisplay candidate = EGL_NO_DISPLAY;
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    candidate = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (candidate != EGL_NO_DISPLAY && eglInitialize(candidate, nullptr, nullptr)) return display = candidate;
  }
  if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      candidate =
          eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr);
      if (candidate != EGL_NO_DISPLAY && eglInitialize(candidate, nullptr, nullptr))
        return display = candidate;
    }
  }
  throw DeviceError("EGL", "no headless display", kAdvice);
}

}  // namespace

EglContext::EglContext() {
  display_ = shared_display();
  if (!eglBindAPI(EGL_OPENGL_API)) throw DeviceError("EGL", "no desktop OpenGL", kAdvice);
  const std::array<EGLint, 5> config_attributes{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                                EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display_, config_attributes.data(), &config, 1, &count);
  const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                         3,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         3,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
  context_ = eglCreateContext(display_, count > 0 ? config : nullptr, EGL_NO_CONTEXT, attributes.data());
  if (context_ == EGL_NO_CONTEXT) throw DeviceError("EGL", "no OpenGL 3.3 core context", kAdvice);
  make_current();
}

EglContext::~EglContext() {
  if (eglGetCurrentContext() == context_) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  eglDestroyContext(display_, context_);
}

void EglContext::make_current() const {
  if (eglGetCurrentContext() == context_) return;
  eglBindAPI(EGL_OPENGL_API);
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    throw DeviceError("EGL", "the context cannot be made current", kAdvice);
  }
}

std::string EglContext::driver() const {
  make_current();
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

}  // namespace sextant
