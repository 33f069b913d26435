// SPDX-License-Identifier: Apache-2.0
// config/security as it ships: identities made by the script, one participant of each kind on one wire.
// Domains that differ here are one domain on the network, so that each participant of this process has its
// own identity.
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "runtime/base/error.h"
#include "runtime/publish/command_client.h"
#include "runtime/publish/command_server.h"
#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "runtime/publish/topic_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

constexpr char kFolder[] = SEXTANT_SOURCE_DIR "/config/security/";

int shell(const std::string& command) { return WEXITSTATUS(std::system(command.c_str())); }

class Security : public testing::Test {
 protected:
  Security() {
    if (shell("command -v openssl >/dev/null") != 0) return;
    ready_ =
        shell(std::string(kFolder) + "make-identities " + (folder_ / "good").string() + " >/dev/null") == 0 &&
        shell(std::string(kFolder) + "make-identities " + (folder_ / "evil").string() + " >/dev/null") == 0;
    EXPECT_TRUE(ready_) << "make-identities failed";
    std::random_device random;
    base_ = 1 + random() % 200;
    name_space_ = "secure_" + std::to_string(getpid());
    std::string uri = "file://" SEXTANT_SOURCE_DIR "/config/cyclonedds.xml";
    uri += identity(kDaemon, "good", "sextantd") + identity(kViewer, "good", "viewer") +
           identity(kOperator, "good", "operator") + identity(kWrongCa, "evil", "viewer") +
           domain(kPlain, "");
    setenv("CYCLONEDDS_URI", uri.c_str(), 1);
  }
  void SetUp() override {
    if (!ready_) GTEST_SKIP() << "there is no openssl on this machine";
  }

  static constexpr unsigned kDaemon = 0, kViewer = 1, kOperator = 2, kWrongCa = 3, kPlain = 4;
  unsigned id(unsigned who) const { return base_ + who; }

  /// A section of settings for one domain: base_ on the wire.
  std::string domain(unsigned who, const std::string& security) const {
    return ",<CycloneDDS><Domain Id=\"" + std::to_string(id(who)) + "\"><Discovery><ExternalDomainId>" +
           std::to_string(base_) + "</ExternalDomainId></Discovery>" + security + "</Domain></CycloneDDS>";
  }
  /// The shipped profile with its variables filled in.
  std::string identity(unsigned who, const std::string& ca, const std::string& name) const {
    std::stringstream stream;
    stream << std::ifstream(std::string(kFolder) + "cyclonedds-secure.xml").rdbuf();
    std::string text = stream.str();
    const auto replace_all = [&](const std::string& what, const std::string& by) {
      for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at))
        text.replace(at, what.size(), by);
    };
    replace_all("${SEXTANT_SECURITY}", (folder_ / ca).string());
    replace_all("${SEXTANT_IDENTITY}", name);
    const auto begin = text.find("<Security>");
    const auto end = text.find("</Security>") + std::string("</Security>").size();
    return domain(who, text.substr(begin, end - begin));
  }
  PublisherOptions options() const {
    PublisherOptions o;
    o.domain = id(kDaemon);
    o.name_space = name_space_;
    o.max_age_ms = 60000;
    return o;
  }
  std::string topic(const std::string& name) const { return "rt/" + name_space_ + "/" + name; }

  TemporaryFolder folder_;
  bool ready_ = false;
  unsigned base_ = 1;
  std::string name_space_;
};

TEST_F(Security, OnlyOurIdentitiesGetPoses) {
  Publisher publisher(options());
  const QosPointer qos = make_qos({.reliable = true, .depth = 10});
  const auto& type = *topic_type<Detection3DArrayMessage>().descriptor;
  const RawReader viewer(id(kViewer), type, topic("detections"), qos.get());
  const RawReader stranger(id(kPlain), type, topic("detections"), qos.get());
  const RawReader wrong_ca(id(kWrongCa), type, topic("detections"), qos.get());
  ASSERT_TRUE(eventually([&] { return viewer.matched() == 1 && publisher.matched_readers() == 1; }));
  int received = 0;
  for (unsigned i = 0; i < 20; ++i) {
    publisher.publish(random_result(i, 2));
    EXPECT_TRUE(publisher.wait_for_acknowledgements(std::chrono::seconds(10)));
    received += viewer.take();
  }
  EXPECT_TRUE(eventually([&] { return (received += viewer.take()) >= 20; }));
  EXPECT_EQ(received, 20);
  // They had the same time and got nothing.
  EXPECT_EQ(stranger.matched() + stranger.take(), 0);
  EXPECT_EQ(wrong_ca.matched() + wrong_ca.take(), 0);
  EXPECT_EQ(publisher.matched_readers(), 1);
}

TEST_F(Security, AnOperatorMayCommandAndAViewerMayNot) {
  Publisher publisher(options());
  CommandServer server(publisher.participant(), {name_space_});
  const DdsEntity viewer = create_participant(id(kViewer));
  EXPECT_THROW(TopicWriter(viewer.get(), topic("command"), topic_type<CommandMessage>(), {}), DeviceError);
  EXPECT_THROW(TopicWriter(viewer.get(), topic("detections"), topic_type<Detection3DArrayMessage>(), {}),
               DeviceError);
  const DdsEntity op = create_participant(id(kOperator));
  EXPECT_THROW(TopicWriter(op.get(), topic("detections"), topic_type<Detection3DArrayMessage>(), {}),
               DeviceError);

  std::atomic<bool> stop = false;
  std::atomic<int> served = 0;
  std::thread daemon([&] {
    while (!stop) {
      for (const Command& command : server.poll(std::chrono::milliseconds(20))) {
        CommandAnswer answer;
        answer.request_id = command.request_id;
        server.answer(answer);
        ++served;
      }
    }
  });
  CommandClient client(id(kOperator), {name_space_});
  EXPECT_TRUE(client.ask({"from the operator", CommandKind::kStatus}, std::chrono::seconds(20)).has_value());
  CommandClient stranger(id(kPlain), {name_space_});
  EXPECT_FALSE(stranger.ask({"from a stranger", CommandKind::kStatus}, std::chrono::seconds(2)).has_value());
  EXPECT_THROW(CommandClient(id(kViewer), {name_space_}), DeviceError);
  stop = true;
  daemon.join();
  EXPECT_EQ(served, 1);
}

TEST_F(Security, TheScriptIsSafeToRepeatAndRefusesNonsense) {
  const std::string script = std::string(kFolder) + "make-identities ";
  const auto contents = [&](const std::string& file) {
    std::stringstream stream;
    stream << std::ifstream(folder_ / file).rdbuf();
    return stream.str();
  };
  const std::string ca = contents("good/ca.pem"), cert = contents("good/viewer/cert.pem");
  EXPECT_FALSE(ca.empty());
  EXPECT_EQ(shell(script + (folder_ / "good").string() + " viewer:consumer extra:camera >/dev/null"), 0);
  EXPECT_EQ(contents("good/ca.pem"), ca);
  EXPECT_EQ(contents("good/viewer/cert.pem"), cert);
  EXPECT_FALSE(contents("good/extra/cert.pem").empty());
  const auto mode = std::filesystem::status(folder_.path() / "good" / "extra" / "key.pem").permissions();
  EXPECT_EQ(mode & (std::filesystem::perms::group_all | std::filesystem::perms::others_all),
            std::filesystem::perms::none);
  EXPECT_EQ(shell(script + "2>/dev/null"), 2);
  EXPECT_EQ(shell(script + (folder_ / "good").string() + " a:king >/dev/null 2>&1"), 2);
  EXPECT_EQ(shell(script + (folder_ / "good").string() + " ../a:daemon >/dev/null 2>&1"), 2);
}

}  // namespace
}  // namespace sextant
