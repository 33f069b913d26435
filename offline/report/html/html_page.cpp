// SPDX-License-Identifier: Apache-2.0
#include "offline/report/html/html_page.h"

#include <algorithm>

namespace sextant {
namespace web {
// Packed by the build (cmake/embed_file.cmake).
extern const unsigned char chart_umd_min_js[];
extern const unsigned long chart_umd_min_js_size;
extern const unsigned char report_js[];
extern const unsigned long report_js_size;
extern const unsigned char report_css[];
extern const unsigned long report_css_size;
}  // namespace web

namespace {

std::string_view packed(const unsigned char* bytes, unsigned long size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// "<" inside of a JSON string is the same as \u003c; outside of strings it does not occur.
std::string safe_json(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string escaped_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

std::string html_page(const std::string& title, const std::string& body, const std::string& data_json) {
  std::string page =
      "<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n"
      "<meta http-equiv=Content-Security-Policy content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data:\">\n"
      "<meta name=viewport content='width=device-width, initial-scale=1'>\n<title>";
  page += escaped_html(title) + "</title>\n<style>\n";
  page += packed(web::report_css, web::report_css_size);
  page += "</style>\n</head>\n<body>\n<main>\n" + body + "</main>\n";
  page += "<script type='application/json' id=data>" + safe_json(data_json) + "</script>\n<script>\n";
  page += packed(web::chart_umd_min_js, web::chart_umd_min_js_size);
  page += "\n</script>\n<script>\n";
  page += packed(web::report_js, web::report_js_size);
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace sextant
