// SPDX-License-Identifier: BSD-3-Clause
// A drawing as SVG text. No background; the greys here read on white and on black. Coordinates in
// px, y downwards.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lsv {

inline constexpr std::string_view kInk = "#7b838d";      // text and axes
inline constexpr std::string_view kFaint = "#7b838d55";  // grid

struct Point {
  double x = 0.0;
  double y = 0.0;
};

enum class Anchor { start, middle, end };
enum class Marker { circle, square, triangle };

/// `words` as markup shows them.
std::string escaped(std::string_view words);

class Svg {
 public:
  /// `title` is what a screen reader says.
  Svg(int width, int height, std::string_view title);

  void line(Point from, Point to, std::string_view colour, double width = 1.0,
            bool is_dashed = false);
  void polyline(const std::vector<Point>& points, std::string_view colour, double width = 1.5);
  void rect(Point corner, double width, double height, std::string_view colour,
            double opacity = 1.0);
  void marker(Marker shape, Point at, double radius, std::string_view colour);
  /// `at`: end of the base line that `anchor` names.
  void label(Point at, std::string_view words, Anchor anchor = Anchor::start, double size = 12.0,
             std::string_view colour = kInk);
  /// Read from below to above, centred at `at`.
  void upright_label(Point at, std::string_view words, double size = 12.0);

  /// The whole document.
  std::string str() const { return body_ + "</svg>\n"; }

 private:
  std::string body_;
};

}  // namespace lsv
