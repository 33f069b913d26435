// SPDX-License-Identifier: Apache-2.0
// Messages by their .msg files and Fast CDR alone: decodes any type to JSON and back without a line of what
// idlc generates, so that it can disagree with it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sextant {

/// The types under idl/msg. Octet sequences are JSON binary values, everything else what it is.
class MsgCodec {
 public:
  explicit MsgCodec(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// `type` as in "sensor_msgs/Image". With the 4-byte encapsulation header. Throws where bytes are missing
  /// or left.
  nlohmann::json decode(const std::string& type, const std::vector<std::uint8_t>& bytes);
  /// Fields that `value` leaves out are zero or empty; unknown ones throw.
  std::vector<std::uint8_t> encode(const std::string& type, const nlohmann::json& value);
  /// "sensor_msgs::msg::dds_::Image_", as ROS 2 names it on the wire.
  static std::string dds_type_name(const std::string& type);

 private:
  struct Field {
    std::string name, base;
    bool sequence = false;
    std::size_t array = 0;  // 0: no array
  };
  const std::vector<Field>& fields_of(const std::string& type);
  template <typename Cdr>
  nlohmann::json read_value(Cdr& cdr, const std::string& base);
  template <typename Cdr>
  nlohmann::json read_type(Cdr& cdr, const std::string& type);
  template <typename Cdr>
  void write_value(Cdr& cdr, const std::string& base, const nlohmann::json& value);
  template <typename Cdr>
  void write_type(Cdr& cdr, const std::string& type, const nlohmann::json& value);

  std::filesystem::path folder_;
  std::map<std::string, std::vector<Field>> types_;
};

}  // namespace sextant
