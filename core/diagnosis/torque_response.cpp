#include "core/diagnosis/torque_response.hpp"

namespace teleop {

Eigen::VectorXf torque_response(const Tether& tether,
                                const std::vector<JointMatrix>& mobility,
                                double period_s,
                                const std::vector<JointVector>& torque,
                                std::size_t skip) {
  const std::size_t rows = torque.size();
  Eigen::VectorXf result{static_cast<Eigen::Index>(3 * (rows - skip))};
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();
  JointVector d = JointVector::Zero();
  for (std::size_t k = 0; k < rows; ++k) {
    const Tether::Step& step = tether.steps()[k];
    const JointVector e = -q;
    if (k >= skip) {
      result.segment<3>(static_cast<Eigen::Index>(3 * (k - skip))) =
          (step.whitening * e).cast<float>();
    }
    q += step.position * e;
    qd += step.velocity * e;
    d += step.disturbance * e;
    const JointVector jump = period_s * (mobility[k] * (torque[k] + d));
    q += period_s * (qd + jump / 2.0);
    qd += jump;
    d = tether.memory().cwiseProduct(d);
  }
  return result;
}

}  // namespace teleop
