// SPDX-License-Identifier: Apache-2.0
// The errors that leave a door (file, command line, device, wire): what went wrong, where, and what to
// do about it, in one line. Each class is one documented exit code; main() of every program maps them.
#pragma once

#include <stdexcept>
#include <string>

namespace sextant {

enum class ExitCode : int {
  kDone = 0,
  kNothingFound = 1,
  kWrongUse = 2,
  kBadInput = 3,
  kDeviceOrNetwork = 4,
  kOurBug = 70,
};

/// An error with a place and advice: "<where>: <what>; <advice>".
class DoorError : public std::runtime_error {
 public:
  DoorError(ExitCode code, const std::string& where, const std::string& what, const std::string& advice)
      : std::runtime_error((where.empty() ? "" : where + ": ") + what +
                           (advice.empty() ? "" : "; " + advice)),
        code_(code) {}
  ExitCode exit_code() const { return code_; }

 private:
  ExitCode code_;
};

/// The command line or a combination of options makes no sense. Exit 2.
struct UsageError : DoorError {
  explicit UsageError(const std::string& what, const std::string& advice = "")
      : DoorError(ExitCode::kWrongUse, "", what, advice) {}
};

/// A file, image, mesh, model, data set or payload is bad. Exit 3.
struct InputError : DoorError {
  InputError(const std::string& where, const std::string& what, const std::string& advice = "")
      : DoorError(ExitCode::kBadInput, where, what, advice) {}
};

/// A device or the network failed. Exit 4.
struct DeviceError : DoorError {
  DeviceError(const std::string& where, const std::string& what, const std::string& advice = "")
      : DoorError(ExitCode::kDeviceOrNetwork, where, what, advice) {}
};

}  // namespace sextant
