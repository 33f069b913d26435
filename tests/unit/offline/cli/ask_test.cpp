// SPDX-License-Identifier: Apache-2.0
// `sextant ask` as a shell calls it, against a real command server over loopback UDP.
#include "offline/cli/ask.h"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/publish/command_server.h"
#include "runtime/publish/dds_entity.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"

namespace sextant {
namespace {

using testing::HasSubstr;

class Ask : public testing::Test {
 protected:
  Ask() {
    CommandServerOptions topics;
    topics.name_space = domain_.name_space;
    topics.command_topic = "orders";
    topics.answer_topic = "replies";
    server_ = std::make_unique<CommandServer>(participant_.get(), topics);
    thread_ = std::thread([this] {
      while (!stop_) {
        for (const Command& command : server_->poll(std::chrono::milliseconds(20))) {
          CommandAnswer answer;
          {
            const std::lock_guard lock(mutex_);
            asked_ = command;
            answer = answer_;
          }
          answer.request_id = command.request_id;
          answer.kind = command.kind;
          server_->answer(answer);
        }
      }
    });
  }
  ~Ask() override {
    stop_ = true;
    thread_.join();
    unsetenv("ROS_DOMAIN_ID");
  }

  /// Runs `sextant ask WORDS...` in the daemon's domain and namespace; its output is in out_.
  int ask(std::vector<std::string> words) {
    for (const std::string& more :
         {std::string("--domain"), std::to_string(domain_.reading), std::string("--namespace"),
          domain_.name_space, std::string("--command-topic"), std::string("orders"),
          std::string("--answer-topic"), std::string("replies")}) {
      words.push_back(more);
    }
    words.insert(words.begin(), "ask");
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    CLI::App app("sextant");
    int exit_code = -1;
    add_ask_command(app, exit_code);
    testing::internal::CaptureStdout();
    try {
      app.parse(words);
    } catch (...) {
      out_ = testing::internal::GetCapturedStdout();
      throw;
    }
    out_ = testing::internal::GetCapturedStdout();
    return exit_code;
  }
  void will_answer(CommandResult result, const std::string& message) {
    const std::lock_guard lock(mutex_);
    answer_.result = result;
    answer_.message = message;
  }

  DdsTestDomain domain_;
  DdsEntity participant_ = create_participant(domain_.writing);
  std::unique_ptr<CommandServer> server_;
  std::mutex mutex_;  // guards the two below
  Command asked_;
  CommandAnswer answer_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
  std::string out_;
};

TEST_F(Ask, SendsWhatTheWordsSay) {
  EXPECT_EQ(ask({"region", "1", "2", "300", "400"}), 0);
  EXPECT_EQ(asked_.kind, CommandKind::kRegion);
  EXPECT_EQ(asked_.region, (ImageRegion{1, 2, 300, 400}));
  EXPECT_EQ(ask({"threshold", "-2.5", "mug"}), 0);
  EXPECT_EQ(asked_.kind, CommandKind::kThreshold);
  EXPECT_EQ(asked_.value, -2.5);
  EXPECT_EQ(asked_.object_name, "mug");
  EXPECT_EQ(ask({"deadline", "auto"}), 0);
  EXPECT_TRUE(std::isnan(asked_.value));
  EXPECT_EQ(ask({"load", "mug.sxm"}), 0);
  EXPECT_EQ(asked_.model_file, "mug.sxm");
  EXPECT_EQ(ask({"disable"}), 0);
  EXPECT_EQ(asked_.kind, CommandKind::kDisable);
  EXPECT_EQ(asked_.object_name, "");
}

TEST_F(Ask, ExitCodesAreThoseOfTheManual) {
  will_answer(CommandResult::kRefused, "no such thing");
  EXPECT_EQ(ask({"unload", "mug"}), 2);
  EXPECT_THAT(out_, HasSubstr("refused: no such thing"));
  will_answer(CommandResult::kFailed, "the file is damaged");
  EXPECT_EQ(ask({"reload", "--json"}), 3);
  EXPECT_EQ(nlohmann::json::parse(out_)["message"], "the file is damaged");
  will_answer(CommandResult::kDone, "looked");
  EXPECT_EQ(ask({"look"}), 0);
  EXPECT_EQ(ask({"look", "--require"}), 1);
  {
    const std::lock_guard lock(mutex_);
    answer_.look = random_result(1, 2);
  }
  EXPECT_EQ(ask({"look", "--require"}), 0);
  EXPECT_THROW(ask({"threshold", "much"}), UsageError);
  EXPECT_THROW(ask({"threshold", "nan"}), UsageError);
  EXPECT_THROW(ask({"status", "--timeout-s", "0"}), UsageError);
  EXPECT_THROW(ask({"region", "1", "2", "3"}), CLI::ParseError);
  EXPECT_THROW(ask({}), CLI::ParseError);
}

TEST_F(Ask, TheCommandLineGoesBeforeTheEnvironment) {
  setenv("ROS_DOMAIN_ID", std::to_string(domain_.reading + 7).c_str(), 1);
  EXPECT_EQ(ask({"status"}), 0);
  EXPECT_EQ(asked_.kind, CommandKind::kStatus);
}

TEST_F(Ask, NoDaemonIsADevicesFailure) {
  stop_ = true;
  thread_.join();
  server_.reset();
  thread_ = std::thread([] {});
  try {
    ask({"status", "--timeout-s", "0.2"});
    FAIL() << "an answer from nobody";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no sextantd is there"));
  }
}

}  // namespace
}  // namespace sextant
