#include "core/program/side_config.hpp"

namespace teleop {

void add_settings(Settings& settings, SideConfig& config) {
  settings.add("device", &config.device, "the arm: sim[:plant.toml]");
  settings.add(
      "hand", &config.hand,
      "hand at a simulated arm: trace.csv, reach, press or none (empty: as the side's role)");
  settings.add("environment", &config.environment,
               "surroundings of a simulated arm: free, soft or wall");
  settings.add("seed", &config.seed, "of everything random in a simulated arm", {0.0, 9e15});
  settings.add("seconds", &config.seconds, "how long to run, 0 until stopped", kNotNegative);
  settings.add("out", &config.out, "folder for the recording, empty for none");
  settings.add("status_json", &config.status_json, "print status as JSON lines on stdout");
  settings.add("loop.rate_Hz", &config.station.rate_Hz, "turns a second", {100.0, 10000.0});
  add_settings(settings, "loop.", config.realtime);
  add_settings(settings, "", config.station);
}

}  // namespace teleop
