// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/fft.h"

namespace lsv {

int fast_fft_length(int at_least) {
  for (int quarter = (at_least + 3) / 4;; ++quarter) {
    int rest = quarter;
    for (const int factor : {2, 3, 5}) {
      while (rest > 1 && rest % factor == 0) rest /= factor;
    }
    if (rest <= 1) return 4 * (quarter < 1 ? 1 : quarter);
  }
}

}  // namespace lsv
