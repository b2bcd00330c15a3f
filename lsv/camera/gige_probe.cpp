// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/gige_probe.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>

namespace lsv {
namespace {

constexpr std::uint16_t kControlPort = 3956;
constexpr int kTries = 3;
constexpr int kAnswerWithin_ms = 100;

// GigE Vision 2.0, section 16: a READREG command for the register "control channel privilege".
constexpr std::uint8_t kRequestId = 1;
constexpr std::array<std::uint8_t, 12> kReadPrivilege = {0x42, 0x01,       0x00, 0x80, 0x00, 0x04,
                                                         0x00, kRequestId, 0x00, 0x00, 0x0A, 0x00};

class UdpSocket {
 public:
  UdpSocket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket() {
    if (fd_ >= 0) ::close(fd_);
  }
  int fd() const { return fd_; }

 private:
  int fd_;
};

/// The acknowledgement: status, command READREG_ACK, length 4, id, then the value.
bool is_answer(const std::array<std::uint8_t, 12>& packet, ssize_t length) {
  return length == static_cast<ssize_t>(packet.size()) && packet[0] == 0 && packet[1] == 0 &&
         packet[2] == 0x00 && packet[3] == 0x81 && packet[7] == kRequestId;
}

GigeAnswer ask_once(int fd) {
  if (::send(fd, kReadPrivilege.data(), kReadPrivilege.size(), 0) < 0) return GigeAnswer::silent;
  pollfd wait = {.fd = fd, .events = POLLIN, .revents = 0};
  if (::poll(&wait, 1, kAnswerWithin_ms) <= 0) return GigeAnswer::silent;
  std::array<std::uint8_t, 12> answer{};
  const ssize_t length = ::recv(fd, answer.data(), answer.size(), MSG_DONTWAIT);
  if (!is_answer(answer, length)) return GigeAnswer::silent;
  const bool held = (answer[8] | answer[9] | answer[10] | answer[11]) != 0;
  return held ? GigeAnswer::controlled : GigeAnswer::free;
}

}  // namespace

GigeAnswer probe_gige(const std::string& address) {
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(kControlPort);
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) return GigeAnswer::no_address;
  const UdpSocket socket;
  if (::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    return GigeAnswer::silent;
  for (int i = 0; i < kTries; ++i) {
    const GigeAnswer answer = ask_once(socket.fd());
    if (answer != GigeAnswer::silent) return answer;
  }
  return GigeAnswer::silent;
}

}  // namespace lsv
