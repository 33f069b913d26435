// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/isolation.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

IsolationLimits small_limits() {
  IsolationLimits limits;
  limits.cpu_s = 1;
  limits.wall_s = 30;
  limits.memory_bytes = std::size_t{256} << 20;
  limits.answer_bytes = std::size_t{64} << 20;
  return limits;
}

TEST(Isolation, BringsTheAnswerBack) {
  Bytes big(5'000'001);
  for (std::size_t i = 0; i < big.size(); ++i) big[i] = static_cast<std::byte>(i * 7);
  const IsolatedAnswer answer = run_isolated([&] { return big; }, small_limits());
  EXPECT_EQ(answer.failure, "");
  EXPECT_EQ(answer.bytes, big);
  EXPECT_EQ(run_isolated([] { return Bytes{}; }, small_limits()).failure, "");
}

TEST(Isolation, SurvivesACrash) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    const IsolatedAnswer answer = run_isolated(
        [&]() -> Bytes {
          std::signal(signal, SIG_DFL);
          raise(signal);
          return Bytes(3);
        },
        small_limits());
    EXPECT_THAT(answer.failure, HasSubstr("crashed"));
    EXPECT_TRUE(answer.bytes.empty());
  }
}

TEST(Isolation, StopsABusyLoop) {
  const IsolatedAnswer answer = run_isolated(
      []() -> Bytes {
        volatile std::uint64_t n = 0;
        while (true) n = n + 1;
      },
      small_limits());
  EXPECT_THAT(answer.failure, HasSubstr("took too long"));
}

TEST(Isolation, StopsASleeper) {
  IsolationLimits limits = small_limits();
  limits.wall_s = 0.2;
  const IsolatedAnswer answer = run_isolated(
      []() -> Bytes {
        pause();
        return {};
      },
      limits);
  EXPECT_THAT(answer.failure, HasSubstr("took too long"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(Isolation, MemoryIsLimited) {
  const IsolatedAnswer answer = run_isolated(
      [] {
        Bytes hoard(std::size_t{512} << 20, std::byte{1});
        return Bytes(hoard.begin(), hoard.begin() + 4);
      },
      small_limits());
  EXPECT_THAT(answer.failure, HasSubstr("ended early"));
}
#endif

TEST(Isolation, AnswerIsLimited) {
  IsolationLimits limits = small_limits();
  limits.answer_bytes = 1 << 20;
  EXPECT_THAT(run_isolated([] { return Bytes((1 << 20) + 1); }, limits).failure, HasSubstr("too much data"));
}

TEST(Isolation, WhatTheChildThrowsOrWritesStaysThere) {
  EXPECT_THAT(run_isolated([]() -> Bytes { throw 42; }, small_limits()).failure, HasSubstr("ended early"));
  const TemporaryFolder folder;
  const auto file = folder.write("kept.txt", "before");
  const IsolatedAnswer answer = run_isolated(
      [&] {
        std::signal(SIGXFSZ, SIG_IGN);
        std::ofstream(file, std::ios::app) << "after" << std::flush;
        return Bytes(1);
      },
      small_limits());
  EXPECT_EQ(answer.bytes.size(), 1U);
  EXPECT_EQ(file_content(file), "before");
}

}  // namespace
}  // namespace sextant
