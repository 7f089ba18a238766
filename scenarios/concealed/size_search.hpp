#pragma once

#include <string_view>
#include <vector>

#include "scenarios/concealed/effect_draw.hpp"
#include "scenarios/concealed/judge.hpp"

namespace teleop::concealed {

/// How visible an effect is: obvious from 10 % of detectability, visible from 2 %, faint from 0.5
/// %.
enum class Band : std::uint8_t { obvious, visible, faint, invisible };
[[nodiscard]] std::string_view name_of(Band band) noexcept;
[[nodiscard]] Band band_of(double detectability) noexcept;
/// A detectability well inside the band.
[[nodiscard]] double draw_target(Band band, Random& random);

struct Found {
  double size = 0.0;
  double detectability = 0.0;  ///< by the runs and steps of the search
};

/// The size at which the effect alone has the wanted detectability, by a bracketed search in log
/// size on coarse simulations of three runs. The nearest it can do where no size has it.
[[nodiscard]] Found search_size(Device device, const Sized& effect, double target);

}  // namespace teleop::concealed
