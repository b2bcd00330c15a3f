// SPDX-License-Identifier: BSD-3-Clause
// How make_correlator() reaches the engines; nobody else needs their types.
#pragma once

#include <memory>

#include "correlation/correlator.h"

namespace lsv {

std::unique_ptr<Correlator> make_direct_correlator(const FrameFormat& format, const LagRange& lags);
/// `engine` is zncc, cross or phase.
std::unique_ptr<Correlator> make_fft_correlator(Engine engine, const FrameFormat& format,
                                                const LagRange& lags);

}  // namespace lsv
