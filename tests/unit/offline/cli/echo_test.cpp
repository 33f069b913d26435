// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/echo.h"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/publish/publisher.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"

namespace sextant {
namespace {

/// Publishes every 10 ms, as a daemon would, until it is destroyed.
class BusyPublisher {
 public:
  explicit BusyPublisher(const DdsTestDomain& domain) : publisher_({domain.writing, domain.name_space}) {
    thread_ = std::thread([this] {
      for (unsigned i = 0; !stop_; ++i) {
        publisher_.publish(random_result(i, 2));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    });
  }
  ~BusyPublisher() {
    stop_ = true;
    thread_.join();
  }
  BusyPublisher(const BusyPublisher&) = delete;
  BusyPublisher& operator=(const BusyPublisher&) = delete;

 private:
  std::atomic<bool> stop_ = false;
  Publisher publisher_;
  std::thread thread_;
};

struct Output {
  std::FILE* file = std::tmpfile();
  ~Output() { std::fclose(file); }
  std::vector<std::string> lines() const {
    std::rewind(file);
    std::string all;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) all += static_cast<char>(c);
    std::vector<std::string> lines;
    std::istringstream stream(all);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }
};

EchoOptions options_of(const DdsTestDomain& domain, const std::string& topic) {
  EchoOptions options;
  options.domain = domain.reading;
  options.topic = domain.name_space + "/" + topic;
  options.timeout_s = 20;
  options.count = 2;
  options.require = true;
  return options;
}

TEST(Echo, PrintsExactlyTheCountAsJsonLines) {
  const DdsTestDomain domain;
  const BusyPublisher publisher(domain);
  for (const std::string topic : {"pose_estimates", "detections", "object_pose"}) {
    const Output out;
    EchoOptions options = options_of(domain, topic);
    options.json = true;
    EXPECT_EQ(run_echo(options, out.file), 0);
    const auto lines = out.lines();
    ASSERT_EQ(lines.size(), 2U) << topic;
    for (const std::string& line : lines) {
      EXPECT_EQ(nlohmann::json::parse(line)["header"]["frame_id"], "camera_color_optical_frame");
    }
  }
}

TEST(Echo, PrintsTextForPeople) {
  const DdsTestDomain domain;
  const BusyPublisher publisher(domain);
  const Output out;
  EXPECT_EQ(run_echo(options_of(domain, "pose_estimates"), out.file), 0);
  EXPECT_THAT(out.lines(), testing::Contains(testing::HasSubstr("object_1 (2): bounded, score")));
  EXPECT_THAT(out.lines(), testing::Contains(testing::HasSubstr("object missing (99): absent")));
}

TEST(Echo, SilenceIsAnErrorOnlyWhereAMessageIsRequired) {
  const DdsTestDomain domain;
  const Output out;
  EchoOptions options = options_of(domain, "pose_estimates");
  options.timeout_s = 0.3;
  EXPECT_EQ(run_echo(options, out.file), 1);
  options.require = false;
  EXPECT_EQ(run_echo(options, out.file), 0);
  EXPECT_THAT(out.lines(), testing::IsEmpty());
}

TEST(Echo, ASignalEndsIt) {
  const DdsTestDomain domain;
  const Output out;
  EchoOptions options = options_of(domain, "pose_estimates");
  options.timeout_s = 0;
  options.require = false;
  // A handler that does nothing, so that a signal before echo's own handler stands kills nobody.
  const auto old = std::signal(SIGTERM, [](int) {});
  std::atomic<bool> ended = false;
  std::thread sender([&] {
    while (!ended) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      kill(getpid(), SIGTERM);
    }
  });
  EXPECT_EQ(run_echo(options, out.file), 0);
  ended = true;
  sender.join();
  std::signal(SIGTERM, old);
}

TEST(Echo, ImpossibleOptionsAreWrongUse) {
  const Output out;
  EchoOptions options;
  options.topic = "something";
  EXPECT_THROW(run_echo(options, out.file), UsageError);
  options = {};
  options.domain = 231;
  EXPECT_THROW(run_echo(options, out.file), UsageError);
  options = {};
  options.count = -1;
  EXPECT_THROW(run_echo(options, out.file), UsageError);
}

TEST(Echo, BrokenSettingsAreANetworkError) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no_such0\"/>"
         "</Interfaces></General></Domain></CycloneDDS>",
         1);
  const Output out;
  EchoOptions options;
  options.domain = 213;
  EXPECT_THROW(run_echo(options, out.file), DeviceError);
}

TEST(EchoCommand, ParsesItsFlagsAndStoresTheExitCode) {
  const DdsTestDomain domain;
  CLI::App app;
  int exit_code = -1;
  add_echo_command(app, exit_code);
  const std::string reading = std::to_string(domain.reading);
  app.parse("echo --topic " + domain.name_space + "/x --type detections --domain " + reading +
            " --timeout-s 0.2 --require --json");
  EXPECT_EQ(exit_code, 1);
  EXPECT_THROW(app.parse("echo --domain 231"), CLI::ParseError);
  EXPECT_THROW(app.parse("echo --type pictures"), CLI::ParseError);
  EXPECT_THROW(app.parse("echo --nonsense"), CLI::ParseError);
}

}  // namespace
}  // namespace sextant
