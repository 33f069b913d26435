// SPDX-License-Identifier: Apache-2.0
// LEARN (Davies 2015, Proc. 10): mesh -> model. Bins are independent, seeded each on its own, so the model is
// byte-identical for any number of threads or ranks.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "offline/learn/parameters.h"
#include "offline/mesh/standing_object.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// Called after each learnt bin with the number done and the total.
using Progress = std::function<void(std::size_t done, std::size_t total)>;

/// Learns bins first, first + stride, first + 2 stride, ... of `boxes` in `threads` worker processes (0: one
/// per core; 1: in this process); the others stay empty. Ranks of an MPI job call it with their rank and
/// their number.
std::vector<ViewpointBin> learn_bins(const StandingObject& object, const LearnParameters& parameters,
                                     const std::vector<RotationBox>& boxes, int threads, std::size_t first,
                                     std::size_t stride, const Progress& progress);

/// The model around learnt bins. Bins without a single part are an InputError (a mesh that cannot be seen).
ObjectModel assemble_model(const StandingObject& object, const LearnParameters& parameters,
                           std::vector<ViewpointBin> bins, const std::string& mesh_file_name, int object_id);

}  // namespace sextant
