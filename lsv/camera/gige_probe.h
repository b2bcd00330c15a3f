// SPDX-License-Identifier: BSD-3-Clause
// Asks a GigE Vision camera who controls it, with one packet of its control protocol and an answer
// within 300 ms. Aravis finds out that an address is silent, or that another program holds the
// camera, only after 2.5 s of repeats, in which a program cannot stop.
// Internal to lsv/camera. Any thread.
#pragma once

#include <string>

namespace lsv {

enum class GigeAnswer {
  free,        // there, and nobody controls it
  controlled,  // there, and another program controls it
  silent,      // nothing answers at this address
  no_address,  // not an IPv4 address in numbers
};

GigeAnswer probe_gige(const std::string& address);

}  // namespace lsv
