// SPDX-License-Identifier: BSD-3-Clause
// GLib's objects and errors with owners, so that no path forgets to release them.
// Internal to lsv/camera.
#pragma once

#include <arv.h>

#include <memory>
#include <string>

namespace lsv {

struct ReleaseObject {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename Object>
using ObjectPtr = std::unique_ptr<Object, ReleaseObject>;

/// The out-parameter of a call that can fail: `call(..., error.out()); if (error) ...`.
class GlibError {
 public:
  GlibError() = default;
  GlibError(const GlibError&) = delete;
  GlibError& operator=(const GlibError&) = delete;
  ~GlibError() { g_clear_error(&error_); }

  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  std::string text() const { return error_ != nullptr ? error_->message : ""; }

 private:
  GError* error_ = nullptr;
};

}  // namespace lsv
