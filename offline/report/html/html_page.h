// SPDX-License-Identifier: Apache-2.0
// A self-contained HTML page: our style, Chart.js and our script inside of it, the data as JSON. It opens
// without a network and may load nothing from one (its content security policy says so).
#pragma once

#include <string>
#include <string_view>

namespace sextant {

/// &, <, >, " replaced.
std::string escaped_html(std::string_view text);

/// data:image/jpeg;base64,... of a CV_8UC3 picture's JPEG bytes.
std::string base64(std::string_view bytes);

/// title: plain text. body: HTML. data_json: read by the script (window.sextantData); "</" in it is
/// harmless. The root element's data-charts attribute tells how many charts were drawn, data-error the first
/// error of the script.
std::string html_page(const std::string& title, const std::string& body, const std::string& data_json);

}  // namespace sextant
