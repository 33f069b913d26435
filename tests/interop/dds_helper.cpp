// SPDX-License-Identifier: Apache-2.0
// A process of somebody else for tests that stop, kill or watch one.
//   dds_helper publish DOMAIN NAMESPACE SECONDS   publishes 20 frames a second, and listens to itself over
//   the wire dds_helper listen DOMAIN NAMESPACE            a reliable reader of detections; prints "matched",
//   then a line of
//                                                 the number of messages so far whenever some came
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "runtime/publish/echo_reader.h"
#include "runtime/publish/message_types.h"
#include "runtime/publish/publisher.h"
#include "tests/unit/runtime/publish/example_result.h"
#include "tests/unit/runtime/publish/raw_reader.h"

namespace {

using namespace sextant;
using std::chrono::milliseconds;

int publish(unsigned domain, const std::string& name_space, double seconds) {
  PublisherOptions options;
  options.domain = domain;
  options.name_space = name_space;
  Publisher publisher(options);
  EchoReader reader({domain + 1, name_space + "/detections", TopicKind::kDetections},
                    [](const EchoMessage&) {});
  for (int i = 0; i < static_cast<int>(seconds * 20); ++i) {
    publisher.publish(random_result(static_cast<unsigned>(i), 2));
    reader.poll(milliseconds(0));
    std::this_thread::sleep_for(milliseconds(50));
  }
  return 0;
}

int listen(unsigned domain, const std::string& name_space) {
  const QosPointer qos = make_qos({.reliable = true, .depth = 10});
  const RawReader reader(domain, *topic_type<Detection3DArrayMessage>().descriptor,
                         "rt/" + name_space + "/detections", qos.get());
  if (!eventually([&] { return reader.matched() > 0; })) return 1;
  std::puts("matched");
  std::fflush(stdout);
  for (int received = 0;;) {
    const int before = received;
    received += reader.take();
    if (received != before) {
      std::printf("%d\n", received);
      std::fflush(stdout);
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::strcmp(argv[1], "publish") == 0)
    return publish(static_cast<unsigned>(std::atoi(argv[2])), argv[3], std::atof(argv[4]));
  if (argc == 4 && std::strcmp(argv[1], "listen") == 0)
    return listen(static_cast<unsigned>(std::atoi(argv[2])), argv[3]);
  std::fputs("usage: see the head of dds_helper.cpp\n", stderr);
  return 2;
}
