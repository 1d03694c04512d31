#include "report/plot.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <limits>

#include "io/files/test_files.h"
#include "report/plot_process.h"

namespace vesalius {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool has_gnuplot() { return std::system("command -v gnuplot >/dev/null") == 0; }
#define NEEDS_GNUPLOT() \
  if (!has_gnuplot()) GTEST_SKIP() << "no program gnuplot (Debian: gnuplot-nox)"

LinePlot two_lines() {
  LinePlot plot;
  plot.title = "Detection";
  plot.x_label = "parts";
  plot.y_label = "rate";
  plot.series = {{"ours", {{1, 0.9}, {2, 0.8}, {3, 0.5}}}, {"theirs", {{1, 0.5}, {2, 0.4}, {3, 0.1}}}};
  return plot;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

/// Sets PATH to one folder while an object of this class lives.
class PathIs {
 public:
  explicit PathIs(const std::string& path) : old_(std::getenv("PATH")) { ::setenv("PATH", path.c_str(), 1); }
  ~PathIs() { ::setenv("PATH", old_.c_str(), 1); }
  PathIs(const PathIs&) = delete;
  PathIs& operator=(const PathIs&) = delete;

 private:
  std::string old_;
};

TEST(Plot, DrawsLinesThatDifferWithoutColour) {
  NEEDS_GNUPLOT();
  const std::string svg = plot_svg(two_lines());
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr(">Detection<"));
  EXPECT_THAT(svg, HasSubstr(">theirs<"));
  EXPECT_GE(count(svg, "stroke-dasharray"), 1U);  // the second line
  EXPECT_THAT(svg, HasSubstr("gpPt6"));           // its mark differs from the first one's
  EXPECT_THAT(svg, HasSubstr("gpPt3"));
  EXPECT_EQ(plot_svg(two_lines()), svg);
}

TEST(Plot, ShowsTextWithoutCommandsOrMarkup) {
  NEEDS_GNUPLOT();
  const test::TemporaryFolder folder;
  LinePlot plot = two_lines();
  plot.title = "it's `touch " + folder / "a" + "` <b>&amp; _1 {x}";
  plot.series[0].name = "x'; system \"touch " + folder / "b" + "\"\nset";
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(folder.file_count(), 0U);
  EXPECT_THAT(svg, HasSubstr("it's `touch "));
  EXPECT_THAT(svg, HasSubstr("` &lt;b>&amp;amp; _1 {x}<"));
}

TEST(Plot, BreaksLinesAtGapsAndNamesEmptySeriesInTheLegend) {
  NEEDS_GNUPLOT();
  LinePlot plot = two_lines();
  plot.series[0].points = {{1, 0.2}, {2, 0.4}, {kNaN, kNaN}, {3, 0.5}, {4, 0.9}};
  plot.series[1].points = {{1, kNaN}};
  const std::string svg = plot_svg(plot);
  EXPECT_THAT(svg, HasSubstr(">theirs<"));
  plot.series[0].points.erase(plot.series[0].points.begin() + 2);
  EXPECT_NE(plot_svg(plot), svg);
}

TEST(Plot, HasTheRequestedRangesAndLogAxis) {
  NEEDS_GNUPLOT();
  LinePlot plot = two_lines();
  plot.log_x = true;
  plot.x_range = PlotRange{0.1, 1000.0};
  plot.y_range = PlotRange{0.0, 1.0};
  EXPECT_THAT(plot_svg(plot), HasSubstr("> 1000<"));
}

MatrixPlot two_classes() {
  return {"Confusion", "true class", "given class", {"l_hand", "back<ground"}, {{0.75, 0.25}, {0.004, 0.0}}};
}

TEST(Plot, DrawsTheSharesOfAMatrix) {
  NEEDS_GNUPLOT();
  const std::string svg = plot_svg(two_classes());
  EXPECT_THAT(svg, HasSubstr(">75<"));
  EXPECT_THAT(svg, HasSubstr(">25<"));
  EXPECT_THAT(svg, Not(HasSubstr(">0<")));
  EXPECT_EQ(count(svg, ">l_hand<"), 2U);
  EXPECT_EQ(count(svg, ">back&lt;ground<"), 2U);
  EXPECT_LT(svg.find(">75<"), svg.find(">25<"));
}

TEST(Plot, RefusesMatricesThatCannotBeDrawn) {
  const auto error = [](auto change) {
    MatrixPlot plot = two_classes();
    change(plot);
    return test::error_of([&] { plot_svg(plot); });
  };
  const char* expected = "plot Confusion: expected 2 rows of as many shares from 0 to 1";
  EXPECT_THAT(error([](MatrixPlot& plot) { plot.shares.pop_back(); }), HasSubstr(expected));
  EXPECT_THAT(error([](MatrixPlot& plot) { plot.shares[1].push_back(0.5); }), HasSubstr(expected));
  EXPECT_THAT(error([](MatrixPlot& plot) { plot.shares[0][1] = kNaN; }), HasSubstr(expected));
  EXPECT_THAT(error([](MatrixPlot& plot) { plot.shares[0][1] = 1.1; }), HasSubstr(expected));
  EXPECT_THAT(error([](MatrixPlot& plot) { plot = {"Confusion", "", "", {}, {}}; }), HasSubstr("expected 0 rows"));
}

TEST(Plot, RefusesPlotsThatCannotBeDrawn) {
  LinePlot plot = two_lines();
  plot.series[0].points[0].first = 0.0;
  plot.log_x = true;
  EXPECT_THAT(test::error_of([&] { plot_svg(plot); }), HasSubstr("plot Detection: ours: x = 0, expected more than 0"));
  plot = two_lines();
  plot.y_range = PlotRange{1.0, 1.0};
  EXPECT_THAT(test::error_of([&] { plot_svg(plot); }), HasSubstr("range 1 to 1"));
  plot.y_range = PlotRange{0.0, kNaN};
  EXPECT_THAT(test::error_of([&] { plot_svg(plot); }), HasSubstr("range 0 to nan"));
  plot = two_lines();
  plot.series = {{"none", {{kNaN, 1.0}}}};
  EXPECT_THAT(test::error_of([&] { plot_svg(plot); }), HasSubstr("no points"));
}

TEST(Plot, SaysThatGnuplotIsMissing) {
  const test::TemporaryFolder empty;
  const PathIs path(empty.path());
  EXPECT_THAT(test::error_of([&] { plot_svg(two_lines()); }),
              StartsWith("plot Detection: gnuplot: not found, expected this program in PATH (Debian: gnuplot-nox)"));
}

TEST(Plot, SaysWhyGnuplotFailed) {
  const test::TemporaryFolder folder;
  test::put(folder / "gnuplot", "#!/bin/sh\necho 'line 3: no such terminal' >&2\nexit 4\n");
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const PathIs path(folder.path());
  EXPECT_THAT(test::error_of([&] { plot_svg(two_lines()); }), HasSubstr("exit code 4: line 3: no such terminal"));
}

TEST(RunProcess, PassesInputAndReturnsOutputs) {
  const std::string input(300000, 'x');
  const ProcessResult result = run_process({"sh", "-c", "cat; echo oops >&2; exit 3"}, input, 10.0);
  EXPECT_EQ(result.out, input);
  EXPECT_EQ(result.err, "oops\n");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(run_process({"sh", "-c", "exit 0"}, input, 10.0).exit_code, 0);  // input unread
  EXPECT_EQ(run_process({"sh", "-c", "kill -9 $$"}, "", 10.0).exit_code, 137);
}

TEST(RunProcess, StopsAProgramThatDoesNotEnd) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(test::error_of([] { run_process({"sleep", "60"}, "", 0.2); }), HasSubstr("sleep: did not end in time"));
  EXPECT_THAT(test::error_of([] {
                run_process({"sh", "-c", "exec >&- 2>&-; exec sleep 60"}, "", 0.2);
              }),
              HasSubstr("did not end in time"));
  EXPECT_THAT(test::error_of([] { run_process({"yes"}, "", 20.0); }), HasSubstr("yes: wrote more than"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

}  // namespace
}  // namespace vesalius
