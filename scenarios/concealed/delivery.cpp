#include "scenarios/concealed/delivery.hpp"

#include <algorithm>
#include <cmath>

namespace teleop::concealed {

namespace {
constexpr std::size_t kUsualRun = 8001;
constexpr double kRated_Nm = 0.03;
}  // namespace

Delivery::Delivery(const ActuationLaw& law, double period)
    : law_{law},
      period_{period},
      plain_{law.delay == 0.0 && law.gain == 1.0 && law.loss == 0.0 && law.lag == 0.0 &&
             law.gain_wave.amplitude == 0.0} {
  shaped_.reserve(kUsualRun);
}

void Delivery::command(double u) {
  double x = std::clamp(u, -law_.limit, law_.limit);
  if (law_.threshold > 0.0) {
    x = std::abs(x) <= law_.threshold ? 0.0 : x - std::copysign(law_.threshold, x);
  }
  if (law_.rate_share > 0.0 && !shaped_.empty()) {
    const double rate = std::abs(u - last_) / period_;
    x *= 1.0 - law_.rate_share * rate / (rate + law_.rate_scale);
  }
  last_ = u;
  if (shaped_.empty()) lagged_ = law_.gain * x;
  shaped_.push_back(x);
}

double Delivery::arrived(double t) const noexcept {
  const double index = std::floor((t - law_.delay) / period_);
  if (index <= 0.0) return shaped_.front();
  return shaped_[std::min(static_cast<std::size_t>(index), shaped_.size() - 1)];
}

double Delivery::mean(double t, double span) noexcept {
  if (plain_) return shaped_.back();
  // At most one command arrives within a span: a span is shorter than a period.
  const double early = arrived(t + 1e-6 * span);
  const double late = arrived(t + (1.0 - 1e-6) * span);
  double x = early;
  if (early != late) {
    const double next = std::ceil((t + 1e-6 * span - law_.delay) / period_) * period_ + law_.delay;
    const double share = std::clamp((next - t) / span, 0.0, 1.0);
    x = share * early + (1.0 - share) * late;
  }
  double torque = x * (law_.gain + law_.gain_wave.at(t + span / 2.0));
  if (law_.loss > 0.0) {
    const double load = x * x / (kRated_Nm * kRated_Nm);
    const double half = std::exp(-span / (2.0 * law_.heat_time));
    const double middle = load + (heat_ - load) * half;
    torque *= std::max(0.2, 1.0 - law_.loss * middle);
    heat_ = load + (middle - load) * half;
  }
  if (law_.lag == 0.0) return torque;
  const double kept = std::exp(-span / law_.lag);
  const double mean = torque + (lagged_ - torque) * (1.0 - kept) * law_.lag / span;
  lagged_ = torque + (lagged_ - torque) * kept;
  return mean;
}

}  // namespace teleop::concealed
