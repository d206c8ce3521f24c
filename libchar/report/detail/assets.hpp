#pragma once
// Files embedded in the library at build time (libchar/cmake/embed.cmake).

#include <string_view>

namespace libchar {

std::string_view chart_js();          ///< Chart.js 3, minified, from Debian's libjs-chart.js
std::string_view chart_js_licence();  ///< its copyright file, whole
std::string_view page_common_js();    ///< stands in front of each page's own script
std::string_view page_js();           ///< of a characterization
std::string_view page_css();
std::string_view many_page_css();  ///< of pages of several recordings; goes behind page_css
std::string_view fleet_page_js();
std::string_view fleet_page_css();  ///< goes behind page_css and many_page_css
std::string_view replay_page_js();
std::string_view replay_page_css();  ///< goes behind page_css

}  // namespace libchar
