#include "scenarios/concealed/seal.hpp"

#include <array>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "core/base/contract.hpp"
#include "scenarios/concealed/concealed_case.hpp"

namespace teleop::concealed {

void Seal::Freed::operator()(evp_md_ctx_st* context) const noexcept { EVP_MD_CTX_free(context); }

Seal::Seal() : context_{EVP_MD_CTX_new()} {
  expects(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1,
          "the library has SHA-256");
}

void Seal::add(std::string_view truth) {
  expects(EVP_DigestUpdate(context_.get(), truth.data(), truth.size()) == 1,
          "a seal is read once, at the end");
}

std::string Seal::digits() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned length = 0;
  expects(EVP_DigestFinal_ex(context_.get(), bytes.data(), &length) == 1,
          "a seal is read once, at the end");
  std::string text;
  text.reserve(2 * std::size_t{length});
  for (unsigned i = 0; i < length; ++i) {
    text += fmt::format("{:02x}", bytes.at(i));
  }
  return text;
}

std::string seal(const ConcealedPlan& plan) {
  Seal result;
  for (std::size_t index = 0; index < plan.cases; ++index) {
    if (plan.takes(index)) result.add(truth_json(draw_case(plan, index)));
  }
  return result.digits();
}

}  // namespace teleop::concealed
