// SPDX-License-Identifier: BSD-3-Clause
// Which GenICam cameras answer: GigE Vision on every network interface and USB3 Vision.
#pragma once

#include <string>
#include <vector>

namespace lsv {

struct GenicamCamera {
  std::string id;  // what `genicam:` takes, e.g. "Aravis-Fake-LSV01"
  std::string vendor;
  std::string model;
  std::string serial;
  std::string address;   // IPv4 of a GigE camera, USB bus otherwise
  std::string protocol;  // "GigEVision", "USB3Vision"
};

/// Takes about a second: that is how long cameras may take to answer. One thread at a time.
std::vector<GenicamCamera> list_genicam_cameras();

}  // namespace lsv
