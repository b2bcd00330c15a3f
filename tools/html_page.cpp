// SPDX-License-Identifier: BSD-3-Clause
#include "tools/html_page.h"

#include "lsv/output/svg.h"

namespace lsv::cli {
namespace {

constexpr const char* kStyle =
    ":root{color-scheme:light dark}\n"
    "body{font:15px/1.5 sans-serif;max-width:62em;margin:2em auto;padding:0 1em}\n"
    "h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.15em;margin-top:2em}\n"
    "table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .8em;text-align:right;"
    "border-bottom:1px solid #8885;font-variant-numeric:tabular-nums}td{white-space:nowrap}\n"
    "td:first-child,th:first-child{text-align:left}\n"
    ".figures td:nth-child(2),.figures th:nth-child(2),.figures td:last-child{text-align:left}\n"
    "figure{margin:1em 0;overflow-x:auto}figcaption,.note{color:#7b838d;font-size:.9em}\n"
    "figure svg{max-width:100%;height:auto}\n"
    ".maps{display:flex;flex-wrap:wrap;gap:1em}.map{margin:0}\n"
    ".map img{width:18em;image-rendering:pixelated;border:1px solid #8885;display:block}\n"
    ".plots{display:grid;gap:1em;grid-template-columns:repeat(auto-fit,minmax(min(26em,100%),1fr))}"
    "\n"
    "pre{overflow-x:auto}p,li{overflow-wrap:anywhere}\n"
    ".plots svg{width:100%;height:auto}.scroll{overflow-x:auto}\n"
    ".tiles{display:flex;flex-wrap:wrap;gap:1em 3em;margin:1.5em 0}\n"
    ".tiles b{display:block;font-size:1.7em;font-weight:600}\n"
    ".best td{font-weight:600;background:#2f80ed22}\n"
    ".warning{border-left:3px solid #d9542b;padding-left:.7em;margin:.5em 0}\n";

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
  out += escaped(title) + "</title>\n<style>\n" + kStyle + "</style></head><body>\n" + body;
  return out + "</body></html>\n";
}

}  // namespace lsv::cli
