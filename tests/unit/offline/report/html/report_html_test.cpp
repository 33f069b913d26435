// SPDX-License-Identifier: Apache-2.0
// The page as text, and as a browser sees it: headless Chromium draws every chart without an error.
#include "offline/report/html/report_html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "offline/report/html/html_page.h"
#include "offline/report/html/worst_cases.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::HasSubstr;

/// HasSubstr would print the whole page, library included, where it fails.
bool has(const std::string& page, const std::string& text) { return page.find(text) != std::string::npos; }

RigidTransform at(double x, double y, double z) { return RigidTransform(Eigen::Translation3d(x, y, z)); }

/// Two objects, one of them often wrong, with everything that a page can show.
EvaluationReport rich_report() {
  std::map<int, EvaluatedObject> objects;
  for (const int id : {1, 2}) {
    objects[id].diameter_m = 0.2;
    for (int i = 0; i < 8; ++i)
      objects[id].points.emplace_back(i & 1 ? 0.05 : -0.05, i & 2 ? 0.05 : -0.05, i & 4 ? 0.05 : -0.05);
  }
  std::vector<BopImage> images;
  std::vector<BopResult> results;
  for (int i = 0; i < 12; ++i) {
    BopImage image;
    image.scene_id = 1;
    image.image_id = i;
    image.camera.fx = image.camera.fy = 500;
    image.camera.cx = 320;
    image.camera.cy = 240;
    const int id = 1 + i % 2;
    if (i < 10) image.ground_truth.push_back({id, at(0, 0, 0.8), 1.0 - 0.08 * i, std::nullopt});
    const double turn = i % 3 == 0 ? 1.0 : 0.03 * i;
    if (i != 4) {
      results.push_back({1, i, id, 0.95 - 0.05 * i,
                         at(0.001 * i, 0, 0.8) * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()),
                         0.02 + 0.001 * i});
    }
    images.push_back(image);
  }
  return evaluate(images, results, objects, {});
}

TEST(ReportHtml, IsSelfContainedAndEscaped) {
  const std::string html = format_report_html(rich_report(), "a <b> & \"c\"");
  EXPECT_TRUE(has(html, "a &lt;b&gt; &amp; &quot;c&quot;")) << "a &lt;b&gt; &amp; &quot;c&quot;";
  EXPECT_TRUE(has(html, "not found")) << "not found";
  EXPECT_TRUE(has(html, "default-src 'none'")) << "default-src 'none'";
  EXPECT_TRUE(has(html, "Released under the MIT License")) << "Released under the MIT License";
  for (const char* outside : {"src=\"http", "src='http", "href=", "@import", "url("}) {
    EXPECT_FALSE(has(html, outside)) << outside;
  }
  for (const char* chart :
       {"precision", "position", "rotation", "distances", "turns", "visibility", "calibration", "times"}) {
    EXPECT_TRUE(has(html, "data-chart=" + std::string(chart))) << "data-chart=" + std::string(chart);
  }
  EXPECT_TRUE(has(html, "Within the true box")) << "Within the true box";
}

TEST(ReportHtml, OfNothingIsAPageToo) {
  const EvaluationReport empty;
  const std::string html = format_report_html(empty, "x");
  EXPECT_TRUE(has(html, "Not right: 0 of 0")) << "Not right: 0 of 0";
  EXPECT_FALSE(has(html, "<div class=plot>"));
}

TEST(ReportHtml, DataCannotEndTheScript) {
  const std::string html = html_page("t", "", R"({"charts":{},"x":"</script><b>"})");
  EXPECT_FALSE(has(html, "</script><b>")) << "</script><b>";
  EXPECT_TRUE(has(html, "\\u003c/script>\\u003cb>")) << "\\u003c/script>\\u003cb>";
}

TEST(Base64, AsRfc4648Says) {
  EXPECT_EQ("", base64(""));
  EXPECT_EQ("Zg==", base64("f"));
  EXPECT_EQ("Zm8=", base64("fo"));
  EXPECT_EQ("Zm9v", base64("foo"));
  EXPECT_EQ("Zm9vYmFy", base64("foobar"));
}

TEST(WorstCases, NotFoundComesFirstThenTheFarthestOff) {
  const EvaluationReport report = rich_report();
  const auto worst = worst_instances(report);
  ASSERT_GE(worst.size(), 3U);
  EXPECT_FALSE(worst[0]->found);
  for (std::size_t i = 2; i < worst.size(); ++i)
    EXPECT_GE(worst[i - 1]->rotation_deg, worst[i]->rotation_deg);
}

TEST(WorstCases, PicturesShowTruthAndAnswerInTheirColours) {
  const TemporaryFolder folder;
  write_png(folder / "c.png", cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90)));
  write_png(folder / "d.png", cv::Mat(240, 320, CV_16UC1, cv::Scalar(800)));
  BopImage image;
  image.scene_id = 1;
  image.image_id = 0;
  image.colour = folder / "c.png";
  image.depth = folder / "d.png";
  image.camera.fx = image.camera.fy = 250;
  image.camera.cx = 160;
  image.camera.cy = 120;
  image.ground_truth.push_back({1, at(0, 0, 0.8), 0.9, std::nullopt});
  std::map<int, EvaluatedObject> objects;
  objects[1].points = {{0, 0, 0}};
  const EvaluationReport report = evaluate({image}, {{1, 0, 1, 0.5, at(0.1, 0, 0.8), -1}}, objects, {});
  ModelMesh square;
  square.vertices = {{-0.05F, -0.05F, 0}, {0.05F, -0.05F, 0}, {0.05F, 0.05F, 0}, {-0.05F, 0.05F, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto pictures = worst_case_pictures(report, {image}, {{1, square}});
  ASSERT_EQ(1U, pictures.size());
  EXPECT_THAT(pictures[0].caption, HasSubstr("10.0 cm"));
  const cv::Mat picture = decode_jpeg(std::as_bytes(std::span(pictures[0].jpeg)), "picture");
  int green = 0;
  int magenta = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec3b c = picture.at<cv::Vec3b>(y, x);
      green += c[1] > 150 && c[0] < 100 ? 1 : 0;
      magenta += c[0] > 180 && c[1] < 100 ? 1 : 0;
    }
  }
  EXPECT_GT(green, 100);
  EXPECT_GT(magenta, 100);
  EXPECT_TRUE(worst_case_pictures(report, {image}, {}).empty()) << "no mesh, no outline";
}

std::string chromium() {
  for (const char* program : {"chromium", "chromium-browser", "google-chrome"}) {
    if (std::system(("command -v " + std::string(program) + " >/dev/null 2>&1").c_str()) == 0) return program;
  }
  return "";
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  char buffer[4096];
  while (pipe) {
    const std::size_t n = fread(buffer, 1, sizeof buffer, pipe.get());
    if (n == 0) break;
    text.append(buffer, n);
  }
  return text;
}

TEST(ReportHtml, ChromiumDrawsEveryChartWithoutAnError) {
  const std::string browser = chromium();
  if (browser.empty()) GTEST_SKIP() << "no Chromium on this machine (apt-get install chromium)";
  const TemporaryFolder folder;
  const std::string html = format_report_html(rich_report(), "Chromium");
  write_file_bytes(folder / "r.html", std::as_bytes(std::span(html)));
  const std::string common =
      "timeout 120 " + browser +
      " --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir=" +
      (folder / "profile").string() + " --virtual-time-budget=5000 ";
  const std::string page = " file://" + (folder / "r.html").string() + " 2>/dev/null";
  const std::string dom = output_of(common + "--dump-dom" + page);
  EXPECT_TRUE(has(dom, "data-charts=\"8\"")) << dom.substr(0, 200);
  EXPECT_FALSE(has(dom, "data-error")) << dom.substr(0, 300);
  // What it looks like: the canvases hold more than one colour each, so the picture holds many.
  output_of(common + "--hide-scrollbars --window-size=1200,2600 --screenshot=" + (folder / "r.png").string() +
            page);
  const cv::Mat picture = read_colour_image(folder / "r.png");
  EXPECT_EQ(1200, picture.cols);
  int blue = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec3b c = picture.at<cv::Vec3b>(y, x);
      blue += c[0] < 60 && c[1] > 90 && c[1] < 150 && c[2] > 150 ? 1 : 0;
    }
  }
  EXPECT_GT(blue, 3000) << "the first colour of the charts";
}

}  // namespace
}  // namespace sextant
