// SPDX-License-Identifier: Apache-2.0
// The life of the daemon in one process: real publisher, scripted source.
#include "runtime/daemon/daemon.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <future>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/daemon/last_resort.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/daemon/notify_socket.h"
#include "tests/unit/runtime/daemon/scripted_source.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"

namespace sextant {
namespace {

using namespace std::chrono_literals;

class Daemon : public testing::Test {
 protected:
  Daemon() {
    setenv("NOTIFY_SOCKET", notify_.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "80000", 1);
    run_.pipeline.max_age_ms = 60000;
    run_.once_wait = 100ms;
    run_.abandon = [this] { abandoned_ = true; };
  }
  ~Daemon() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }
  PublisherOptions publishing() const {
    PublisherOptions options;
    options.domain = domain_.writing;
    options.name_space = domain_.name_space;
    return options;
  }

  SignalWaiter signals_;  // before any thread
  TemporaryFolder folder_;
  NotifySocket notify_{folder_ / "notify"};
  DdsTestDomain domain_;
  DaemonRun run_;
  std::atomic<bool> abandoned_ = false;
};

TEST_F(Daemon, EndsWithItsSourceAndTellsSystemd) {
  ScriptedSource source(20, [](RgbdFrame&) { std::this_thread::sleep_for(10ms); });
  Publisher publisher(publishing());
  run_.pipeline.skip_none = true;
  run_daemon(source, empty_result, publisher, signals_, run_);
  EXPECT_EQ(publisher.statistics().published, 20U);
  const auto messages = notify_.messages();
  ASSERT_THAT(messages, testing::SizeIs(testing::Ge(3U)));
  EXPECT_THAT(messages, testing::Contains("READY=1"));
  EXPECT_THAT(messages, testing::Contains("WATCHDOG=1"));
  EXPECT_THAT(messages, testing::Contains("STOPPING=1"));
  EXPECT_FALSE(abandoned_);
}

TEST_F(Daemon, TheWatchdogStarvesWhenFramesFail) {
  ScriptedSource source(20, [](RgbdFrame&) { std::this_thread::sleep_for(10ms); });
  Publisher publisher(publishing());
  run_.pipeline.skip_none = true;
  const auto fails = [](const RgbdFrame&) -> FrameResult { throw InputError("image", "no table"); };
  run_daemon(source, fails, publisher, signals_, run_);
  EXPECT_EQ(publisher.statistics().published, 0U);
  EXPECT_THAT(notify_.messages(), testing::Contains("READY=1"));
  EXPECT_THAT(notify_.messages(), testing::Not(testing::Contains("WATCHDOG=1")));
}

TEST_F(Daemon, LivesOnWhileItsCameraIsAway) {
  ScriptedSource source(0);
  source.lose_device();
  Publisher publisher(publishing());
  std::vector<std::string> messages;
  std::atomic<bool> fed = false;
  std::thread reader([&] {
    // What systemd would read; the signal comes when its watchdog has been fed without a single frame.
    while (!fed) {
      for (std::string& message : notify_.messages()) messages.push_back(std::move(message));
      fed = std::find(messages.begin(), messages.end(), "WATCHDOG=1") != messages.end();
    }
    kill(getpid(), SIGTERM);
  });
  run_daemon(source, empty_result, publisher, signals_, run_);
  reader.join();
  EXPECT_EQ(publisher.statistics().published, 0U);
  EXPECT_THAT(messages, testing::Contains("STATUS=waiting for frames: the scripted device is away"));
}

TEST_F(Daemon, EndsOnSigtermAndSigint) {
  for (const int signal : {SIGTERM, SIGINT}) {
    ScriptedSource source(1000000, [](RgbdFrame&) { std::this_thread::sleep_for(5ms); });
    Publisher publisher(publishing());
    std::thread sender([&] {
      while (publisher.statistics().published < 4) std::this_thread::sleep_for(1ms);
      kill(getpid(), signal);
    });
    run_daemon(source, empty_result, publisher, signals_, run_);
    sender.join();
    EXPECT_GE(publisher.statistics().published, 4U);
    EXPECT_FALSE(abandoned_);
  }
}

TEST_F(Daemon, LeavesADetectionThatDoesNotEnd) {
  ScriptedSource source(1);
  source.run_forever();
  Publisher publisher(publishing());
  std::atomic<bool> let_go = false;
  run_.abandon = [&] {
    abandoned_ = true;
    let_go = true;
  };
  std::atomic<bool> detecting = false;
  std::thread sender([&] {
    while (!detecting) std::this_thread::sleep_for(1ms);
    kill(getpid(), SIGTERM);
  });
  const auto detect = [&](const RgbdFrame& frame) {
    detecting = true;
    while (!let_go) std::this_thread::sleep_for(1ms);
    return empty_result(frame);
  };
  run_daemon(source, detect, publisher, signals_, run_);
  sender.join();
  EXPECT_TRUE(abandoned_);
  EXPECT_EQ(publisher.statistics().published, 0U);
}

TEST_F(Daemon, AReloadThatTakesItsTimeHoldsTheEndUpAsLittleAsFrames) {
  ScriptedSource source(1000000, [](RgbdFrame&) { std::this_thread::sleep_for(5ms); });
  Publisher publisher(publishing());
  std::atomic<int> reloads = 0;
  std::atomic<bool> let_go = false;
  run_.reload = [&]() -> std::string {
    ++reloads;
    while (!let_go) std::this_thread::sleep_for(1ms);
    throw InputError("sextantd.yaml:1", "nonsense");
  };
  run_.ending = [&] { let_go = true; };  // is called although the reload is under way
  std::thread sender([&] {
    kill(getpid(), SIGHUP);
    while (reloads == 0) std::this_thread::sleep_for(1ms);
    const std::uint64_t before = publisher.statistics().published;
    while (publisher.statistics().published < before + 5) std::this_thread::sleep_for(1ms);
    kill(getpid(), SIGTERM);
  });
  run_daemon(source, empty_result, publisher, signals_, run_);
  sender.join();
  EXPECT_EQ(reloads, 1);
  EXPECT_THAT(notify_.messages(), testing::Contains(testing::HasSubstr("RELOADING=1")));
}

TEST(LastResort, IsTakenOnlyWhenTheTimeIsOver) {
  std::promise<void> left;
  const LastResort soon(1ms, [&] { left.set_value(); });
  left.get_future().wait();
  std::atomic<bool> taken = false;
  {
    const LastResort in_time(1h, [&] { taken = true; });
  }
  EXPECT_FALSE(taken);
}

TEST_F(Daemon, ADeadDeviceIsTheCallersError) {
  ScriptedSource source(10, [](RgbdFrame&) { throw DeviceError("camera", "it was unplugged"); });
  Publisher publisher(publishing());
  EXPECT_THROW(run_daemon(source, empty_result, publisher, signals_, run_), DeviceError);
}

}  // namespace
}  // namespace sextant
