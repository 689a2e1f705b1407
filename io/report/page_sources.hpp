// What a report is made of besides its contents. The source is generated from io/report/page and
// io/report/uplot when the program is built (cmake/EmbedReport.cmake).
#pragma once

#include <string_view>

namespace stridor {

extern const std::string_view report_markup;  ///< up to the blocks, with @TITLE@ and @STYLES@
extern const std::string_view report_styles;
extern const std::string_view report_script;
extern const std::string_view uplot_styles;
extern const std::string_view uplot_script;
extern const std::string_view uplot_licence;

}  // namespace stridor
