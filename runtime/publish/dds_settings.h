// SPDX-License-Identifier: Apache-2.0
// Settings of Cyclone DDS that a daemon needs whatever CYCLONEDDS_URI says or does not say.
#pragma once

#include <string>

namespace sextant {

/// An XML fragment: a write does not wait for a reliable reader that is slow or stopped. Our histories are
/// keep-last and so bounded; with Cyclone's own watermarks (30 kB to 500 kB) everybody else would lose
/// messages to that reader.
std::string dds_defaults();

/// Puts dds_defaults() before what CYCLONEDDS_URI says, which goes on top of it. Call it before other threads
/// exist and before the first participant.
void use_dds_defaults();

}  // namespace sextant
