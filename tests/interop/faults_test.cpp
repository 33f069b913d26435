// SPDX-License-Identifier: Apache-2.0
// What the network and other participants do to us, and that poses go on: docs/run-on-your-robot.md, "When
// things go wrong".
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <random>
#include <thread>

#include "runtime/publish/command_client.h"
#include "runtime/publish/command_server.h"
#include "runtime/publish/dds_log.h"
#include "runtime/publish/dds_settings.h"
#include "runtime/publish/echo_reader.h"
#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "tests/integration/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/runtime/publish/dds_test_domain.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

PublisherOptions options_of(const DdsTestDomain& domain) {
  PublisherOptions options;
  options.domain = domain.writing;
  options.name_space = domain.name_space;
  options.max_age_ms = 60000;
  return options;
}

/// A UDP socket on loopback that pretends to be a participant of the domain.
class Impostor {
 public:
  explicit Impostor(unsigned domain) : domain_(domain), socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    for (int index = 31; index > 16; --index) {
      sockaddr_in address = of(port(index, 0));
      if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) break;
    }
    const timeval wait{0, 50'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
  }
  ~Impostor() { close(socket_); }
  Impostor(const Impostor&) = delete;
  Impostor& operator=(const Impostor&) = delete;

  /// A datagram that a real participant sent to us (they announce themselves to every index), or nothing.
  std::vector<std::uint8_t> overhear() const {
    std::vector<std::uint8_t> packet(65536);
    const ssize_t n = recv(socket_, packet.data(), packet.size(), 0);
    packet.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return packet;
  }
  /// To the discovery and the data port of every participant index that tests use.
  void send_to_all(const std::vector<std::uint8_t>& packet) const {
    for (int index = 0; index < 8; ++index) {
      for (const int kind : {0, 1}) {
        const sockaddr_in to = of(port(index, kind));
        sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
      }
    }
  }

 private:
  int port(int index, int kind) const {
    return 7400 + 250 * static_cast<int>(domain_) + 10 + 2 * index + kind;
  }
  static sockaddr_in of(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  unsigned domain_;
  int socket_;
};

TEST(Faults, MalformedTrafficStopsNeitherPosesNorCommands) {
  const DdsTestDomain domain;
  std::atomic<int> log_lines = 0;
  const DdsLog log([&](const std::string&) { ++log_lines; });
  Publisher publisher(options_of(domain));
  CommandServer server(publisher.participant(), {domain.name_space});
  std::atomic<int> received = 0;
  EchoReader reader({domain.reading, domain.name_space + "/pose_estimates", TopicKind::kPoseEstimates},
                    [&](const EchoMessage&) { ++received; });
  ASSERT_TRUE(publisher.wait_for_reader(seconds(20)));

  const Impostor impostor(domain.writing);
  std::vector<std::vector<std::uint8_t>> real;
  for (int i = 0; i < 100 && real.size() < 4; ++i) {
    auto packet = impostor.overhear();
    if (packet.size() > 20) real.push_back(std::move(packet));
  }
  ASSERT_FALSE(real.empty()) << "nobody announced itself";
  std::mt19937 random(7);
  const auto end = std::chrono::steady_clock::now() + seconds(2);
  unsigned frame = 0;
  for (int round = 0; std::chrono::steady_clock::now() < end; ++round) {
    std::vector<std::uint8_t> packet;
    if (round % 3 == 0) {  // noise behind a good header
      packet = {'R', 'T', 'P', 'S', 2, 1, 1, 0x10};
      packet.resize(20 + random() % 500);
      std::generate(packet.begin() + 8, packet.end(), [&] { return static_cast<std::uint8_t>(random()); });
    } else {  // a real one with some bytes or its end changed
      packet = real[random() % real.size()];
      for (unsigned k = 0; k <= random() % 8; ++k)
        packet[random() % packet.size()] = static_cast<std::uint8_t>(random());
      if (round % 3 == 2) packet.resize(1 + random() % packet.size());
    }
    impostor.send_to_all(packet);
    if (round % 20 == 0) {
      publisher.publish(random_result(++frame, 1));
      reader.poll(milliseconds(0));
    }
  }
  // Whoever listened goes on, whoever comes afterwards too, and commands are answered.
  const int before = received;
  EXPECT_TRUE(eventually([&] {
    publisher.publish(random_result(++frame, 1));
    return reader.poll(milliseconds(5)) > 0;
  })) << "the old reader is starved; it had "
      << before;
  int fresh = 0;
  EchoReader late({domain.reading, domain.name_space + "/object_pose", TopicKind::kObjectPose},
                  [&](const EchoMessage&) { ++fresh; });
  EXPECT_TRUE(eventually([&] {
    publisher.publish(random_result(++frame, 1));
    late.poll(milliseconds(5));
    return fresh > 0;
  }));
  std::atomic<bool> stop = false;
  std::thread serving([&] {
    while (!stop) {
      for (const Command& command : server.poll(milliseconds(20))) {
        CommandAnswer answer;
        answer.request_id = command.request_id;
        server.answer(answer);
      }
    }
  });
  CommandClient client(domain.reading, {domain.name_space});
  EXPECT_TRUE(client.ask({"after the storm", CommandKind::kStatus}, seconds(20)).has_value());
  stop = true;
  serving.join();
  EXPECT_LT(log_lines, 100);  // a flood of warnings does not become a flood of lines
}

/// `poses`: in each message.
void stop_and_kill_a_reliable_reader(const DdsTestDomain& domain, int poses) {
  const TemporaryFolder folder;
  Publisher publisher(options_of(domain));
  ChildProcess stranger({DDS_HELPER, "listen", std::to_string(domain.writing), domain.name_space},
                        folder.path());
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 1; }));
  const QosPointer qos = make_qos({.reliable = true, .depth = 1000});
  const RawReader friendly(domain.reading, *topic_type<Detection3DArrayMessage>().descriptor,
                           "rt/" + domain.name_space + "/detections", qos.get());
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 2 && friendly.matched() == 1; }));
  stranger.send(SIGSTOP);
  int received = 0;
  for (int i = 0; i < 300; ++i) {
    publisher.publish(random_result(static_cast<unsigned>(i), poses));
    // Waited for: a reader that a busy machine keeps waiting may miss what the history no longer holds.
    ASSERT_TRUE(eventually([&] { return (received += friendly.take()) > i; })) << i;
  }
  EXPECT_EQ(publisher.statistics().published, 300U);
  stranger.send(SIGCONT);
  // It comes back and gets new ones.
  EXPECT_TRUE(eventually([&] {
    publisher.publish(random_result(1, 1));
    return stranger.output("stdout").find('\n', 9) != std::string::npos;
  }));
  stranger.send(SIGKILL);
  stranger.wait();
  EXPECT_TRUE(eventually([&] { return publisher.matched_readers() == 1; }));
}

TEST(Faults, AStoppedReliableReaderHoldsNobodyUpAndAKilledOneIsForgotten) {
  stop_and_kill_a_reliable_reader(DdsTestDomain(), 5);
}

TEST(Faults, AStoppedReliableReaderHoldsNobodyUpWithoutTheShippedSettingsToo) {
  const DdsTestDomain domain("../tests/interop/plain_loopback.xml");
  use_dds_defaults();
  stop_and_kill_a_reliable_reader(domain, 60);
}

TEST(Faults, SmallSocketBuffersCostImagesButNoPose) {
  const DdsTestDomain domain(
      "cyclonedds.xml",
      "<CycloneDDS><Domain Id=\"any\"><Internal><SocketReceiveBufferSize min=\"default\" max=\"16 kB\"/>"
      "</Internal></Domain></CycloneDDS>");
  Publisher publisher(options_of(domain));
  const QosPointer ten = make_qos({.reliable = true, .depth = 10});
  const QosPointer best_effort = make_qos({.reliable = false, .depth = 2});
  const std::string before = "rt/" + domain.name_space + "/";
  const RawReader poses(domain.reading, *topic_type<Detection3DArrayMessage>().descriptor,
                        before + "detections", ten.get());
  const RawReader images(domain.reading, *topic_type<ImageMessage>().descriptor,
                         before + "annotated/image_raw", best_effort.get());
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 2; }));
  ASSERT_TRUE(eventually([&] { return poses.matched() == 1 && images.matched() == 1; }));
  const cv::Mat picture(480, 640, CV_8UC3, cv::Scalar(1, 2, 3));
  constexpr int kFrames = 50;
  int got_poses = 0, got_images = 0;
  for (unsigned i = 0; i < kFrames; ++i) {
    const FrameResult result = random_result(i, 3);
    publisher.publish(result);
    publisher.publish_annotated(result, picture);
    // A pose that was lost in the images' flood is sent again.
    EXPECT_TRUE(eventually([&] { return (got_poses += poses.take()) > static_cast<int>(i); })) << i;
    got_images += images.take();
  }
  EXPECT_EQ(got_poses, kFrames);
  RecordProperty("images", got_images);
  std::printf("images that came through a socket buffer of 16 kB: %d of %d\n", got_images, kFrames);
}

TEST(Faults, AReaderThatDoesNotReadGetsTheNewestOnes) {
  const DdsTestDomain domain;
  Publisher publisher(options_of(domain));
  const QosPointer qos = make_qos({.reliable = true, .depth = 10});
  const RawReader lazy(domain.reading, *topic_type<Detection3DArrayMessage>().descriptor,
                       "rt/" + domain.name_space + "/detections", qos.get());
  ASSERT_TRUE(eventually([&] { return publisher.matched_readers() == 1 && lazy.matched() == 1; }));
  FrameResult result = random_result(1, 1);
  for (int i = 1; i <= 200; ++i) {
    result.captured_at = CaptureTime(seconds(1'000'000 + i));
    publisher.publish(result);
    if (i % 10 == 0) {
      EXPECT_TRUE(publisher.wait_for_acknowledgements(seconds(20)));
    }
  }
  std::vector<int> stamps;
  void* sample = nullptr;
  dds_sample_info_t info{};
  while (dds_take(lazy.reader, &sample, &info, 1, 1) > 0) {
    stamps.push_back(static_cast<const Detection3DArrayMessage*>(sample)->header.stamp.sec - 1'000'000);
    dds_return_loan(lazy.reader, &sample, 1);
    sample = nullptr;
  }
  EXPECT_THAT(stamps, testing::ElementsAre(191, 192, 193, 194, 195, 196, 197, 198, 199, 200));
}

}  // namespace
}  // namespace sextant
