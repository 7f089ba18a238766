#include "core/base/contract.hpp"

#include <cstdio>
#include <cstdlib>

namespace teleop {

void contract_broken(const char* what, const std::source_location& where) noexcept {
  std::fprintf(stderr, "%s:%u: contract broken: %s\n", where.file_name(), where.line(), what);
  std::abort();
}

}  // namespace teleop
