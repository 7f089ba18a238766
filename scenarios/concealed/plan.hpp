#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/concealed/size_search.hpp"

namespace teleop::concealed {

/// A campaign: so many cases, the same for the same numbers.
struct ConcealedPlan {
  std::size_t cases = 200;
  bool nulls = false;  ///< devices without effects, of every sort
  std::uint64_t seed = 1;
  std::size_t shard = 0;  ///< of `shards`: the cases whose index leaves this remainder
  std::size_t shards = 1;

  [[nodiscard]] bool takes(std::size_t index) const noexcept { return index % shards == shard; }
};

enum class Group : std::uint8_t { single, pair, out_of_vocabulary, nasty, null };
[[nodiscard]] std::string_view name_of(Group group) noexcept;

/// One place in a campaign, before anything is drawn.
struct Slot {
  Group group = Group::null;
  std::string
      sort{};  ///< kind of a single or stranger, both of a pair, name of a null or nasty sort
  Band band = Band::invisible;  ///< wanted, where the sort leaves it open
};

/// The nasty sorts and the sorts of nulls, by name.
[[nodiscard]] const std::vector<std::string>& nasty_sorts();
[[nodiscard]] const std::vector<std::string>& null_sorts();

/// Of every 200: 100 singles (kinds in equal numbers, each band at least a quarter), 30 pairs, 30
/// devices outside the vocabulary, 40 nasty ones; or nulls, their sorts in equal numbers. Order and
/// what is left over are decided by the seed.
[[nodiscard]] std::vector<Slot> lay_out(const ConcealedPlan& plan);

}  // namespace teleop::concealed
