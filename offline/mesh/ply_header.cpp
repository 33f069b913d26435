// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/ply_header.h"

#include <array>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxHeaderBytes = 65536;
constexpr std::uint64_t kMaxElements = std::uint64_t{1} << 32;

std::optional<std::uint64_t> size_of_type(const std::string& name) {
  constexpr std::array<std::pair<const char*, std::uint64_t>, 16> kTypes{{{"char", 1},
                                                                          {"uchar", 1},
                                                                          {"int8", 1},
                                                                          {"uint8", 1},
                                                                          {"short", 2},
                                                                          {"ushort", 2},
                                                                          {"int16", 2},
                                                                          {"uint16", 2},
                                                                          {"int", 4},
                                                                          {"uint", 4},
                                                                          {"int32", 4},
                                                                          {"uint32", 4},
                                                                          {"float", 4},
                                                                          {"float32", 4},
                                                                          {"double", 8},
                                                                          {"float64", 8}}};
  for (const auto& [type, size] : kTypes) {
    if (name == type) return size;
  }
  return std::nullopt;
}

class HeaderReader {
 public:
  explicit HeaderReader(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
    head_.resize(kMaxHeaderBytes);
    in_.read(head_.data(), static_cast<std::streamsize>(head_.size()));
    head_.resize(static_cast<std::size_t>(in_.gcount()));
  }

  PlyHeader read() {
    if (next_line() != std::vector<std::string>{"ply"}) fail("does not begin with 'ply'");
    while (true) {
      const std::vector<std::string> words = next_line();
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words == std::vector<std::string>{"end_header"}) break;
      if (words[0] == "format") {
        read_format(words);
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        fail("has an unknown line in its header");
      }
    }
    if (!format_known_) fail("does not say its format");
    close_element();
    if (least_bytes_ > std::filesystem::file_size(file_) - at_ + 1)
      fail("is shorter than its header promises");
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_.string(), what, "the PLY file is damaged: export it again");
  }

  // Words of the next line; throws where there is none any more.
  std::vector<std::string> next_line() {
    const std::size_t end = head_.find('\n', at_);
    if (end == std::string::npos) fail("has a header without end");
    std::istringstream line(head_.substr(at_, end - at_));
    at_ = end + 1;
    std::vector<std::string> words;
    for (std::string word; line >> word;) words.push_back(word);
    return words;
  }

  void read_format(const std::vector<std::string>& words) {
    if (words.size() != 3 || words[2] != "1.0") fail("is of an unknown format");
    text_ = words[1] == "ascii";
    if (!text_ && words[1] != "binary_little_endian" && words[1] != "binary_big_endian")
      fail("is of an unknown format");
    format_known_ = true;
  }

  void read_element(const std::vector<std::string>& words) {
    close_element();
    if (words.size() != 3) fail("has an element without a count");
    const std::string& text = words[2];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count_);
    if (error != std::errc{} || end != text.data() + text.size() || count_ > kMaxElements) {
      fail("has an element with a bad count");
    }
    if (words[1] == "vertex") header_.vertices = count_;
    if (words[1] == "face") header_.faces = count_;
    in_element_ = true;
  }

  void read_property(const std::vector<std::string>& words) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (!in_element_ || (!list && words.size() != 3)) fail("has a bad property");
    const std::optional<std::uint64_t> size = size_of_type(list ? words[2] : words[1]);
    if (!size || (list && !size_of_type(words[3]))) fail("has a property of an unknown type");
    bytes_of_one_ += text_ ? 2 : *size;  // a digit and a space; a list may be empty
  }

  void close_element() {
    if (in_element_ && bytes_of_one_ == 0 && count_ > 0) fail("has an element without properties");
    least_bytes_ += count_ * bytes_of_one_;
    count_ = 0;
    bytes_of_one_ = 0;
    in_element_ = false;
  }

  const std::filesystem::path& file_;
  std::ifstream in_;
  std::string head_;
  std::size_t at_ = 0;
  PlyHeader header_;
  bool format_known_ = false;
  bool text_ = false;
  bool in_element_ = false;
  std::uint64_t count_ = 0;         // of the element that is being declared
  std::uint64_t bytes_of_one_ = 0;  // that one of it takes at least
  std::uint64_t least_bytes_ = 0;   // that all elements take at least
};

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& file) { return HeaderReader(file).read(); }

}  // namespace sextant
