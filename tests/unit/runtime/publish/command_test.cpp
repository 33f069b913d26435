// SPDX-License-Identifier: Apache-2.0
// Commands over the real DDS and loopback UDP: asked again until answered, done once, strangers' nonsense
// ignored.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "runtime/publish/command_client.h"
#include "runtime/publish/command_messages.h"
#include "runtime/publish/command_server.h"
#include "runtime/publish/echo_reader.h"
#include "runtime/publish/topic_reader.h"
#include "runtime/publish/topic_writer.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A daemon's command side in a thread; what it got is in `commands` once it is stopped.
class Answering {
 public:
  using Handle = std::function<CommandAnswer(const Command&)>;

  Answering(const DdsTestDomain& domain, Handle handle)
      : participant_(create_participant(domain.writing)),
        server_(participant_.get(), {domain.name_space},
                [this](const std::string& w) { warnings.push_back(w); }),
        handle_(std::move(handle)),
        thread_([this] {
          while (!stop_) {
            for (const Command& command : server_.poll(milliseconds(20))) {
              commands.push_back(command);
              server_.answer(handle_(command));
            }
          }
        }) {}
  ~Answering() { stop(); }
  Answering(const Answering&) = delete;
  Answering& operator=(const Answering&) = delete;

  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::vector<Command> commands;
  std::vector<std::string> warnings;

 private:
  DdsEntity participant_;
  CommandServer server_;
  Handle handle_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

CommandAnswer done(const Command& command) {
  CommandAnswer answer;
  answer.request_id = command.request_id;
  answer.kind = command.kind;
  answer.message = "done";
  return answer;
}

TEST(Commands, HaveNames) {
  EXPECT_EQ(to_string(CommandKind::kStatus), "status");
  EXPECT_EQ(to_string(CommandKind::kReload), "reload");
  EXPECT_EQ(to_string(static_cast<CommandKind>(200)), "kind 200");
}

TEST(Commands, ArriveEqualAndSoDoTheirAnswers) {
  const DdsTestDomain domain;
  const FrameResult look = random_result(3, 2);
  Answering daemon(domain, [&](const Command& command) {
    CommandAnswer answer = done(command);
    answer.objects = {{4, "mug", "/m/mug.sxm", true, -3.5}, {5, "can", "/m/can.sxm", false, std::nullopt}};
    answer.region = {1, 2, 300, 400};
    answer.deadline_ms = 250;
    answer.look = look;
    answer.look_age_s = 0.5;
    return answer;
  });
  CommandClient client(domain.reading, {domain.name_space});
  const Command sent{"id 1", CommandKind::kLook, "mug", "file.sxm", -2.25, {1, 2, 3, 4}};
  const auto answer = client.ask(sent, seconds(20));
  daemon.stop();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, CommandResult::kDone);
  EXPECT_TRUE(answer->found);
  const auto json = nlohmann::json::parse(answer->json);
  EXPECT_EQ(json["request_id"], "id 1");
  EXPECT_EQ(json["result"], "done");
  EXPECT_EQ(json["objects"][0]["object_name"], "mug");
  EXPECT_EQ(json["objects"][0]["threshold"], -3.5);
  EXPECT_EQ(json["objects"][0]["enabled"], true);
  EXPECT_TRUE(json["objects"][1]["threshold"].is_null());
  EXPECT_EQ(json["region"], nlohmann::json::parse("[1, 2, 300, 400]"));
  EXPECT_EQ(json["deadline_ms"], 250);
  EXPECT_EQ(json["look"]["estimates"].size(), 2U);
  EXPECT_EQ(json["look"]["estimates"][1]["log_score"], look.estimates[1].log_score);
  EXPECT_EQ(json["look"]["age_s"], 0.5);
  EXPECT_THAT(answer->text, testing::HasSubstr("can (5): disabled, threshold auto"));
  ASSERT_EQ(daemon.commands.size(), 1U);
  EXPECT_EQ(daemon.commands[0].kind, CommandKind::kLook);
  EXPECT_EQ(daemon.commands[0].object_name, "mug");
  EXPECT_EQ(daemon.commands[0].model_file, "file.sxm");
  EXPECT_EQ(daemon.commands[0].value, -2.25);
  EXPECT_EQ(daemon.commands[0].region, (ImageRegion{1, 2, 3, 4}));
}

TEST(Commands, ASecondSendingIsAnsweredAgainButDoneOnce) {
  const DdsTestDomain domain;
  Answering daemon(domain, done);
  CommandClient first(domain.reading, {domain.name_space});
  const Command command{"same", CommandKind::kStatus};
  ASSERT_TRUE(first.ask(command, seconds(20)).has_value());
  // Another asker with the same id, as one would be that lost the answer.
  CommandClient second(domain.reading, {domain.name_space});
  EXPECT_TRUE(second.ask(command, seconds(20)).has_value());
  daemon.stop();
  EXPECT_EQ(daemon.commands.size(), 1U);
}

TEST(Commands, AReaderThatGetsNoAnswerIsMadeAnew) {
  const DdsTestDomain domain;
  const DdsEntity participant = create_participant(domain.writing);
  const TopicReader commands(participant.get(), "rt/" + domain.name_space + "/command",
                             topic_type<CommandMessage>(), {.reliable = false});
  const TopicWriter answers(participant.get(), "rt/" + domain.name_space + "/command_answer",
                            topic_type<CommandAnswerMessage>(), {});
  std::atomic<bool> stop = false;
  std::uint32_t readers = 0;
  // A daemon whose first reader is deaf: it answers the second one only.
  std::thread daemon([&] {
    while (!stop) {
      commands.wait(milliseconds(20));
      dds_publication_matched_status_t status{};
      dds_get_publication_matched_status(answers.handle(), &status);
      readers = status.total_count;
      commands.take([&](const void* sample) {
        if (readers < 2) return;
        const CommandAnswer answer = done(to_command(*static_cast<const CommandMessage*>(sample)));
        const AnswerBuilder builder(answer);
        answers.write(&builder.message());
      });
    }
  });
  CommandClient client(domain.reading, {domain.name_space});
  EXPECT_TRUE(client.ask({"x", CommandKind::kStatus}, seconds(20)).has_value());
  stop = true;
  daemon.join();
  EXPECT_EQ(readers, 2U);
}

TEST(Commands, CanBeOverheard) {
  const DdsTestDomain domain;
  Answering daemon(domain, done);
  std::vector<std::string> texts, jsons;
  const auto keep = [&](const EchoMessage& m) {
    texts.push_back(m.text);
    jsons.push_back(m.json);
  };
  EchoReader commands({domain.reading, domain.name_space + "/command", TopicKind::kCommand}, keep);
  EchoReader answers({domain.reading, domain.name_space + "/command_answer", TopicKind::kCommandAnswer},
                     keep);
  CommandClient client(domain.reading, {domain.name_space});
  for (int i = 0; texts.size() < 2 && i < 100; ++i) {
    texts.clear();
    jsons.clear();
    const Command sent{std::to_string(i), CommandKind::kThreshold, "mug", "", -2.5};
    ASSERT_TRUE(client.ask(sent, seconds(20)).has_value());
    commands.poll(milliseconds(200));
    answers.poll(milliseconds(200));
  }
  ASSERT_GE(texts.size(), 2U);
  EXPECT_THAT(texts[0], testing::StartsWith("threshold ("));
  EXPECT_THAT(texts[0], testing::HasSubstr("object 'mug', model '', value -2.5"));
  EXPECT_EQ(nlohmann::json::parse(jsons[0])["value"], -2.5);
  EXPECT_THAT(texts.back(), testing::StartsWith("done: done"));
}

TEST(Commands, NobodyAnswersWithoutADaemon) {
  const DdsTestDomain domain;
  CommandClient client(domain.reading, {domain.name_space});
  EXPECT_EQ(client.matched_daemons(), 0);
  EXPECT_FALSE(client.ask({"x", CommandKind::kStatus}, milliseconds(300)).has_value());
  EXPECT_FALSE(client.ask({"x", CommandKind::kStatus}, seconds(600), [] { return true; }).has_value());
}

TEST(Commands, NonsenseIsReportedAndTheNextOneServed) {
  const DdsTestDomain domain;
  Answering daemon(domain, done);
  const DdsEntity participant = create_participant(domain.reading);
  const TopicWriter stranger(participant.get(), "rt/" + domain.name_space + "/command",
                             topic_type<CommandMessage>(), {});
  ASSERT_TRUE(eventually([&] { return stranger.matched_readers() > 0; }));
  const std::string huge(5000, 'x');
  for (const std::string& id : {std::string(), huge, std::string("\x1b[2J")}) {
    const Command nonsense{id, CommandKind::kStatus};
    const CommandMessage message = to_message(nonsense);
    EXPECT_TRUE(stranger.write(&message));
  }
  CommandClient client(domain.reading, {domain.name_space});
  EXPECT_TRUE(client.ask({"good", CommandKind::kStatus}, seconds(20)).has_value());
  daemon.stop();
  EXPECT_EQ(daemon.commands.size(), 1U);
  EXPECT_THAT(daemon.warnings, testing::Contains(testing::HasSubstr("message ignored")));
}

}  // namespace
}  // namespace sextant
