// SPDX-License-Identifier: BSD-3-Clause
// The fixed parts of the report page. cmake/embed.cmake writes the definitions from the files in
// this folder and from Debian's libjs-d3. UTF-8.
#pragma once

#include <string_view>

namespace lsv::report_assets {

extern const std::string_view kPageHtml;  // with {{placeholders}}, see report.cpp
extern const std::string_view kStyleCss;
extern const std::string_view kScriptJs;
extern const std::string_view kD3Js;
extern const std::string_view kD3Licence;  // plain text

}  // namespace lsv::report_assets
