// SPDX-License-Identifier: Apache-2.0
// The real sextantd as its own process: frames from a data set, real detection, messages over loopback DDS.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/model/model_file.h"
#include "runtime/publish/echo_reader.h"
#include "tests/integration/child_process.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/daemon/notify_socket.h"
#include "tests/unit/runtime/model/synthetic_model.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"

namespace sextant {
namespace {

using testing::HasSubstr;

class Sextantd : public testing::Test {
 protected:
  Sextantd() {
    write_small_bop(folder_ / "data");
    ObjectModel model = test::make_box_model(1, 20, 3);
    model.name = "box";
    write_model(model, folder_ / "box.sxm");
  }

  std::filesystem::path write_config(const std::string& more = "", const std::string& source = "loop: true") {
    const std::filesystem::path file = folder_ / "sextantd.yaml";
    std::ofstream(file) << "source: {dataset: data, " << source << "}\n"
                        << "models: {files: [\"*.sxm\"]}\n"
                        << "detect: {table: fixed, table_pitch_deg: 40, table_height_m: 0.7, threads: 1}\n"
                        << "publish: {domain: " << domain_.writing << ", namespace: " << domain_.name_space
                        << ", lease_ms: 500, once_wait_ms: 10000}\n"
                        << "pipeline: {max_age_ms: 60000}\n"
                        << more;
    return file;
  }

  ChildProcess start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), SEXTANTD);
    return {std::move(arguments), folder_.path()};
  }

  /// Listens until `enough` messages are there, up to 20 s.
  bool listen(EchoReader& reader, const std::function<bool()>& enough) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!enough() && std::chrono::steady_clock::now() < end) reader.poll(std::chrono::milliseconds(20));
    return enough();
  }

  TemporaryFolder folder_;
  DdsTestDomain domain_;
  std::vector<nlohmann::json> messages_;
  std::vector<std::string> warnings_;
  EchoReader reader_{{domain_.reading, domain_.name_space + "/detections", TopicKind::kDetections},
                     [this](const EchoMessage& m) { messages_.push_back(nlohmann::json::parse(m.json)); },
                     [this](const std::string& w) { warnings_.push_back(w); }};
};

TEST_F(Sextantd, PublishesInALoopUntilSigterm) {
  const NotifySocket notify(folder_ / "notify");
  setenv("NOTIFY_SOCKET", notify.path().c_str(), 1);
  setenv("WATCHDOG_USEC", "1000000", 1);
  ChildProcess daemon = start({"--config", write_config().string()});
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  // More frames than the data set has: it loops.
  EXPECT_TRUE(listen(reader_, [&] { return messages_.size() >= 6; })) << daemon.output("stderr");
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0) << daemon.output("stderr");
  std::int64_t last = 0;
  for (const auto& message : messages_) {
    const auto& stamp = message["header"]["stamp"];
    const std::int64_t ns =
        stamp["sec"].get<std::int64_t>() * 1'000'000'000 + stamp["nanosec"].get<std::int64_t>();
    EXPECT_GT(ns, last);  // every frame has its own capture time
    last = ns;
    EXPECT_EQ(message["header"]["frame_id"], "camera_color_optical_frame");
  }
  EXPECT_THAT(daemon.output("stderr"), HasSubstr("SIGTERM: ending"));
  EXPECT_EQ(daemon.output("stdout"), "");
  const auto said = notify.messages();
  EXPECT_THAT(said, testing::Contains("READY=1"));
  EXPECT_THAT(said, testing::Contains("WATCHDOG=1"));
  EXPECT_THAT(said, testing::Contains("STOPPING=1"));
}

TEST_F(Sextantd, OncePublishesOneFrameToThoseWhoListen) {
  ChildProcess daemon = start({"--config", write_config().string(), "--once"});
  EXPECT_TRUE(listen(reader_, [&] { return !daemon.running(); })) << daemon.output("stderr");
  EXPECT_EQ(daemon.wait(), 0) << daemon.output("stderr");
  reader_.poll(std::chrono::milliseconds(200));
  EXPECT_EQ(messages_.size(), 1U) << daemon.output("stderr");
}

TEST_F(Sextantd, EndsAfterTheLastFrameWithoutLoop) {
  ChildProcess daemon = start({"--config", write_config("", "loop: false").string()});
  EXPECT_EQ(daemon.wait(), 0);
  EXPECT_THAT(daemon.output("stderr"), HasSubstr("4 frames published; 4 from the source"));
}

TEST_F(Sextantd, ReadersLearnThatItWasKilled) {
  ChildProcess daemon = start({"--config", write_config().string()});
  ASSERT_TRUE(listen(reader_, [&] { return !messages_.empty(); })) << daemon.output("stderr");
  EXPECT_THAT(warnings_, testing::IsEmpty());
  daemon.send(SIGKILL);
  EXPECT_EQ(daemon.wait(), 128 + SIGKILL);
  EXPECT_TRUE(listen(reader_, [&] { return !warnings_.empty(); }));
  EXPECT_THAT(warnings_, testing::Contains(HasSubstr("a publisher has gone")));
}

TEST_F(Sextantd, ExitCodesAreThoseOfTheManual) {
  const auto run = [&](const std::vector<std::string>& arguments, int code, const std::string& said) {
    ChildProcess daemon = start(arguments);
    EXPECT_EQ(daemon.wait(), code) << testing::PrintToString(arguments);
    EXPECT_THAT(daemon.output("stdout") + daemon.output("stderr"), HasSubstr(said));
  };
  const std::string good = write_config().string();
  const std::string shipped = SEXTANT_SOURCE_DIR "/config/sextantd.yaml";
  run({"--version"}, 0, "sextant ");
  run({"--help"}, 0, "Example");
  run({"--config", good, "--check-config"}, 0, "good");
  run({"--config", shipped, "--check-config"}, 0, "good");
  run({"--config", shipped, "--print-config-reference"}, 0, "max_age_ms: ");
  run({"--print-config-reference"}, 0, "max_age_ms: ");
  run({}, 2, "--config is missing");
  run({"--nonsense"}, 2, "--nonsense");
  run({"--config", good, "surplus"}, 2, "surplus");
  run({"--config", (folder_ / "none.yaml").string()}, 3, "there is no such file");
  run({"--config", write_config("detect2: {}\n").string(), "--check-config"}, 3, "did you mean 'detect'?");
  std::filesystem::remove(folder_ / "box.sxm");
  run({"--config", write_config().string()}, 3, "there is no such model");
  std::ofstream(folder_ / "box.sxm") << "this is no model";
  run({"--config", write_config().string()}, 3, "box.sxm");
  write_model(test::make_box_model(1, 5, 3), folder_ / "box.sxm");
  std::filesystem::remove_all(folder_ / "data");
  run({"--config", write_config().string()}, 3, "data");
}

TEST_F(Sextantd, ANetworkThatDoesNotWorkIsExitCode4) {
  setenv(
      "CYCLONEDDS_URI",
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no_such0\"/></Interfaces></General>"
      "</Domain></CycloneDDS>",
      1);
  ChildProcess daemon = start({"--config", write_config().string()});
  EXPECT_EQ(daemon.wait(), 4);
  EXPECT_THAT(daemon.output("stderr"), HasSubstr("cannot join domain"));
}

}  // namespace
}  // namespace sextant
