// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/health_snapshot.h"

namespace lsv {

std::string_view word(StreamState state) {
  switch (state) {
    case StreamState::starting:
      return "starting";
    case StreamState::running:
      return "running";
    case StreamState::lost:
      return "lost";
    case StreamState::degraded:
      return "degraded";
    case StreamState::ended:
      return "ended";
  }
  return "unknown";
}

std::string_view word(FrameRejection rejection) {
  switch (rejection) {
    case FrameRejection::none:
      return "none";
    case FrameRejection::damaged:
      return "damaged";
    case FrameRejection::wrong_format:
      return "wrong_format";
    case FrameRejection::duplicate:
      return "duplicate";
    case FrameRejection::late:
      return "late";
    case FrameRejection::refused:
      return "refused";
  }
  return "unknown";
}

}  // namespace lsv
