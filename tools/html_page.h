// SPDX-License-Identifier: BSD-3-Clause
// The frame of a report that is one self-contained page without script: head, style and policy.
// It follows the light or dark scheme of the browser and can be printed.
#pragma once

#include <string>

namespace lsv::cli {

/// `title` is plain text, `body` is markup. Classes with a style: warning, note, figures (a table
/// with words in its second and last column), best (a row of a table), maps and map (pictures of
/// pixels side by side), plots (drawings side by side), tiles (key figures in b), scroll.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace lsv::cli
