// SPDX-License-Identifier: Apache-2.0
// Pictures of what went wrong, worst first: the outline of the truth in green, of the answer in magenta.
#pragma once

#include <map>
#include <vector>

#include "offline/report/html/report_html.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// At most `limit` pictures: instances that are not right (not found first, then by how far they are off),
/// then false alarms (most confident first). meshes: metres, mesh's own frame; objects without one get no
/// picture. Throws InputError where an image cannot be read.
std::vector<CasePicture> worst_case_pictures(const EvaluationReport& report,
                                             const std::vector<BopImage>& images,
                                             const std::map<int, ModelMesh>& meshes, std::size_t limit = 24);

/// The instances that are not right, worst first.
std::vector<const InstanceResult*> worst_instances(const EvaluationReport& report);

}  // namespace sextant
