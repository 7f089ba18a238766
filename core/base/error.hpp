#pragma once

#include <stdexcept>
#include <string>

namespace teleop {

/// The world is wrong before the loop starts. The text is one line: what, where, what to do.
/// Programs print it and leave with exit code 2.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A configuration, scenario, trace or command line that cannot be used.
class ConfigError final : public Error {
 public:
  using Error::Error;
};

/// A device that is absent, busy or not what was asked for.
class DeviceError final : public Error {
 public:
  using Error::Error;
};

/// An address that cannot be used, or a peer that cannot be talked to.
class TransportError final : public Error {
 public:
  using Error::Error;
};

/// A recording that cannot be written or read.
class RecordingError final : public Error {
 public:
  using Error::Error;
};

}  // namespace teleop
