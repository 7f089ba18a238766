#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/scoring/case_truth.hpp"
#include "scenarios/scoring/given_answer.hpp"

namespace teleop {

/// One answer held against the truth.
///
/// An effect counts as named when its confidence is at least 0.5, the first also when it and its
/// alternatives add up to that; under the verdict `adequate` nothing is named. It is right when
/// kind and axis are those of a true effect, or equivalent to them (equivalence.hpp) with the true
/// one listed at 0.1 or more among at most four alternatives.
struct CaseScore {
  /// A probability that was stated, and whether what it was of is there.
  struct Claim {
    double confidence = 0.0;
    bool holds = false;
  };
  struct ParameterError {
    std::string name{};             ///< "coulomb_friction.level"
    double relative = 0.0;          ///< docs/diagnosis.md says relative to what
    std::optional<bool> covered{};  ///< by the 90 % interval, where one was stated
  };

  Content content = Content::nothing;
  std::string group{};
  std::string sort{};
  std::string kind{};  ///< of the first true effect; empty: there is none
  double dnr = 0.0;
  bool missing = false;     ///< there is no answer
  bool detected = false;    ///< something is said to be missing from the nominal model
  bool silent = false;      ///< nothing is named
  bool right = false;       ///< the most confident effect has a right name
  bool in_set = false;      ///< the truth is it or among its alternatives above 0.1
  bool wrong_name = false;  ///< something is named that is not there
  bool false_flag = false;  ///< the vocabulary explains it, the verdict says it does not
  bool pair_exact = false;  ///< all effects named, none else
  bool pair_any = false;
  bool flagged = false;        ///< a stranger: the verdict says that something has no name
  bool misnamed = false;       ///< a stranger: said to be explained by a named effect
  std::optional<bool> axis{};  ///< the axes are right; nothing where the truth has none
  bool channel = false;
  std::vector<Claim> claims{};
  std::vector<ParameterError> parameters{};
  std::optional<double> over_floor{};  ///< as the answer says

  /// The best that can be said of such a case was said of it.
  [[nodiscard]] bool good() const noexcept;
};

/// @param answer none: it is missing, which is wrong.
[[nodiscard]] CaseScore score(const CaseTruth& truth, const std::optional<GivenAnswer>& answer);

}  // namespace teleop
