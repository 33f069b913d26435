// SPDX-License-Identifier: Apache-2.0
// The real sextantd as its own process: frames from a data set, real detection, messages over loopback DDS.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "runtime/model/model_file.h"
#include "runtime/publish/command_client.h"
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

  std::filesystem::path write_config(const std::string& more = "", const std::string& source = "loop: true",
                                     const std::string& detect = "") {
    const std::filesystem::path file = folder_ / "sextantd.yaml";
    std::ofstream(file) << "source: {dataset: data, " << source << "}\n"
                        << "models: {files: [\"*.sxm\"]}\n"
                        << "detect: {table: fixed, table_pitch_deg: 40, table_height_m: 0.7, threads: 1"
                        << detect << "}\n"
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

TEST_F(Sextantd, EveryTopicIsThereAndTheImageOnlyOnDemand) {
  ChildProcess daemon =
      start({"--config", write_config("", "loop: true", ", threshold: -1e9, bound: window").string()});
  std::map<std::string, nlohmann::json> last;
  std::vector<std::unique_ptr<EchoReader>> readers;
  for (const std::string topic : {"pose_estimates", "object_pose", "tf", "markers", "annotated/image_raw",
                                  "table_estimate", "diagnostics"}) {
    readers.push_back(std::make_unique<EchoReader>(
        EchoReaderOptions{domain_.reading, domain_.name_space + "/" + topic, topic_kind_of(topic)},
        [&last, topic](const EchoMessage& m) { last[topic] = nlohmann::json::parse(m.json); }));
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (last.size() < readers.size() && std::chrono::steady_clock::now() < end) {
    for (const auto& reader : readers) reader->poll(std::chrono::milliseconds(10));
  }
  std::vector<std::string> seen;
  for (const auto& [topic, unused] : last) seen.push_back(topic);
  ASSERT_EQ(last.size(), readers.size()) << testing::PrintToString(seen) << daemon.output("stderr");
  EXPECT_EQ(last["tf"]["transforms"][0]["child_frame_id"], "box");
  EXPECT_EQ(last["annotated/image_raw"]["width"], 32);
  EXPECT_EQ(last["table_estimate"]["source"], 2);  // fixed
  EXPECT_GE(last["pose_estimates"]["age_s"].get<double>(), 0);
  EXPECT_LE(last["pose_estimates"]["age_s"].get<double>(), 60);
  EXPECT_EQ(last["diagnostics"]["status"][1]["name"], "sextantd: pipeline");
  EXPECT_EQ(last["diagnostics"]["status"][0]["hardware_id"], domain_.name_space);
}

TEST_F(Sextantd, DoesWhatItIsAskedAndSaysWhatItCannot) {
  ChildProcess daemon =
      start({"--config", write_config("", "loop: true", ", threshold: -1e9, bound: window").string()});
  CommandClient client(domain_.reading, {domain_.name_space});
  int number = 0;
  const auto ask = [&](Command command) {
    command.request_id = "r" + std::to_string(++number);
    const auto answer = client.ask(command, std::chrono::seconds(20));
    EXPECT_TRUE(answer.has_value()) << daemon.output("stderr");
    return answer ? nlohmann::json::parse(answer->json) : nlohmann::json();
  };
  auto answer = ask({"", CommandKind::kDisable});
  EXPECT_EQ(answer["result"], "done");
  EXPECT_EQ(answer["objects"][0]["enabled"], false);
  answer = ask({"", CommandKind::kLook, "box"});
  EXPECT_EQ(answer["result"], "done");
  EXPECT_EQ(answer["look"]["estimates"][0]["object_name"], "box");
  answer = ask({"", CommandKind::kLook, "mug"});
  EXPECT_EQ(answer["result"], "refused");
  EXPECT_THAT(answer["message"].get<std::string>(), HasSubstr("loaded are: box"));

  // A new configuration: a bad one changes nothing, a good one makes everything as in the file.
  write_config("", "loop: true", ", threshold: many, bound: window");
  answer = ask({"", CommandKind::kReload});
  EXPECT_EQ(answer["result"], "failed");
  EXPECT_THAT(answer["message"].get<std::string>(), HasSubstr("detect.threshold is 'many'"));
  EXPECT_EQ(answer["objects"][0]["enabled"], false);
  write_config("log: {level: debug}\n", "loop: true", ", threshold: -5e8, bound: window");
  ObjectModel second = test::make_box_model(1, 10, 5);
  second.name = "crate";
  write_model(second, folder_ / "crate.sxm");
  answer = ask({"", CommandKind::kReload});
  EXPECT_EQ(answer["result"], "done");
  ASSERT_EQ(answer["objects"].size(), 2U);
  EXPECT_EQ(answer["objects"][0]["enabled"], true);
  EXPECT_EQ(answer["objects"][1]["object_name"], "crate");
  EXPECT_EQ(answer["objects"][1]["threshold"], -5e8);
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(Sextantd, SighupReloadsAndRefusesWhatNeedsANewStart) {
  const NotifySocket notify(folder_ / "notify");
  setenv("NOTIFY_SOCKET", notify.path().c_str(), 1);
  ChildProcess daemon = start({"--config", write_config().string()});
  unsetenv("NOTIFY_SOCKET");
  const auto says = [&](const std::string& what) {
    return listen(reader_, [&] { return daemon.output("stderr").find(what) != std::string::npos; });
  };
  ASSERT_TRUE(listen(reader_, [&] { return !messages_.empty(); }));
  write_config("", "loop: true, rate_hz: 5");
  daemon.send(SIGHUP);
  EXPECT_TRUE(says("source.rate_hz cannot change while the daemon runs")) << daemon.output("stderr");
  write_config("log: {level: debug}\n");
  daemon.send(SIGHUP);
  EXPECT_TRUE(says("changed: log.level")) << daemon.output("stderr");
  const std::size_t before = messages_.size();
  EXPECT_TRUE(listen(reader_, [&] { return messages_.size() > before + 2; }));
  EXPECT_TRUE(says("ms after capture"));  // lines of level debug
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
  EXPECT_THAT(notify.messages(), testing::Contains(HasSubstr("RELOADING=1")));
}

TEST_F(Sextantd, WaitsForTheNetworkSaysSoAndRecovers) {
  const NotifySocket notify(folder_ / "notify");
  setenv("NOTIFY_SOCKET", notify.path().c_str(), 1);
  const std::string good = std::getenv("CYCLONEDDS_URI");
  const std::filesystem::path settings = folder_ / "dds.xml";
  // An interface that is not there, as before the network is up.
  const auto write_settings = [&](const std::string& interface) {
    std::ofstream(settings)
        << "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\""
        << interface << "\" multicast=\"false\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
        << "<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address=\"127.0.0.1\"/>"
        << "</Peers><SPDPInterval>1s</SPDPInterval></Discovery></Domain></CycloneDDS>";
  };
  write_settings("no_such0");
  setenv("CYCLONEDDS_URI", ("file://" + settings.string()).c_str(), 1);
  ChildProcess daemon = start({"--config", write_config().string()});
  setenv("CYCLONEDDS_URI", good.c_str(), 1);
  unsetenv("NOTIFY_SOCKET");
  EXPECT_TRUE(
      listen(reader_, [&] { return daemon.output("stderr").find("waiting: DDS") != std::string::npos; }));
  EXPECT_TRUE(messages_.empty());
  write_settings("lo");
  EXPECT_TRUE(listen(reader_, [&] { return !messages_.empty(); })) << daemon.output("stderr");
  EXPECT_THAT(notify.messages(), testing::Contains(HasSubstr("STATUS=waiting: DDS")));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(Sextantd, PublishesOnWhenTheDiskOfTheLogIsFull) {
  std::filesystem::create_symlink("/dev/full", folder_ / "stderr");
  ChildProcess daemon = start({"--config", write_config("log: {level: debug}\n").string()});
  EXPECT_TRUE(listen(reader_, [&] { return messages_.size() >= 6; }));
  EXPECT_TRUE(daemon.running());
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(Sextantd, SigtermEndsItWhileItWaits) {
  setenv(
      "CYCLONEDDS_URI",
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no_such0\"/></Interfaces></General>"
      "</Domain></CycloneDDS>",
      1);
  ChildProcess daemon = start({"--config", write_config().string()});
  EXPECT_TRUE(
      listen(reader_, [&] { return daemon.output("stderr").find("waiting: DDS") != std::string::npos; }));
  daemon.send(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(Sextantd, ANetworkThatDoesNotWorkIsExitCode4Once) {
  setenv(
      "CYCLONEDDS_URI",
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no_such0\"/></Interfaces></General>"
      "</Domain></CycloneDDS>",
      1);
  ChildProcess daemon = start({"--config", write_config().string(), "--once"});
  EXPECT_EQ(daemon.wait(), 4);
  EXPECT_THAT(daemon.output("stderr"), HasSubstr("cannot join domain"));
}

}  // namespace
}  // namespace sextant
