// SPDX-License-Identifier: BSD-3-Clause
// Aravis and GLib are not instrumented, so that ThreadSanitizer sees what they read and write with
// memcpy() but not the locks that they hold meanwhile.
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() { return "ignore_noninstrumented_modules=1"; }
