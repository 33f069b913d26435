// SPDX-License-Identifier: Apache-2.0
// A stranger on the network: a Fast DDS participant on loopback that reads and writes topics as plain bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sextant {

/// QoS as ROS 2 users choose it.
struct FastDdsQos {
  bool reliable = true;
  bool transient_local = false;
  int depth = 10;
  double deadline_ms = 0;  ///< 0: none
  double lease_ms = 0;     ///< 0: none
};

/// What discovery told about somebody's writer.
struct DiscoveredWriter {
  std::string type_name, user_data;
  bool reliable = false, transient_local = false;
  double deadline_ms = 0, lease_ms = 0, lifespan_ms = 0;  ///< 0: infinite
};

/// What a reader was told without data.
struct ReaderEvents {
  int alive = 0;  ///< writers that are alive at this moment
  int missed_deadlines = 0;
  int incompatible = 0;  ///< writers that offer too little
};

class FastDdsPeer {
 public:
  using Bytes = std::vector<std::uint8_t>;

  explicit FastDdsPeer(unsigned domain);
  ~FastDdsPeer();
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;

  /// `topic` and `type_name` as on the wire: "rt/tf", "tf2_msgs::msg::dds_::TFMessage_".
  void subscribe(const std::string& topic, const std::string& type_name, const FastDdsQos& qos = {});
  /// The next message of a subscribed topic, with its encapsulation header.
  std::optional<Bytes> take(const std::string& topic, std::chrono::milliseconds timeout);
  int matched_writers(const std::string& topic) const;
  ReaderEvents events(const std::string& topic) const;

  void advertise(const std::string& topic, const std::string& type_name, const FastDdsQos& qos = {});
  bool publish(const std::string& topic, const Bytes& bytes);
  int matched_readers(const std::string& topic) const;

  /// Writers of other participants that were discovered, by topic.
  std::map<std::string, DiscoveredWriter> discovered() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
