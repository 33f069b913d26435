// SPDX-License-Identifier: Apache-2.0
// A frame as bytes, for the ranks that search it together.
#pragma once

#include "offline/mpi/search_wire.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

void append_frame(Bytes& bytes, const RgbdFrame& frame);
RgbdFrame take_frame(ByteReader& reader);

}  // namespace sextant
