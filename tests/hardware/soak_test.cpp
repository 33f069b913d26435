// SPDX-License-Identifier: Apache-2.0
// A camera that streams for SEXTANT_SOAK_SECONDS, with faults every few seconds: memory and open files stay
// as they are. scripts/test --long runs it for ten minutes.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hal/pixels/decode.h"
#include "hal/v4l2/v4l2_source.h"
#include "tests/hardware/vivid.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Bytes that this process holds in memory.
long resident_bytes() {
  long total = 0;
  long resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

long open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                       std::filesystem::directory_iterator());
}

TEST(Soak, MemoryAndFilesStayConstant) {
  const char* text = std::getenv("SEXTANT_SOAK_SECONDS");
  if (text == nullptr || std::atoi(text) < 1) GTEST_SKIP() << "set SEXTANT_SOAK_SECONDS for a soak";
  const auto source = open_v4l2_source(vivid::webcam());
  const auto begin = Clock::now();
  const auto length = std::chrono::seconds(std::atoi(text));
  long memory = 0;
  long files = 0;
  auto next_fault = begin + 5s;
  int faults = 0;
  while (Clock::now() < begin + length) {
    if (const auto image = source->next(100ms)) decode_colour(*image, "soak");
    if (memory == 0 && Clock::now() > begin + length / 5 && source->state() == SourceState::kRunning) {
      memory = resident_bytes();
      files = open_files();
    }
    if (Clock::now() < next_fault) continue;
    next_fault += 5s;
    switch (faults++ % 3) {
      case 0:
        vivid::control(vivid::kWebcamNode, "inject_v4l2_buf_flag_error=1");
        break;
      case 1:
        vivid::control(vivid::kWebcamNode, "inject_fatal_streaming_error=1");
        break;
      default:
        vivid::unplug();
        // Plugged in before it is let go of, the camera would come back under another node.
        ASSERT_TRUE(vivid::reaches(*source, SourceState::kWaiting));
        vivid::plug();
    }
  }
  ASSERT_TRUE(vivid::next_image(*source).has_value()) << source->condition();
  const SourceStatistics counts = source->statistics();
  const double rate = static_cast<double>(counts.delivered) / static_cast<double>(length.count());
  const long grown = resident_bytes() - memory;
  printf(
      "soak: %.1f images a second, %d faults, %llu reconnections, memory %+ld KiB, files %+ld; drops: %s\n",
      rate, faults, static_cast<unsigned long long>(counts.reconnects), grown / 1024, open_files() - files,
      describe_drops(counts).c_str());
  EXPECT_LE(grown, 2 << 20);
  EXPECT_EQ(open_files(), files);
  EXPECT_GT(counts.delivered, 0U);
}

}  // namespace
}  // namespace sextant
