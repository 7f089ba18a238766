#pragma once

#include <string_view>
#include <vector>

#include "core/identification/response_fit.hpp"
#include "core/identification/transfer_function.hpp"

namespace teleop {

/// A fitted number with its 90 % interval.
struct Estimate {
  std::string_view name;
  std::string_view unit;
  double value = 0.0;
  double deviation = 0.0;  ///< standard deviation
  double low = 0.0;        ///< 5 %
  double high = 0.0;       ///< 95 %
  bool determined = true;  ///< the data fix it to a factor of e at least
};

/// The two structures of [Cavusoglu 2002, section 4.3.1, fig. 5]: force and encoder on m1, m2
/// behind a spring and a damper,
///
///     (a)  X/F = (m2 s² + b s + k) / (s² (m1 m2 s² + (m1 + m2)(b s + k)))
///     (b)  the reaction of the motor goes to ground through a massless tendon, whose stretch the
///          encoder also sees: Y/F = X/F + 1/k_t
///
/// and, as an addition of this project, a damper b_0 from m1 to ground: without it the friction of
/// bearings and transmission would have to go into the other numbers.
enum class MechanicalForm { a, b };

struct MechanicalParameters {
  double m1_kg = 0.0;
  double m2_kg = 0.0;
  double k_N_per_m = 0.0;
  double b_Ns_per_m = 0.0;
  double k_t_N_per_m = 0.0;   ///< form (b) only
  double b_0_Ns_per_m = 0.0;  ///< 0: left out
};

/// θ = ln of the parameters that the form has, in the order of the struct: every θ is a mechanism
/// with positive masses, springs and dampers, hence passive.
struct MechanicalFamily {
  MechanicalForm form = MechanicalForm::a;
  bool has_ground_damper = false;

  [[nodiscard]] Linearised operator()(const Eigen::VectorXd& theta) const;
  [[nodiscard]] Eigen::VectorXd pack(const MechanicalParameters& parameters) const;
  [[nodiscard]] MechanicalParameters unpack(const Eigen::VectorXd& theta) const;
};

/// As polynomials; for form (b) numerator of degree four.
/// @pre no damper to ground, which P(s) = N/(s² D) has no room for.
[[nodiscard]] TransferFunction transfer_function(MechanicalForm form,
                                                 const MechanicalParameters& parameters);

struct MechanicalFit {
  MechanicalFamily family;
  MechanicalParameters parameters;
  std::vector<Estimate> estimates;  ///< one a parameter that the form has
  ResponseFit fit;
};

/// Fits a form. Starting values: for a natural frequency and a damping ratio on a grid the response
/// is linear in the two residues and 1/k_t, so the best of the grid needs no guess; the three best
/// are refined. The damper to ground stays in when it lowers the cost by more than chance would
/// (likelihood ratio at 99 %), or when without it the mode slides below the first line: then the
/// second mass only stands in for the ground.
[[nodiscard]] MechanicalFit fit_mechanical(MechanicalForm form,
                                           const MeasuredResponse& data,
                                           const Sampling& sampling);

}  // namespace teleop
