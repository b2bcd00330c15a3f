// SPDX-License-Identifier: BSD-3-Clause
// Takes the place of GLib's g_poll() in this program, which is why the simulator is a program of
// its own: no other part of lsv may wait this way.
//
// The fake camera of Aravis 0.8.26 computes how long to wait until the next frame as an unsigned
// difference. When it is late by a microsecond the difference wraps, and it waits for 100 ms: at
// 1 kHz that is a hundred frames, several times a minute. In the last millisecond before a frame it
// asks for 0 ms again and again, which keeps a core busy. It looks at its clock after every wait,
// so both are cured by waits that are short, but not zero.
#include <glib.h>
#include <poll.h>

#include <algorithm>
#include <cstdint>
#include <ctime>

namespace {

constexpr std::int64_t kShortWait_ns = 100'000;
/// What a wait that wrapped is cut to, and also what an idle camera asks for.
constexpr int kSuspectWait_ms = 100;

/// A wait that may be a wrapped one is as short as the last steps before a frame.
std::int64_t wait_ns(int timeout_ms) {
  if (timeout_ms < 0 || timeout_ms >= kSuspectWait_ms) return kShortWait_ns;
  return std::max<std::int64_t>(kShortWait_ns, std::int64_t{timeout_ms} * 1'000'000);
}

}  // namespace

extern "C" gint g_poll(GPollFD* fds, guint count, gint timeout_ms) {
  // GPollFD is struct pollfd, as GLib asserts for every Unix.
  const std::int64_t wait = wait_ns(timeout_ms);
  const timespec limit = {.tv_sec = static_cast<time_t>(wait / 1'000'000'000),
                          .tv_nsec = static_cast<long>(wait % 1'000'000'000)};
  return ::ppoll(reinterpret_cast<pollfd*>(fds), count, &limit, nullptr);
}
