// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/genicam_list.h"

#include <arv.h>

namespace lsv {

std::vector<GenicamCamera> list_genicam_cameras() {
  const auto text = [](const char* from) { return std::string(from != nullptr ? from : ""); };
  arv_update_device_list();
  std::vector<GenicamCamera> cameras;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    cameras.push_back({.id = text(arv_get_device_id(i)),
                       .vendor = text(arv_get_device_vendor(i)),
                       .model = text(arv_get_device_model(i)),
                       .serial = text(arv_get_device_serial_nbr(i)),
                       .address = text(arv_get_device_address(i)),
                       .protocol = text(arv_get_device_protocol(i))});
  }
  return cameras;
}

}  // namespace lsv
