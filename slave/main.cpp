#include "core/program/command_line.hpp"
#include "core/program/side.hpp"
#include "transport/plug.hpp"

namespace {

/// The slave is the surroundings' side: it waits for a master to call.
int run(int argc, char** argv) {
  teleop::UdpLink::Config link{.bind = "127.0.0.1:47001", .peer = ""};
  return teleop::run_side(teleop::Role::slave, argc, argv, teleop::udp_plug(link));
}

}  // namespace

int main(int argc, char** argv) { return teleop::run_program("teleop-slave", run, argc, argv); }
