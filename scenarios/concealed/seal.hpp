#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "scenarios/concealed/plan.hpp"

struct evp_md_ctx_st;  // of OpenSSL

namespace teleop::concealed {

/// SHA-256 of a campaign's truth, case by case in order of index.
class Seal {
 public:
  Seal();
  void add(std::string_view truth);
  /// In hexadecimal digits. Nothing can be added afterwards.
  [[nodiscard]] std::string digits();

 private:
  struct Freed {
    void operator()(evp_md_ctx_st* context) const noexcept;
  };
  std::unique_ptr<evp_md_ctx_st, Freed> context_;
};

/// The seal of the plan's shard, drawing every case of it: a second or less a case.
[[nodiscard]] std::string seal(const ConcealedPlan& plan);

}  // namespace teleop::concealed
