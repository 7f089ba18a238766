#include "scenarios/child.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

/// The child gets its own group, so that Ctrl-C at the terminal reaches only this program, which
/// then ends its children in order; and no blocked signals.
class Attributes {
 public:
  Attributes() {
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  Attributes(Attributes&&) = delete;
  Attributes& operator=(Attributes&&) = delete;
  ~Attributes() { posix_spawnattr_destroy(&attributes_); }

  [[nodiscard]] const posix_spawnattr_t* get() const noexcept { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

void sleep_ms(int ms) noexcept {
  const timespec t{.tv_sec = ms / 1000, .tv_nsec = (ms % 1000) * 1'000'000L};
  nanosleep(&t, nullptr);
}

}  // namespace

Child::Child(std::string name, const std::vector<std::string>& command, const std::string& errors)
    : name_{std::move(name)} {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error{name_ + ": no pipe could be made"};
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);

  const Attributes attributes;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  if (!errors.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
  }
  const int error =
      posix_spawn(&id_, arguments[0], &actions, attributes.get(), arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  output_ = ends[0];
  if (error != 0) {
    close(output_);
    throw Error{words[0] + ": cannot be started: " + std::generic_category().message(error)};
  }
}

Child::~Child() {
  if (!exit_code()) {
    ask_to_end();
    end(1000);
  }
  close(output_);
}

bool Child::read_more(int patience_ms) {
  pollfd ready{.fd = output_, .events = POLLIN, .revents = 0};
  if (poll(&ready, 1, patience_ms) <= 0) return false;
  std::array<char, 4096> block{};
  const ssize_t n = read(output_, block.data(), block.size());
  if (n <= 0) return false;
  buffer_.append(block.data(), static_cast<std::size_t>(n));
  return true;
}

std::optional<std::string> Child::next_line(int patience_ms) {
  std::size_t end = buffer_.find('\n');
  while (end == std::string::npos) {
    if (!read_more(patience_ms)) return std::nullopt;
    end = buffer_.find('\n');
  }
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

std::optional<std::string> Child::newest_line() {
  while (read_more(0)) {
  }
  std::optional<std::string> newest;
  while (buffer_.find('\n') != std::string::npos) {
    newest = next_line(0);
  }
  return newest;
}

void Child::ask_to_end() noexcept {
  if (!exit_code()) kill(id_, SIGTERM);
}

std::optional<int> Child::exit_code() noexcept {
  if (exit_code_) return exit_code_;
  int status = 0;
  if (waitpid(id_, &status, WNOHANG) == id_) {
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return exit_code_;
}

int Child::end(int patience_ms) noexcept {
  constexpr int kStep_ms = 10;
  for (int waited = 0; !exit_code() && waited < patience_ms; waited += kStep_ms) {
    while (read_more(0)) {  // a full pipe would keep it from ending
    }
    sleep_ms(kStep_ms);
  }
  if (const auto code = exit_code()) return *code;
  kill(id_, SIGKILL);
  int status = 0;
  waitpid(id_, &status, 0);
  exit_code_ = 128 + SIGKILL;
  return 128 + SIGKILL;
}

std::string sibling_program(const std::string& name) {
  const auto here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return (here / name).string();
}

}  // namespace teleop
