// SPDX-License-Identifier: Apache-2.0
// Putting learnt parts to the test in synthesised scenes: how often and how far off is a part's feature found
// on the object, and how often is it found by chance where the object is not, or is turned to another side.
// This is what the likelihood scoring weighs parts by (runtime/search/scored_bin.h).
#pragma once

#include <vector>

#include "offline/learn/scene_view.h"
#include "runtime/model/object_model.h"

namespace sextant {

struct TestScene {
  SceneTruth truth = SceneTruth::kObject;
  SceneView view;
};

/// Fills `seen` of every part but its weight. Without scenes nothing is changed.
void measure_parts(const std::vector<TestScene>& scenes, const PinholeCamera& camera,
                   std::vector<VisualPart>& parts);
void measure_parts(const std::vector<TestScene>& scenes, const PinholeCamera& camera,
                   std::vector<DepthPart>& parts);

}  // namespace sextant
