// SPDX-License-Identifier: Apache-2.0
#include "tests/interop/msg_codec.h"

#include <fastcdr/Cdr.h>

#include <fstream>
#include <regex>
#include <stdexcept>

namespace sextant {

namespace {

using eprosima::fastcdr::Cdr;
using Json = nlohmann::json;

bool is_basic(const std::string& base) {
  static const std::regex basic("bool|byte|u?int(8|16|32|64)|float(32|64)|string");
  return std::regex_match(base, basic);
}

bool is_octet(const std::string& base) { return base == "uint8" || base == "byte"; }

template <typename T>
Json read_number(Cdr& cdr) {
  T value{};
  cdr >> value;
  return value;
}

template <typename T>
void write_number(Cdr& cdr, const Json& value) {
  // JSON has no NaN: null stands for it.
  if constexpr (std::is_floating_point_v<T>) {
    cdr << (value.is_null() ? std::numeric_limits<T>::quiet_NaN() : value.get<T>());
  } else {
    cdr << value.get<T>();
  }
}

}  // namespace

std::string MsgCodec::dds_type_name(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + "_";
}

const std::vector<MsgCodec::Field>& MsgCodec::fields_of(const std::string& type) {
  const auto known = types_.find(type);
  if (known != types_.end()) return known->second;
  const std::string package = type.substr(0, type.find('/'));
  const std::string name = type.substr(type.find('/') + 1);
  std::ifstream file(folder_ / package / (name + ".msg"));
  if (!file) file.open(folder_ / package / "msg" / (name + ".msg"));
  if (!file) throw std::runtime_error("no .msg file of " + type);
  std::vector<Field> fields;
  static const std::regex form(R"(\s*([\w/]+)(\[(\d*)\])?\s+([a-z]\w*)\s*)");
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    const std::string code = line.substr(0, line.find('#'));
    if (!std::regex_match(code, match, form)) continue;
    Field field{match[4], match[1]};
    if (!is_basic(field.base) && field.base.find('/') == std::string::npos)
      field.base = package + "/" + field.base;
    field.sequence = match[2].matched && match[3].length() == 0;
    if (match[3].length() > 0) field.array = std::stoul(match[3]);
    fields.push_back(field);
  }
  return types_[type] = fields;
}

template <typename C>
Json MsgCodec::read_value(C& cdr, const std::string& base) {
  if (base == "bool") return read_number<bool>(cdr);
  if (base == "int8") return read_number<std::int8_t>(cdr);
  if (is_octet(base)) return read_number<std::uint8_t>(cdr);
  if (base == "int16") return read_number<std::int16_t>(cdr);
  if (base == "uint16") return read_number<std::uint16_t>(cdr);
  if (base == "int32") return read_number<std::int32_t>(cdr);
  if (base == "uint32") return read_number<std::uint32_t>(cdr);
  if (base == "int64") return read_number<std::int64_t>(cdr);
  if (base == "uint64") return read_number<std::uint64_t>(cdr);
  if (base == "float32") return read_number<float>(cdr);
  if (base == "float64") return read_number<double>(cdr);
  if (base == "string") return read_number<std::string>(cdr);
  return read_type(cdr, base);
}

template <typename C>
Json MsgCodec::read_type(C& cdr, const std::string& type) {
  Json value = Json::object();
  const std::vector<Field> fields = fields_of(type);
  for (const Field& field : fields) {
    if (!field.sequence && field.array == 0) {
      value[field.name] = read_value(cdr, field.base);
      continue;
    }
    std::uint32_t count = static_cast<std::uint32_t>(field.array);
    if (field.sequence) cdr >> count;
    if (field.sequence && is_octet(field.base)) {
      std::vector<std::uint8_t> bytes(count);
      cdr.deserializeArray(bytes.data(), bytes.size());
      value[field.name] = Json::binary(std::move(bytes));
      continue;
    }
    Json all = Json::array();
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(read_value(cdr, field.base));
    value[field.name] = std::move(all);
  }
  return value;
}

Json MsgCodec::decode(const std::string& type, const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> copy = bytes;  // Fast CDR wants it writable
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(copy.data()), copy.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.read_encapsulation();
  Json value = read_type(cdr, type);
  // CDR pads to 4 bytes at the end.
  if (cdr.getSerializedDataLength() + 3 < copy.size()) throw std::runtime_error(type + ": bytes are left");
  return value;
}

template <typename C>
void MsgCodec::write_value(C& cdr, const std::string& base, const Json& value) {
  if (base == "bool") return write_number<bool>(cdr, value);
  if (base == "int8") return write_number<std::int8_t>(cdr, value);
  if (is_octet(base)) return write_number<std::uint8_t>(cdr, value);
  if (base == "int16") return write_number<std::int16_t>(cdr, value);
  if (base == "uint16") return write_number<std::uint16_t>(cdr, value);
  if (base == "int32") return write_number<std::int32_t>(cdr, value);
  if (base == "uint32") return write_number<std::uint32_t>(cdr, value);
  if (base == "int64") return write_number<std::int64_t>(cdr, value);
  if (base == "uint64") return write_number<std::uint64_t>(cdr, value);
  if (base == "float32") return write_number<float>(cdr, value);
  if (base == "float64") return write_number<double>(cdr, value);
  if (base == "string") return write_number<std::string>(cdr, value);
  write_type(cdr, base, value);
}

template <typename C>
void MsgCodec::write_type(C& cdr, const std::string& type, const Json& value) {
  const std::vector<Field> fields = fields_of(type);
  for (const auto& [key, unused] : value.items()) {
    if (std::none_of(fields.begin(), fields.end(), [&](const Field& f) { return f.name == key; }))
      throw std::runtime_error(type + " has no field " + key);
  }
  for (const Field& field : fields) {
    const bool many = field.sequence || field.array > 0;
    const Json empty = many                     ? Json::array()
                       : field.base == "string" ? Json("")
                       : field.base == "bool"   ? Json(false)
                       : is_basic(field.base)   ? Json(0)
                                                : Json::object();
    const Json given = value.contains(field.name) ? value.at(field.name) : empty;
    if (!many) {
      write_value(cdr, field.base, given);
      continue;
    }
    if (given.is_binary()) {
      const auto& bytes = given.get_binary();
      cdr << static_cast<std::uint32_t>(bytes.size());
      cdr.serializeArray(bytes.data(), bytes.size());
      continue;
    }
    if (field.sequence) cdr << static_cast<std::uint32_t>(given.size());
    const std::size_t count = field.sequence ? given.size() : field.array;
    const Json zero = is_basic(field.base) ? (field.base == "string" ? Json("") : Json(0)) : Json::object();
    for (std::size_t i = 0; i < count; ++i) write_value(cdr, field.base, i < given.size() ? given[i] : zero);
  }
}

std::vector<std::uint8_t> MsgCodec::encode(const std::string& type, const Json& value) {
  eprosima::fastcdr::FastBuffer buffer;  // grows
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  write_type(cdr, type, value);
  const auto* begin = reinterpret_cast<const std::uint8_t*>(buffer.getBuffer());
  return {begin, begin + cdr.getSerializedDataLength()};
}

}  // namespace sextant
