// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/svg.h"

#include "lsv/output/number_text.h"

namespace lsv {
namespace {

std::string number(double value) { return formatted("%.1f", value); }

std::string pair_of(Point p) { return number(p.x) + "," + number(p.y); }

/// An attribute, with the space before it.
std::string quoted(std::string_view name, std::string_view value) {
  std::string out(1, ' ');
  out.append(name).append("=\"").append(value).append("\"");
  return out;
}

const char* word(Anchor anchor) {
  switch (anchor) {
    case Anchor::start:
      return "start";
    case Anchor::middle:
      return "middle";
    case Anchor::end:
      return "end";
  }
  return "start";
}

}  // namespace

std::string escaped(std::string_view words) {
  std::string out;
  for (const char c : words) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

Svg::Svg(int width, int height, std::string_view title) {
  body_ = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
      "font-family=\"sans-serif\" role=\"img\">\n",
      width, height, width, height);
  body_ += "<title>" + escaped(title) + "</title>\n";
}

void Svg::line(Point from, Point to, std::string_view colour, double width, bool is_dashed) {
  body_ += std::string("<line") + quoted("x1", number(from.x)) + quoted("y1", number(from.y)) +
           quoted("x2", number(to.x)) + quoted("y2", number(to.y)) + quoted("stroke", colour) +
           quoted("stroke-width", number(width)) +
           (is_dashed ? quoted("stroke-dasharray", "5,3") : "") + "/>\n";
}

void Svg::polyline(const std::vector<Point>& points, std::string_view colour, double width) {
  std::string list;
  for (const Point& p : points) {
    if (!list.empty()) list += ' ';
    list += pair_of(p);
  }
  body_ += std::string("<polyline") + quoted("points", list) + quoted("fill", "none") +
           quoted("stroke", colour) + quoted("stroke-width", number(width)) + "/>\n";
}

void Svg::rect(Point corner, double width, double height, std::string_view colour, double opacity) {
  body_ += std::string("<rect") + quoted("x", number(corner.x)) + quoted("y", number(corner.y)) +
           quoted("width", number(width)) + quoted("height", number(height)) +
           quoted("fill", colour) +
           (opacity < 1.0 ? quoted("fill-opacity", formatted("%.2f", opacity)) : "") + "/>\n";
}

void Svg::marker(Marker shape, Point at, double radius, std::string_view colour) {
  switch (shape) {
    case Marker::circle:
      body_ += std::string("<circle") + quoted("cx", number(at.x)) + quoted("cy", number(at.y)) +
               quoted("r", number(radius)) + quoted("fill", colour) + "/>\n";
      return;
    case Marker::square:
      rect({at.x - radius, at.y - radius}, 2.0 * radius, 2.0 * radius, colour);
      return;
    case Marker::triangle:
      body_ += std::string("<polygon") +
               quoted("points", pair_of({at.x, at.y - 1.2 * radius}) + " " +
                                    pair_of({at.x + 1.1 * radius, at.y + 0.8 * radius}) + " " +
                                    pair_of({at.x - 1.1 * radius, at.y + 0.8 * radius})) +
               quoted("fill", colour) + "/>\n";
      return;
  }
}

void Svg::label(Point at, std::string_view words, Anchor anchor, double size,
                std::string_view colour) {
  body_ += std::string("<text") + quoted("x", number(at.x)) + quoted("y", number(at.y)) +
           quoted("text-anchor", word(anchor)) + quoted("font-size", number(size)) +
           quoted("fill", colour) + ">" + escaped(words) + "</text>\n";
}

void Svg::upright_label(Point at, std::string_view words, double size) {
  body_ += std::string("<text") +
           quoted("transform", "translate(" + pair_of(at) + ") rotate(-90)") +
           quoted("text-anchor", "middle") + quoted("font-size", number(size)) +
           quoted("fill", kInk) + ">" + escaped(words) + "</text>\n";
}

}  // namespace lsv
