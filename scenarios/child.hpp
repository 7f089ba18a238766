#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace teleop {

/// A program started by this one, its standard output read line by line. The destructor ends it.
class Child {
 public:
  /// @param errors file for its standard error; empty: that of this program
  /// @throws Error when the program cannot be started.
  Child(std::string name, const std::vector<std::string>& command, const std::string& errors = {});
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&&) = delete;
  Child& operator=(Child&&) = delete;
  ~Child();

  /// The newest whole line that has come since the last call; never waits.
  [[nodiscard]] std::optional<std::string> newest_line();
  /// The next line, waited for. Nothing when the program closed its output or `patience_ms` passed.
  [[nodiscard]] std::optional<std::string> next_line(int patience_ms);

  /// Asks the program to end (SIGTERM).
  void ask_to_end() noexcept;
  /// Exit code once it has ended; a signal n counts as 128 + n.
  [[nodiscard]] std::optional<int> exit_code() noexcept;
  /// Waits at most `patience_ms`, then kills. @returns the exit code.
  int end(int patience_ms) noexcept;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] pid_t id() const noexcept { return id_; }

 private:
  bool read_more(int patience_ms);

  std::string name_;
  pid_t id_ = -1;
  int output_ = -1;
  std::string buffer_;
  std::optional<int> exit_code_;
};

/// The program `name` that was built or installed beside this one.
[[nodiscard]] std::string sibling_program(const std::string& name);

}  // namespace teleop
