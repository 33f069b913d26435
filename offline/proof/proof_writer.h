// SPDX-License-Identifier: Apache-2.0
// Collects the proofs of the frames that a detector looks at. Growing the boxes uses the plain bounds and
// plain tables with windows: it takes seconds where the search took milliseconds, and would notice if the
// search were wrong.
#pragma once

#include <filesystem>
#include <vector>

#include "offline/proof/proof.h"
#include "runtime/base/worker_pool.h"

namespace sextant {

class ProofWriter {
 public:
  /// Throws InputError where a model file cannot be read again.
  ProofWriter(const std::vector<std::filesystem::path>& model_files, const std::vector<ObjectModel>& models,
              const DetectOptions& options, FrameSourceProof source);
  /// Throws std::logic_error where the search's answer turns out to be wrong.
  void add(const RgbdFrame& frame, const SearchRecord& record);
  const Proof& proof() const { return proof_; }

 private:
  Proof proof_;
  std::vector<double> bounding_radii_m_;
  FrameTables tables_;
  WorkerPool serial_{1};
};

}  // namespace sextant
