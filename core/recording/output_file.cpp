#include "core/recording/output_file.hpp"

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr int kReadableByAll = 0644;

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

OutputFile::OutputFile(std::filesystem::path path) : path_{std::move(path)} {
  descriptor_ =
      ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kReadableByAll);  // NOLINT
  if (descriptor_ >= 0) return;
  const int error = errno;
  throw RecordingError{
      error == EEXIST ? fmt::format("{}: exists already and is not overwritten: name another file",
                                    path_.string())
                      : fmt::format("{}: cannot be created: {}", path_.string(), reason(error))};
}

OutputFile::~OutputFile() { ::close(descriptor_); }

void OutputFile::write(ByteView bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (const int error = errno; error != EINTR) {
      throw RecordingError{
          fmt::format("{}: cannot be written any further: {}", path_.string(), reason(error))};
    }
  }
}

}  // namespace teleop
