// SPDX-License-Identifier: BSD-3-Clause
#include "tools/number_option.h"

#include "lsv/output/number_text.h"

namespace lsv::cli {

Result<void> take(const CLI::App& command, const NumberOption& number) {
  if (command.count(number.name) == 0) return {};
  // Written so that NaN fails.
  if (!(number.typed >= number.least && number.typed <= number.most)) {
    return Error{ErrorCode::invalid_argument,
                 number.name + formatted(" is %.6g but must be between %.6g and %.6g", number.typed,
                                         number.least, number.most)};
  }
  *number.si = number.typed * number.si_per_typed;
  return {};
}

}  // namespace lsv::cli
