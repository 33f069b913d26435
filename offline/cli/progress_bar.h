// SPDX-License-Identifier: Apache-2.0
// A progress bar on stderr, only where stderr is a terminal.
#pragma once

#include <cstddef>
#include <string>

namespace sextant {

class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void show(std::size_t done, std::size_t total);

 private:
  std::string what_;
  bool terminal_;
  bool shown_ = false;
};

}  // namespace sextant
