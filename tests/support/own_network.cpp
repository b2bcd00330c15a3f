// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/own_network.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lsv::test {
namespace {

ifreq request_for(const char* interface) {
  ifreq request = {};
  std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
  return request;
}

bool bring_up(int socket, const char* interface) {
  ifreq request = request_for(interface);
  if (::ioctl(socket, SIOCGIFFLAGS, &request) != 0) return false;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  return ::ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

bool add_address(int socket, const char* interface, const char* address) {
  ifreq request = request_for(interface);
  sockaddr_in in = {};
  in.sin_family = AF_INET;
  if (::inet_pton(AF_INET, address, &in.sin_addr) != 1) return false;
  std::memcpy(&request.ifr_addr, &in, sizeof in);
  return ::ioctl(socket, SIOCSIFADDR, &request) == 0;
}

}  // namespace

std::string enter_own_network() {
  if (::unshare(CLONE_NEWNET) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
    return std::string("no network of its own: ") + std::strerror(errno);
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  if (socket < 0) return std::string("no sockets: ") + std::strerror(errno);
  const bool up = bring_up(socket, "lo") && add_address(socket, "lo:1", "127.0.0.2");
  const int error_number = errno;
  ::close(socket);
  return up ? "" : std::string("the loopback does not come up: ") + std::strerror(error_number);
}

}  // namespace lsv::test
