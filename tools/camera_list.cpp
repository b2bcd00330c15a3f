// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_list.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "lsv/camera/genicam_list.h"

namespace lsv::cli {
namespace {

void print_text(const std::vector<GenicamCamera>& cameras) {
  if (cameras.empty()) std::puts("no GenICam camera answers");
  for (const GenicamCamera& camera : cameras) {
    std::printf("genicam:%s  %s %s %s, %s, %s\n", camera.id.c_str(), camera.vendor.c_str(),
                camera.model.c_str(), camera.serial.c_str(), camera.protocol.c_str(),
                camera.address.c_str());
  }
}

void print_json(const std::vector<GenicamCamera>& cameras) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const GenicamCamera& camera : cameras) {
    list.push_back({{"id", camera.id},
                    {"vendor", camera.vendor},
                    {"model", camera.model},
                    {"serial", camera.serial},
                    {"address", camera.address},
                    {"protocol", camera.protocol}});
  }
  const nlohmann::ordered_json all = {{"schema", "lsv.cameras/1"}, {"cameras", list}};
  // What a camera says of itself need not be UTF-8.
  std::puts(all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

}  // namespace

Result<void> print_cameras(bool json) {
  const std::vector<GenicamCamera> cameras = list_genicam_cameras();
  if (json) {
    print_json(cameras);
  } else {
    print_text(cameras);
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return Error{ErrorCode::output_failed, "standard output could not be written"};
  return {};
}

}  // namespace lsv::cli
