#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

#include "scenarios/blind_store.hpp"
#include "scenarios/concealed/plan.hpp"

namespace teleop {

/// How the cases of a campaign are done.
struct BlindWork {
  const concealed::ConcealedPlan& plan;
  BlindStore& store;
  std::string diagnose{};  ///< program, called PROGRAM diagnose FOLDER --json FILE --threads N
  unsigned threads = 1;    ///< N; the answer is the same
  bool keep = false;       ///< recordings and answers stay on disk
  const std::atomic<bool>& stop;
};

/// One case from first to last:
///
///     1. `teleop_conceal` draws it, writes the recordings and tells the SHA-256 of the truth; the
///        truth itself is nowhere, in no file and no memory.
///     2. The seal is published.
///     3. A program of its own diagnoses, given the folder of recordings and nothing else; the
///        regressions answer too.
///     4. Only then is the truth opened: drawn once more from seed and index, held against the
///     seal.
///     5. Truth and answers are kept.
///
/// A diagnosis that fails has no answer, and why is kept in its place.
/// @returns false when a stop was asked for before the end.
/// @throws Error when the generator fails or the truth is not the sealed one.
[[nodiscard]] bool do_blind_case(const BlindWork& work, std::size_t index);

}  // namespace teleop
