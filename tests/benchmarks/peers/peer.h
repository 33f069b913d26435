// SPDX-License-Identifier: Apache-2.0
// What a peer has to do: learn an object, find it in frames. The rest (files, times, results) is common.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "offline/mesh/standing_object.h"
#include "offline/render/renderer.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

struct PeerObject {
  int id = 1;
  StandingObject object;
  int mesh = 0;  ///< handle in the shared renderer
};

/// What the cameras of the data set do; both peers learn for them, as our models do.
struct PeerRanges {
  double min_pitch_deg = 30, max_pitch_deg = 50;
  double min_distance_m = 0.5, max_distance_m = 1.3;
};

struct PeerAnswer {
  RigidTransform camera_from_object = RigidTransform::Identity();
  double score = 0;  ///< higher is surer, comparable over images
};

class Peer {
 public:
  virtual ~Peer() = default;
  /// Called once per object, before any frame.
  virtual void learn(const PeerObject& object, const PinholeCamera& camera, const PeerRanges& ranges,
                     Renderer& renderer) = 0;
  /// The best answer, or nothing. The frame has a table.
  virtual std::optional<PeerAnswer> find(const PeerObject& object, const RgbdFrame& frame,
                                         const PinholeCamera& camera, Renderer& renderer) = 0;
};

/// The main of a peer's program: --object ID=MESH[@UNITS[,UP]].. --dataset DIR --csv FILE.
int run_peer(int argc, char** argv, const std::string& name, Peer& peer);

}  // namespace sextant
