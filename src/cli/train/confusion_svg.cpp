#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/train/train_report.h"
#include "report/escape_text.h"

namespace vesalius::cli {
namespace {

constexpr int kCell_px = 20;
constexpr int kLabel_px = 110;  ///< space for names at the left of the cells and above them
constexpr int kTitle_px = 20;

/// Returns white for 0 and dark blue for 1. The square root emphasises small shares, which are the interesting ones.
std::string colour_of(double share) {
  const double dark = std::sqrt(std::clamp(share, 0.0, 1.0));
  const auto level = [&](double end) { return static_cast<int>(std::lround(255.0 + (end - 255.0) * dark)); };
  return fmt::format("#{:02x}{:02x}{:02x}", level(8.0), level(48.0), level(107.0));
}

std::string row_svg(const Confusion& confusion, int truth, const std::string& name) {
  const int top = kLabel_px + kTitle_px + truth * kCell_px;
  std::string svg = fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kLabel_px + kTitle_px - 5,
                                top + kCell_px - 6, escape_html(name));
  const auto sum = static_cast<double>(confusion.row_sum(truth));
  for (int given = 0; given < confusion.classes; ++given) {
    const double share = sum > 0.0 ? static_cast<double>(confusion.at(truth, given)) / sum : 0.0;
    const int left = kLabel_px + kTitle_px + given * kCell_px;
    svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", left, top, kCell_px,
                       kCell_px, colour_of(share));
    const int percent = static_cast<int>(std::lround(100.0 * share));
    if (percent == 0) continue;
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"9\" fill=\"{}\">{}</text>\n",
                       left + kCell_px / 2, top + kCell_px / 2 + 3, share > 0.3 ? "#ffffff" : "#000000", percent);
  }
  return svg;
}

}  // namespace

std::string confusion_svg(const Confusion& confusion, const std::vector<std::string>& names) {
  const int begin = kLabel_px + kTitle_px;
  const int size = begin + confusion.classes * kCell_px + kTitle_px;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{0}\" viewBox=\"0 0 {0} {0}\" "
      "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" height=\"{0}\" fill=\"#ffffff\"/>\n",
      size);
  svg += fmt::format("<text x=\"{}\" y=\"14\" text-anchor=\"middle\">given class</text>\n", (begin + size) / 2);
  svg += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"middle\">true class</text>\n",
                     (begin + size) / 2);
  for (int c = 0; c < confusion.classes; ++c) {
    const std::string& name = names[c];
    svg += fmt::format("<text transform=\"translate({} {}) rotate(-90)\">{}</text>\n",
                       begin + c * kCell_px + kCell_px - 6, begin - 5, escape_html(name));
    svg += row_svg(confusion, c, name);
  }
  return svg + "</svg>\n";
}

}  // namespace vesalius::cli
