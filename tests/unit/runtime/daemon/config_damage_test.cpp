// SPDX-License-Identifier: Apache-2.0
// Hostile configuration files: an InputError (exit 3) or a valid configuration, never anything else.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "runtime/base/error.h"
#include "runtime/daemon/config_reader.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

std::string shipped() {
  std::ifstream stream(SEXTANT_SOURCE_DIR "/config/sextantd.yaml");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// True: accepted. Anything but InputError fails the test by escaping.
bool accepted(const std::string& text) {
  try {
    parse_config(text, "hostile.yaml", "/folder");
    return true;
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_LT(what.size(), 1000U);
    for (const char c : what) EXPECT_TRUE(c >= ' ' && c <= '~') << "unprintable in the message";
    return false;
  }
}

TEST(ConfigDamage, EveryTruncationIsReadOrRefused) {
  const std::string whole = shipped();
  ASSERT_TRUE(accepted(whole));
  int refused = 0;
  for (std::size_t size = 0; size < whole.size(); size += 7)
    refused += accepted(whole.substr(0, size)) ? 0 : 1;
  EXPECT_GT(refused, 0);
}

TEST(ConfigDamage, RandomChangesAreReadOrRefused) {
  const std::string whole = shipped();
  std::mt19937_64 random(7);
  const std::string special = "{}[]:,-?&*!|>'\"%@`#\n\t \\~";
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string text = whole;
    for (int change = 0; change < 3; ++change) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.insert(at, 1, special[random() % special.size()]);
          break;
        case 2:
          text.erase(at, 1 + random() % 20);
          break;
        default:
          text.insert(at, whole.substr(random() % whole.size(), random() % 200));
          break;
      }
    }
    refused += accepted(text) ? 0 : 1;
  }
  EXPECT_GT(refused, 200);  // the damage reaches more than comments
}

TEST(ConfigDamage, BombsAreRefused) {
  const std::size_t n = 200'000;
  EXPECT_FALSE(accepted(std::string(n, '[')));
  EXPECT_FALSE(accepted(std::string(n, '{')));
  EXPECT_FALSE(accepted("models: {files: " + std::string(n, '[') + std::string(n, ']') + "}"));
  std::string text;
  for (std::size_t i = 0; i < n / 2; ++i) text += "- ";
  EXPECT_FALSE(accepted(text));
  text.clear();
  for (std::size_t i = 0; i < n / 2; ++i) text += "? ";
  EXPECT_FALSE(accepted(text));
  // Ten to the power of 25 elements if anybody followed the aliases.
  text = "a: &a [x,x,x,x,x,x,x,x,x,x]\n";
  for (char c = 'b'; c <= 'z'; ++c) {
    text += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 10; ++i) text += std::string(i > 0 ? "," : "") + "*" + static_cast<char>(c - 1);
    text += "]\n";
  }
  EXPECT_FALSE(accepted(text));
  EXPECT_FALSE(accepted("models: &m {files: [*m]}\nsource: {dataset: d}\n"));
  EXPECT_FALSE(accepted("&r source: *r\n"));
  EXPECT_FALSE(accepted("source: {dataset: d}\nmodels: {files: &f [*f]}\n"));
  EXPECT_FALSE(accepted("--- {}\n--- {}\n"));
  EXPECT_FALSE(accepted(std::string("source: {dataset: \"a\0b\"}", 25)));
  EXPECT_FALSE(accepted("source: {dataset: \"a\\0b\"}\nmodels: {files: [m]}\n"));
  EXPECT_FALSE(accepted("source: {dataset: d}\nmodels: {files: [" + std::string(5000, 'x') + "]}\n"));
}

TEST(ConfigDamage, BinaryIsRefused) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 500; ++round) {
    std::string text(random() % 2000 + 8, '\0');
    for (char& c : text) c = static_cast<char>(random() % 256);
    EXPECT_FALSE(accepted(text));
  }
}

TEST(ConfigDamage, WhatIsNoFileIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_config(folder.path()), InputError);
  EXPECT_THROW(read_config(folder / "missing.yaml"), InputError);
  EXPECT_THROW(read_config("/dev/zero"), InputError);
  std::ofstream(folder / "large.yaml") << std::string(300 * 1024, '#');
  EXPECT_THROW(read_config(folder / "large.yaml"), InputError);
}

}  // namespace
}  // namespace sextant
