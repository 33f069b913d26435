// SPDX-License-Identifier: Apache-2.0
// A changed file for a running daemon: detection and models may change, topics and sources may not.
#include "runtime/daemon/config_reload.h"

#include <gmock/gmock.h>

#include "runtime/base/error.h"
#include "runtime/daemon/config_reader.h"

namespace sextant {
namespace {

constexpr char kMinimal[] = "source: {dataset: d}\nmodels: {files: [m.sxm]}\n";

DaemonConfig parse(const std::string& more) { return parse_config(kMinimal + more, "file.yaml", "/folder"); }

TEST(ConfigReload, NamesWhatChanged) {
  EXPECT_THAT(changed_keys(parse(""), parse("")), testing::IsEmpty());
  EXPECT_THAT(changed_keys(parse(""), parse("detect: {threads: 3, threshold: -4}\nlog: {level: debug}\n")),
              testing::ElementsAre("detect.threshold", "detect.threads", "log.level"));
}

TEST(ConfigReload, LetsDetectionChangeAndRefusesTheRest) {
  const DaemonConfig running = parse("");
  EXPECT_THAT(check_reload(running, parse("detect: {threads: 3}\n"), "f"),
              testing::ElementsAre("detect.threads"));
  for (const char* fixed : {"publish: {domain: 3}\n", "publish: {tf: \"\"}\n", "pipeline: {max_age_ms: 77}\n",
                            "commands: {command: \"\"}\n"}) {
    try {
      check_reload(running, parse(std::string(fixed) + "detect: {threads: 3}\n"), "f.yaml");
      ADD_FAILURE() << fixed;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("cannot change while the daemon runs"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("threads")));
    }
  }
}

}  // namespace
}  // namespace sextant
