// SPDX-License-Identifier: Apache-2.0
// VSD needs pictures: the measured depth of every image, and the depth that the mesh has in both poses.
#pragma once

#include <functional>
#include <map>

#include "offline/evaluate/evaluation.h"
#include "offline/mesh/mesh.h"

namespace sextant {

/// Fills `vsd` of every found instance whose object has a mesh (metres, mesh's own frame), and ar_vsd of the
/// objects that have one (of the total where all have). Images with distortion or fx != fy are rendered with
/// their mean focal length. progress(done, total) per image. Throws InputError (an image is damaged),
/// DeviceError (no renderer).
void add_vsd(EvaluationReport& report, const std::vector<BopImage>& images,
             const std::map<int, EvaluatedObject>& objects, const std::map<int, Mesh>& meshes,
             const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace sextant
