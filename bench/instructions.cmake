# Counts the instructions of a step and compares them with the figure kept in instructions.txt.
#
#   cmake -DPROGRAM=build/release/bench/step_forms -DVALGRIND=valgrind -DFORM=exact_50_kHz \
#         -DCOMPILER=Clang-14 \
#         -DKEPT=bench/instructions.txt -P bench/instructions.cmake
#
# More than 1 % above it fails; where it is 1 % below, the kept figure should be lowered.
set(steps 20000)
execute_process(
  COMMAND "${VALGRIND}" --tool=callgrind --callgrind-out-file=/dev/null
          "--toggle-collect=stridor::Simulation::step_until*" "${PROGRAM}" --instructions "${FORM}"
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE error)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the count failed (${result}):\n${output}${error}")
endif()
if(NOT "${error}" MATCHES "Collected : ([0-9]+)")
  message(FATAL_ERROR "callgrind has not printed a count:\n${error}")
endif()
math(EXPR measured "${CMAKE_MATCH_1} / ${steps}")

file(STRINGS "${KEPT}" lines REGEX "^${FORM} +${COMPILER} ")
if(NOT "${lines}" MATCHES "^${FORM} +${COMPILER} +([0-9]+)$")
  message(FATAL_ERROR "${KEPT} has no figure for ${FORM} by ${COMPILER}")
endif()
set(kept "${CMAKE_MATCH_1}")
math(EXPR allowed "${kept} * 101 / 100")
math(EXPR noteworthy "${kept} * 99 / 100")
message(STATUS "${FORM}: ${measured} instructions a step, ${kept} kept")
if(measured GREATER allowed)
  message(FATAL_ERROR "${FORM}: ${measured} instructions a step are more than 1 % above the ${kept} kept")
elseif(measured LESS noteworthy)
  message(STATUS "lower the figure in ${KEPT}")
endif()
