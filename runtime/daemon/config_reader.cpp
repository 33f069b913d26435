// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/config_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>

#include "runtime/base/error.h"
#include "runtime/daemon/nearest_name.h"

namespace sextant {

namespace {

constexpr std::uintmax_t kLargestFile = 256 * 1024;
constexpr std::size_t kLongestText = 4096;
constexpr std::size_t kLongestList = 1000;

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// At most 60 characters of a value or key, fit for one line of a terminal.
std::string shown(const std::string& text) {
  std::string out = text.substr(0, 60);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out.size() < text.size() ? out + "..." : out;
}

/// Reads one document into the fields.
class Reader {
 public:
  Reader(const std::string& where, const std::vector<ConfigSection>& sections,
         std::vector<ConfigField>& fields)
      : where_(where), sections_(sections), fields_(fields) {}

  void read(const YAML::Node& root) const {
    if (root.IsNull()) return;
    if (!root.IsMap()) fail(root, "the file is no map of sections", "begin with `source:`");
    std::vector<std::string> names;
    for (const ConfigSection& section : sections_) names.push_back(section.name);
    std::set<std::string> seen;
    for (const auto& entry : root) {
      const YAML::Node& value = entry.second;
      const std::string name = key_of(entry.first, "section", names, seen);
      if (value.IsNull()) continue;
      if (!value.IsMap())
        fail(value, fmt::format("section '{}' is no map of keys", name), "write `key: value` lines");
      read_section(name, value);
    }
  }

 private:
  [[noreturn]] void fail(const YAML::Node& at, const std::string& what, const std::string& advice) const {
    throw InputError(fmt::format("{}:{}", where_, at.Mark().line + 1), what, advice);
  }

  std::string key_of(const YAML::Node& key, const std::string& kind, const std::vector<std::string>& known,
                     std::set<std::string>& seen) const {
    if (!key.IsScalar()) fail(key, fmt::format("the name of a {} is no text", kind), "write `name:`");
    const std::string& name = key.Scalar();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_name(name, known);
      fail(key, fmt::format("unknown {} '{}'", kind, shown(name)),
           near.empty() ? fmt::format("known: {}", fmt::join(known, ", "))
                        : fmt::format("did you mean '{}'?", near));
    }
    if (!seen.insert(name).second)
      fail(key, fmt::format("{} '{}' stands here twice", kind, name), "remove one");
    return name;
  }

  void read_section(const std::string& section, const YAML::Node& map) const {
    std::vector<std::string> names;
    for (const ConfigField& field : fields_) {
      if (field.section == section) names.push_back(field.key);
    }
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const YAML::Node& value = entry.second;
      const std::string name = key_of(entry.first, "key of " + section, names, seen);
      const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const ConfigField& f) {
        return f.section == section && f.key == name;
      });
      read_value(*field, value);
    }
  }

  void read_value(const ConfigField& f, const YAML::Node& value) const {
    std::visit(Overloaded{
                   [&](bool* target) { *target = read_bool(f, value); },
                   [&](int* target) {
                     *target = static_cast<int>(read_number<long long>(f, value, "a whole number"));
                   },
                   [&](double* target) { *target = read_number<double>(f, value, "a number"); },
                   [&](std::optional<double>* target) {
                     *target = value.IsScalar() && value.Scalar() == "auto"
                                   ? std::nullopt
                                   : std::optional(read_number<double>(f, value, "a number or auto"));
                   },
                   [&](std::string* target) { *target = read_text(f, value); },
                   [&](std::vector<std::string>* target) { *target = read_list(f, value); },
               },
               f.target);
  }

  [[noreturn]] void wrong(const ConfigField& f, const YAML::Node& value, const std::string& wanted) const {
    const std::string got = value.IsScalar() ? "'" + shown(value.Scalar()) + "'"
                            : value.IsNull() ? "nothing"
                            : value.IsMap()  ? "a map"
                                             : "a list";
    fail(value, fmt::format("{}.{} is {}", f.section, f.key, got), "write " + wanted);
  }

  std::string scalar(const ConfigField& f, const YAML::Node& value, const std::string& wanted) const {
    if (!value.IsScalar()) wrong(f, value, wanted);
    return value.Scalar();
  }

  bool read_bool(const ConfigField& f, const YAML::Node& value) const {
    const std::string text = scalar(f, value, "true or false");
    if (text != "true" && text != "false") wrong(f, value, "true or false");
    return text == "true";
  }

  template <typename Number>
  Number read_number(const ConfigField& f, const YAML::Node& value, const std::string& kind) const {
    const std::string wanted =
        fmt::format("{} from {} to {}{}{}", kind, f.lowest, f.highest, f.unit.empty() ? "" : " ", f.unit);
    const std::string text = scalar(f, value, wanted);
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    // Written so that a NaN fails.
    const bool inside = static_cast<double>(number) >= f.lowest && static_cast<double>(number) <= f.highest;
    if (!whole || !inside) wrong(f, value, wanted);
    return number;
  }

  std::string read_text(const ConfigField& f, const YAML::Node& value) const {
    const std::string wanted = !f.choices.empty() ? fmt::format("one of {}", fmt::join(f.choices, ", "))
                               : f.accepts        ? f.accepted_form
                                                  : "text of at most 4096 characters";
    std::string text = scalar(f, value, wanted);
    const bool chosen =
        f.choices.empty() || std::find(f.choices.begin(), f.choices.end(), text) != f.choices.end();
    const bool plain = text.size() <= kLongestText && text.find('\0') == std::string::npos;
    if (!chosen || !plain || (f.accepts && !f.accepts(text))) wrong(f, value, wanted);
    return text;
  }

  std::vector<std::string> read_list(const ConfigField& f, const YAML::Node& value) const {
    if (!value.IsSequence() || value.size() > kLongestList) wrong(f, value, "a list: [one, two]");
    std::vector<std::string> list;
    for (const YAML::Node& element : value) {
      list.push_back(read_text(f, element));
      if (list.back().empty()) wrong(f, element, "no empty text in a list");
    }
    return list;
  }

  const std::string& where_;
  const std::vector<ConfigSection>& sections_;
  std::vector<ConfigField>& fields_;
};

}  // namespace

DaemonConfig parse_config(const std::string& text, const std::string& where,
                          const std::filesystem::path& folder) {
  DaemonConfig config;
  config.folder = folder;
  if (text.find('\0') != std::string::npos) throw InputError(where, "this is no text", "give a YAML file");
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1)
      throw InputError(where, "more than one YAML document", "remove the lines of ---");
    const std::vector<ConfigSection> sections = config_sections();
    std::vector<ConfigField> fields = config_fields(config);
    if (!documents.empty()) Reader(where, sections, fields).read(documents.front());
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}", where, error.mark.line + 1), "this is no YAML: " + shown(error.msg),
                     "check indentation, quotes and brackets there");
  }
  check_config(config, where);
  return config;
}

DaemonConfig read_config(const std::filesystem::path& file) {
  const std::string where = file.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError(where, "there is no such file", "give the path of a YAML file");
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size > kLargestFile)
    throw InputError(where, "the file is larger than 256 KiB", "is it the right one?");
  std::ifstream stream(file, std::ios::binary);
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  if (!stream) throw InputError(where, "cannot read it", "check its permissions");
  return parse_config(text, where, std::filesystem::absolute(file).parent_path());
}

}  // namespace sextant
