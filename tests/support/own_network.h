// SPDX-License-Identifier: BSD-3-Clause
// A loopback interface for this test alone, so that tests that listen on fixed ports run beside
// each other.
#pragma once

#include <string>

namespace lsv::test {

/// Moves the calling thread, and what it starts from now on, into a network of its own that has
/// 127.0.0.1 and 127.0.0.2 and nothing else. Returns why it cannot, or "": then the shared loopback
/// stays. Needs root or unprivileged user namespaces; in the latter case, no thread before.
std::string enter_own_network();

}  // namespace lsv::test
