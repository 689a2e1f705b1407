# Counts the instructions of a run and of a point of a sweep that holds the same runs.
#
#   cmake -DPROGRAM=build/release/stridor -DVALGRIND=valgrind -DSCENE=scenes/beam_on_beam.yaml \
#         -DFOLDER=build/release -P bench/sweep_point.cmake
#
# A point that takes more than 0.3 of a run fails. It is what eight points take more than four: the
# bodies are reduced once.
set(settings --set time.integrator=exact --set time.step=5e-6 --set time.retain.frequency=35kHz)
set(results "${FOLDER}/sweep_point.h5")

# count(NAME ARGUMENTS ...): instructions of the program, thousands.
function(count name)
  execute_process(
    COMMAND "${VALGRIND}" --tool=callgrind --callgrind-out-file=/dev/null "${PROGRAM}" ${ARGN}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE error)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "the count failed (${result}):\n${output}${error}")
  endif()
  if(NOT "${error}" MATCHES "Collected : ([0-9]+)")
    message(FATAL_ERROR "callgrind has not printed a count:\n${error}")
  endif()
  math(EXPR thousands "${CMAKE_MATCH_1} / 1000")
  set(${name} ${thousands} PARENT_SCOPE)
endfunction()

function(count_sweep name points)
  count(${name} sweep "${SCENE}" --parameter contact.friction.coefficient --from 0.1 --to 0.35
    --points ${points} --threads 1 ${settings})
  set(${name} ${${name}} PARENT_SCOPE)
endfunction()

count(run run "${SCENE}" ${settings} -o "${results}" --force)
file(REMOVE "${results}")
count_sweep(four 4)
count_sweep(eight 8)
math(EXPR point "(${eight} - ${four}) / 4")
math(EXPR percent "100 * ${point} / ${run}")
message(STATUS "run: ${run} thousand instructions, a point of a sweep: ${point}, ${percent} %")
if(percent GREATER 30)
  message(FATAL_ERROR "a point of a sweep takes ${percent} % of the instructions of a run, more than 30 %")
endif()
