// SPDX-License-Identifier: Apache-2.0
// A replayable certificate: what was searched (hashes, options, table), what is claimed, and for every object
// the boxes of poses whose bounds together prove the claim. `sextant detect --proof` writes it, `sextant
// verify` re-establishes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/detect/detector.h"

namespace sextant {

/// The claim about one object in one frame, and its proof.
struct ObjectProof {
  std::size_t model = 0;  ///< of Proof::models
  double threshold = 0;   ///< log score that a detection must reach
  SearchStatus status = SearchStatus::kAbsent;
  double upper_bound = 0;         ///< of every pose neither found nor suppressed
  std::vector<ScoredPose> found;  ///< best first
  std::string tree;               ///< see split_tree.h
};

struct FrameProof {
  std::int64_t scene_id = 0, image_id = 0;
  std::string hash;                    ///< fingerprint of the frame
  std::optional<TableGeometry> table;  ///< that was searched
  TableTolerance tolerance;            ///< widened by what is not known of the table
  std::vector<ObjectProof> objects;
};

struct ModelProof {
  std::string file;
  std::string hash;  ///< of the file's bytes
  std::string name;
};

/// Where the frames are: a data set, or three files.
struct FrameSourceProof {
  std::string dataset, split;
  std::string colour, depth, camera;
};

struct Proof {
  std::string program;  ///< that wrote it
  std::vector<ModelProof> models;
  FrameSourceProof source;
  DetectOptions options;  ///< those that define the space and the score; the others have their defaults
  std::vector<FrameProof> frames;
};

}  // namespace sextant
