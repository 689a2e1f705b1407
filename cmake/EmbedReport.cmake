# Writes the source that holds the parts of a report: cmake -DFOLDER=io/report -DOUTPUT=FILE -P this.

function(embed name)
  set(text "")
  foreach(file IN LISTS ARGN)
    file(READ "${FOLDER}/${file}" part)
    string(APPEND text "${part}")
  endforeach()
  # Pieces, since the standard promises only 65,536 characters of a literal.
  string(LENGTH "${text}" length)
  set(pieces "")
  set(begin 0)
  while(begin LESS length)
    string(SUBSTRING "${text}" ${begin} 30000 piece)
    string(APPEND pieces "\n  R\"embedded(${piece})embedded\"")
    math(EXPR begin "${begin} + 30000")
  endwhile()
  file(APPEND "${OUTPUT}" "const std::string_view ${name} =${pieces};\n")
endfunction()

file(WRITE "${OUTPUT}"
  "#include \"io/report/page_sources.hpp\"\n\nnamespace stridor {\n")
embed(report_markup page/page.html)
embed(report_styles page/page.css)
embed(report_script ${SCRIPTS})
embed(uplot_styles uplot/uPlot.css)
embed(uplot_script uplot/uPlot.iife.js)
embed(uplot_licence uplot/LICENSE)
file(APPEND "${OUTPUT}" "}  // namespace stridor\n")
