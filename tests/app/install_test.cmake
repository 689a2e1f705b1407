# Installs into PREFIX and runs a scene from there.
file(REMOVE_RECURSE "${PREFIX}")

function(run_in_order)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}\n${out}${err}")
  endif()
endfunction()

run_in_order("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}")
run_in_order("${PREFIX}/bin/stridor" check "${PREFIX}/share/stridor/scenes/beam_on_beam.yaml")
run_in_order("${PREFIX}/bin/stridor" eig "${PREFIX}/share/stridor/scenes/examples/from_calculix.yaml")
foreach(file share/doc/stridor/README.md share/doc/stridor/CITATION.cff share/doc/stridor/docs/theory.md share/stridor/scene.schema.json
        lib/python3/dist-packages/stridor/py.typed
        share/man/man1/stridor-run.1 share/man/man5/stridor-scene.5 share/bash-completion/completions/stridor
        share/zsh/site-functions/_stridor share/fish/vendor_completions.d/stridor.fish)
  if(NOT EXISTS "${PREFIX}/${file}")
    message(FATAL_ERROR "${file} has not been installed")
  endif()
endforeach()
# Without the source tree the package finds the program on the path, and the scenes beside it.
execute_process(COMMAND /usr/bin/python3 -c "import h5py, numpy" RESULT_VARIABLE has_h5py OUTPUT_QUIET ERROR_QUIET)
if(has_h5py EQUAL 0)
  run_in_order("${CMAKE_COMMAND}" -E env --unset=STRIDOR_PROGRAM "PATH=${PREFIX}/bin:$ENV{PATH}"
    "PYTHONPATH=${PREFIX}/lib/python3/dist-packages" /usr/bin/python3 -B -c
    "import stridor; assert stridor.eig(stridor.example('disc_and_pads')).values.size > 0; assert stridor.program().startswith('${PREFIX}')")
endif()
file(REMOVE_RECURSE "${PREFIX}")
