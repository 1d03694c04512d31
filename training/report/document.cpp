#include "report/document.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/files/atomic_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Json = nlohmann::json;

// CMake writes the bytes of bundle/report.html.gz.
#include "report_page.inc"

constexpr std::string_view kPlace = ">null</script>";  ///< where the page expects what it shows

/// Returns the page without a report. The last four bytes of gzip are the length.
std::string empty_page() {
  const std::uint8_t* end = std::end(kReportPage);
  std::string page(end[-4] | end[-3] << 8U | end[-2] << 16U | static_cast<std::size_t>(end[-1]) << 24U, '\0');
  z_stream stream{};
  stream.next_in = const_cast<Bytef*>(kReportPage);
  stream.avail_in = sizeof kReportPage;
  stream.next_out = reinterpret_cast<Bytef*>(page.data());
  stream.avail_out = static_cast<uInt>(page.size());
  const bool whole = inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK && inflate(&stream, Z_FINISH) == Z_STREAM_END;
  inflateEnd(&stream);
  if (!whole) throw Error("report: the program's page is damaged");
  return page;
}

/// Encodes bytes in base64 (RFC 4648) with padding.
std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kAlphabet[group >> (18U - 6U * k) & 63U] : '=';
  }
  return text;
}

/// Returns JSON in which nothing can end the script that it lies in.
std::string in_script(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    c == '<' ? text += "\\u003c" : text += c;
  }
  return text;
}

void append(const Json& block, std::string& blocks) { blocks += (blocks.empty() ? "" : ",\n") + in_script(block); }

Json range_json(const std::optional<std::pair<double, double>>& range) { return range ? Json(*range) : Json(nullptr); }

bool has_points(const PlotSeries& series) {
  return std::ranges::any_of(series.points,
                             [](const auto& point) { return std::isfinite(point.first + point.second); });
}

}  // namespace

Document::Document(std::string title) : title_(std::move(title)) {}

void Document::heading(int level, std::string_view text) {
  if (level < 2 || level > 6) throw Error(fmt::format("document: heading of level {}, expected 2 to 6", level));
  append({{"kind", "heading"}, {"level", level}, {"text", text}}, blocks_);
}

void Document::paragraph(std::string_view text) { append({{"kind", "paragraph"}, {"text", text}}, blocks_); }

void Document::preformatted(std::string_view text) { append({{"kind", "preformatted"}, {"text", text}}, blocks_); }

void Document::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  if (header.empty()) throw Error("document: a table without columns");
  Json all = Json::array({header});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    all.push_back(rows[r]);
    if (rows[r].size() == header.size()) continue;
    throw Error(fmt::format("document: row {} of a table has {} cells, expected {}", r, rows[r].size(), header.size()));
  }
  append({{"kind", "table"}, {"rows", std::move(all)}}, blocks_);
}

void Document::picture(std::string_view png, std::string_view caption) {
  if (!png.starts_with("\x89PNG")) throw Error(fmt::format("document: {}: no PNG", caption));
  append({{"kind", "picture"}, {"png", base64(png)}, {"caption", caption}}, blocks_);
}

void Document::plot(const LinePlot& plot) {
  if (std::ranges::none_of(plot.series, has_points)) return;
  Json series = Json::array();
  for (const PlotSeries& line : plot.series) series.push_back({{"name", line.name}, {"points", line.points}});
  append({{"kind", "plot"},
          {"caption", plot.caption},
          {"x", plot.x_label},
          {"y", plot.y_label},
          {"log_x", plot.log_x},
          {"x_range", range_json(plot.x_range)},
          {"y_range", range_json(plot.y_range)},
          {"series", std::move(series)}},
         blocks_);
}

void Document::matrix(const MatrixPlot& matrix) {
  const std::size_t count = matrix.names.size();
  const auto fits = [&](const std::vector<double>& row) { return row.size() == count; };
  if (matrix.shares.size() != count || !std::ranges::all_of(matrix.shares, fits)) {
    throw Error(fmt::format("document: {}: expected {} rows of as many shares", matrix.caption, count));
  }
  append({{"kind", "matrix"}, {"caption", matrix.caption}, {"names", matrix.names}, {"shares", matrix.shares}},
         blocks_);
}

void Document::bars(const BarPlot& plot) {
  for (const auto& [name, shares] : plot.series) {
    if (shares.size() == plot.names.size()) continue;
    throw Error(fmt::format("document: {}: expected {} shares of {}", plot.caption, plot.names.size(), name));
  }
  append({{"kind", "bars"}, {"caption", plot.caption}, {"names", plot.names}, {"series", plot.series}}, blocks_);
}

std::string Document::html() const {
  std::string page = empty_page();
  const std::string report = fmt::format(R"(>{{"title":{},"blocks":[{}]}}</script>)", in_script(title_), blocks_);
  return page.replace(page.find(kPlace), kPlace.size(), report);
}

void make_report_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder, error.message()));
}

void write_report_page(const Document& document, const std::string& folder) {
  write_file_atomically((std::filesystem::path(folder) / "report.html").string(), document.html());
}

}  // namespace vesalius
