#include "core/program/command_line.hpp"
#include "core/program/side.hpp"
#include "transport/plug.hpp"

namespace {

/// The master is the hand's side: it calls the slave and starts each engagement.
int run(int argc, char** argv) {
  teleop::UdpLink::Config link{.bind = "127.0.0.1:0", .peer = "127.0.0.1:47001"};
  return teleop::run_side(teleop::Role::master, argc, argv, teleop::udp_plug(link));
}

}  // namespace

int main(int argc, char** argv) { return teleop::run_program("teleop-master", run, argc, argv); }
