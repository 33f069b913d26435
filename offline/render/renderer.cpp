// SPDX-License-Identifier: Apache-2.0
#include "offline/render/renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "offline/render/egl_context.h"
#include "offline/render/shaders.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr float kNear = 0.05F;
constexpr float kFar = 100.0F;
constexpr int kSamples = 4;

GLuint compile(GLenum type, const char* source) {
  const GLuint shader = glCreateShader(type);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    std::string log(1024, '\0');
    glGetShaderInfoLog(shader, 1024, nullptr, log.data());
    throw DeviceError("OpenGL", "the driver refuses a shader: " + log, "update the graphics driver");
  }
  return shader;
}

/// Features of the colour shader that a draw needs; a variant is a sum of them.
constexpr std::size_t kTextured = 1;
constexpr std::size_t kFills = 2;
constexpr std::size_t kGloss = 4;
constexpr std::size_t kVariants = 8;

std::string colour_shader(std::size_t variant) {
  std::string source = "#version 330 core\n";
  if (variant & kTextured) source += "#define TEXTURED\n";
  if (variant & kFills) source += "#define FILLS\n";
  if (variant & kGloss) source += "#define GLOSS\n";
  return source + kColourShader;
}

GLuint link(const char* fragment) {
  const GLuint program = glCreateProgram();
  const GLuint v = compile(GL_VERTEX_SHADER, kVertexShader);
  const GLuint f = compile(GL_FRAGMENT_SHADER, fragment);
  glAttachShader(program, v);
  glAttachShader(program, f);
  glLinkProgram(program);
  glDeleteShader(v);
  glDeleteShader(f);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (!ok) throw DeviceError("OpenGL", "the driver cannot link a program", "update the graphics driver");
  return program;
}

/// Render targets of one size: multisampled colour with its resolve, and the geometry pass.
struct Targets {
  int width = 0, height = 0;
  GLuint multisample = 0, resolve = 0, geometry = 0;
  GLuint buffers[6] = {};

  void create(int w, int h) {
    destroy();
    width = w;
    height = h;
    glGenFramebuffers(1, &multisample);
    glGenFramebuffers(1, &resolve);
    glGenFramebuffers(1, &geometry);
    glGenRenderbuffers(6, buffers);
    attach(multisample, GL_COLOR_ATTACHMENT0, 0, GL_RGBA8, kSamples);
    attach(multisample, GL_DEPTH_ATTACHMENT, 1, GL_DEPTH_COMPONENT32F, kSamples);
    attach(resolve, GL_COLOR_ATTACHMENT0, 2, GL_RGBA8, 0);
    attach(geometry, GL_COLOR_ATTACHMENT0, 3, GL_R32F, 0);
    attach(geometry, GL_COLOR_ATTACHMENT1, 4, GL_R16I, 0);
    attach(geometry, GL_DEPTH_ATTACHMENT, 5, GL_DEPTH_COMPONENT32F, 0);
    for (const GLuint f : {multisample, resolve, geometry}) {
      glBindFramebuffer(GL_FRAMEBUFFER, f);
      if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw DeviceError("OpenGL",
                          "no framebuffer of " + std::to_string(w) + " x " + std::to_string(h) + " pixels",
                          "render a smaller image");
      }
    }
  }
  void destroy() {
    if (width == 0) return;
    for (const GLuint f : {multisample, resolve, geometry}) glDeleteFramebuffers(1, &f);
    glDeleteRenderbuffers(6, buffers);
    width = height = 0;
  }

 private:
  void attach(GLuint framebuffer, GLenum where, int buffer, GLenum format, int samples) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[buffer]);
    if (samples > 0) {
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    } else {
      glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, where, GL_RENDERBUFFER, buffers[buffer]);
  }
};

struct PartOnGpu {
  GLuint elements = 0;
  GLsizei count = 0;
  int texture = -1;
  Eigen::Vector3f diffuse{1, 1, 1};
};

struct MeshOnGpu {
  GLuint array = 0;
  GLuint vertices[4] = {};
  std::vector<PartOnGpu> parts;
  std::vector<GLuint> textures;
};

template <typename Vector>
void upload_attribute(GLuint buffer, GLuint location, const std::vector<Vector>& values) {
  constexpr GLint kComponents = Vector::RowsAtCompileTime;
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(Vector)), values.data(),
               GL_STATIC_DRAW);
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, kComponents, GL_FLOAT, GL_FALSE, sizeof(Vector), nullptr);
}

GLuint upload_texture(const cv::Mat& image) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  const cv::Mat packed = image.isContinuous() ? image : image.clone();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, packed.cols, packed.rows, 0, GL_RGB, GL_UNSIGNED_BYTE, packed.data);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return texture;
}

void set_matrix(GLuint program, const char* name, const Eigen::Matrix4d& m) {
  const Eigen::Matrix4f f = m.cast<float>();
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, f.data());
}

void set_vector(GLuint program, const char* name, const Eigen::Vector3f& v) {
  glUniform3f(glGetUniformLocation(program, name), v.x(), v.y(), v.z());
}

/// Clip coordinates of a window of the image. Row 0 of the framebuffer is the window's top row, so that what
/// is read back needs no flip; pixel centres are integers in the camera and halves in the window.
Eigen::Matrix4d clip_from_camera(const PinholeCamera& camera, const cv::Rect& window) {
  const double w = window.width;
  const double h = window.height;
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = 2 * camera.focal / w;
  m(0, 2) = 2 * (camera.cx + 0.5 - window.x) / w - 1;
  m(1, 1) = 2 * camera.focal / h;
  m(1, 2) = 2 * (camera.cy + 0.5 - window.y) / h - 1;
  m(2, 2) = (kFar + kNear) / (kFar - kNear);
  m(2, 3) = -2.0 * kFar * kNear / (kFar - kNear);
  m(3, 2) = 1;
  return m;
}

}  // namespace

struct Renderer::Impl {
  EglContext egl;
  GLuint geometry_program = 0;
  std::array<GLuint, kVariants> colour_programs{};  ///< linked when first needed
  Targets targets;
  std::map<int, MeshOnGpu> meshes;
  int next_handle = 0;

  Impl() : geometry_program(link(kGeometryShader)) {}
  ~Impl() {
    egl.make_current();
    while (!meshes.empty()) forget(meshes.begin()->first);
    targets.destroy();
    glDeleteProgram(geometry_program);
    for (const GLuint program : colour_programs) glDeleteProgram(program);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void forget(int handle) {
    const auto found = meshes.find(handle);
    if (found == meshes.end()) return;
    MeshOnGpu& mesh = found->second;
    for (const PartOnGpu& part : mesh.parts) glDeleteBuffers(1, &part.elements);
    for (const GLuint texture : mesh.textures) glDeleteTextures(1, &texture);
    glDeleteBuffers(4, mesh.vertices);
    glDeleteVertexArrays(1, &mesh.array);
    meshes.erase(found);
  }

  /// Targets of the window's size and the state that both passes share.
  void prepare(const cv::Rect& window) {
    egl.make_current();
    if (window.width > targets.width || window.height > targets.height) {
      targets.create(std::max(window.width, targets.width), std::max(window.height, targets.height));
    }
    glViewport(0, 0, window.width, window.height);
    glScissor(0, 0, window.width, window.height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  static void set_light(GLuint program, const Light& light) {
    set_vector(program, "light_in_camera", light.position_in_camera.cast<float>());
    glUniform1f(glGetUniformLocation(program, "ambient"), static_cast<float>(light.ambient));
    glUniform1f(glGetUniformLocation(program, "strength"), static_cast<float>(light.strength));
    const std::size_t fills = std::min(light.fills.size(), kMaxFillLights);
    std::array<Eigen::Vector3f, kMaxFillLights> positions;
    std::array<float, kMaxFillLights> strengths{};
    for (std::size_t i = 0; i < kMaxFillLights; ++i) {
      positions[i] = Eigen::Vector3f::Zero();
      if (i >= fills) continue;
      positions[i] = light.fills[i].position_in_camera.cast<float>();
      strengths[i] = static_cast<float>(light.fills[i].strength);
    }
    constexpr auto kCount = static_cast<GLsizei>(kMaxFillLights);
    glUniform1i(glGetUniformLocation(program, "fill_count"), static_cast<GLint>(fills));
    glUniform3fv(glGetUniformLocation(program, "fill_in_camera"), kCount, positions[0].data());
    glUniform1fv(glGetUniformLocation(program, "fill_strength"), kCount, strengths.data());
  }

  void draw_geometry(const Eigen::Matrix4d& clip, const std::vector<RenderItem>& items) {
    glUseProgram(geometry_program);
    set_matrix(geometry_program, "clip_from_camera", clip);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const MeshOnGpu& mesh = meshes.at(items[i].mesh);
      set_matrix(geometry_program, "camera_from_mesh", items[i].camera_from_mesh.matrix());
      glUniform1i(glGetUniformLocation(geometry_program, "item"), static_cast<GLint>(i));
      glBindVertexArray(mesh.array);
      for (const PartOnGpu& part : mesh.parts) draw_elements(part);
    }
  }

  void draw_colours(const Eigen::Matrix4d& clip, const std::vector<RenderItem>& items, const Light& light) {
    std::array<bool, kVariants> lit{};
    for (const RenderItem& item : items) {
      const MeshOnGpu& mesh = meshes.at(item.mesh);
      glBindVertexArray(mesh.array);
      for (const PartOnGpu& part : mesh.parts) {
        const std::size_t variant = (part.texture >= 0 ? kTextured : 0) + (light.fills.empty() ? 0 : kFills) +
                                    (item.gloss > 0 ? kGloss : 0);
        GLuint& program = colour_programs[variant];
        if (program == 0) program = link(colour_shader(variant).c_str());
        glUseProgram(program);
        if (!lit[variant]) {
          set_light(program, light);
          set_matrix(program, "clip_from_camera", clip);
          lit[variant] = true;
        }
        set_matrix(program, "camera_from_mesh", item.camera_from_mesh.matrix());
        glUniform1f(glGetUniformLocation(program, "gloss"), static_cast<float>(item.gloss));
        set_vector(program, "diffuse", part.diffuse);
        if (part.texture >= 0) {
          glBindTexture(GL_TEXTURE_2D, mesh.textures[static_cast<std::size_t>(part.texture)]);
        }
        draw_elements(part);
      }
    }
  }

  static void draw_elements(const PartOnGpu& part) {
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, part.elements);
    glDrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_INT, nullptr);
  }
};

Renderer::Renderer() : impl_(std::make_unique<Impl>()) {}
Renderer::~Renderer() = default;

int Renderer::upload(const Mesh& mesh) {
  impl_->egl.make_current();
  MeshOnGpu gpu;
  glGenVertexArrays(1, &gpu.array);
  glBindVertexArray(gpu.array);
  glGenBuffers(4, gpu.vertices);
  upload_attribute(gpu.vertices[0], 0, mesh.vertices);
  upload_attribute(gpu.vertices[1], 1, mesh.normals);
  upload_attribute(gpu.vertices[2], 2, mesh.colours);
  upload_attribute(gpu.vertices[3], 3, mesh.uvs);
  for (const MeshPart& part : mesh.parts) {
    PartOnGpu p;
    glGenBuffers(1, &p.elements);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, p.elements);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(part.triangles.size() * sizeof(part.triangles[0])),
                 part.triangles.data(), GL_STATIC_DRAW);
    p.count = static_cast<GLsizei>(part.triangles.size() * 3);
    p.texture = part.texture;
    p.diffuse = part.diffuse;
    gpu.parts.push_back(p);
  }
  for (const cv::Mat& image : mesh.textures) gpu.textures.push_back(upload_texture(image));
  impl_->meshes[impl_->next_handle] = std::move(gpu);
  return impl_->next_handle++;
}

void Renderer::release(int mesh) {
  impl_->egl.make_current();
  impl_->forget(mesh);
}

RenderedView Renderer::render_geometry(const PinholeCamera& camera, const cv::Rect& window,
                                       const std::vector<RenderItem>& items) {
  Impl& gl = *impl_;
  gl.prepare(window);
  glBindFramebuffer(GL_FRAMEBUFFER, gl.targets.geometry);
  const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, outputs);
  const GLfloat no_depth[] = {0, 0, 0, 0};
  const GLint no_item[] = {-1, -1, -1, -1};
  const GLfloat far_depth = 1;
  glClearBufferfv(GL_COLOR, 0, no_depth);
  glClearBufferiv(GL_COLOR, 1, no_item);
  glClearBufferfv(GL_DEPTH, 0, &far_depth);
  gl.draw_geometry(clip_from_camera(camera, window), items);
  RenderedView view;
  view.ray_depth_m.create(window.height, window.width, CV_32FC1);
  view.item.create(window.height, window.width, CV_16SC1);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, window.width, window.height, GL_RED, GL_FLOAT, view.ray_depth_m.data);
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, window.width, window.height, GL_RED_INTEGER, GL_SHORT, view.item.data);
  return view;
}

RenderedView Renderer::render(const PinholeCamera& camera, const cv::Rect& window,
                              const std::vector<RenderItem>& items, const Light& light,
                              const Eigen::Vector3d& background) {
  RenderedView view = render_geometry(camera, window, items);
  view.colour = render_colour(camera, window, items, light, background);
  return view;
}

cv::Mat Renderer::render_colour(const PinholeCamera& camera, const cv::Rect& window,
                                const std::vector<RenderItem>& items, const Light& light,
                                const Eigen::Vector3d& background) {
  Impl& gl = *impl_;
  gl.prepare(window);
  glBindFramebuffer(GL_FRAMEBUFFER, gl.targets.multisample);
  const GLfloat far_depth = 1;
  const GLfloat clear[] = {static_cast<float>(background.x() / 255), static_cast<float>(background.y() / 255),
                           static_cast<float>(background.z() / 255), 1};
  glClearBufferfv(GL_COLOR, 0, clear);
  glClearBufferfv(GL_DEPTH, 0, &far_depth);
  gl.draw_colours(clip_from_camera(camera, window), items, light);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, gl.targets.multisample);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, gl.targets.resolve);
  glBlitFramebuffer(0, 0, window.width, window.height, 0, 0, window.width, window.height, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, gl.targets.resolve);
  // Drivers copy RGBA as it is; RGB would be converted pixel by pixel.
  cv::Mat rgba(window.height, window.width, CV_8UC4);
  glReadPixels(0, 0, window.width, window.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
  cv::Mat colour(window.height, window.width, CV_8UC3);
  const int channels[] = {0, 0, 1, 1, 2, 2};
  cv::mixChannels(&rgba, 1, &colour, 1, channels, 3);
  return colour;
}

}  // namespace sextant
