# What `cmake --install` puts where: the program, its scenes, the Python package and the documents.
include(GNUInstallDirs)
set(STRIDOR_PYTHON_DIR "lib/python3/dist-packages" CACHE PATH "Where Python packages are installed, below the prefix")

install(TARGETS stridor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Not the meshes that gmsh makes beside its geometries.
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/stridor USE_SOURCE_PERMISSIONS
  REGEX "-[0-9a-f]+\\.msh$" EXCLUDE)
install(FILES docs/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/stridor)
install(DIRECTORY python/stridor DESTINATION ${STRIDOR_PYTHON_DIR}
  PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CITATION.cff LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN "*.md" PATTERN "*.ipynb" PATTERN "*.png" PATTERN "*.gif")

# Pages of the manual, which the program itself writes, and completion in shells.
set(STRIDOR_MANUAL "${PROJECT_BINARY_DIR}/manual")
add_custom_command(OUTPUT "${STRIDOR_MANUAL}/stridor.1"
  COMMAND stridor manual "${STRIDOR_MANUAL}" "${PROJECT_SOURCE_DIR}/docs"
  DEPENDS stridor "${PROJECT_SOURCE_DIR}/docs" VERBATIM)
add_custom_target(manual ALL DEPENDS "${STRIDOR_MANUAL}/stridor.1")
install(DIRECTORY "${STRIDOR_MANUAL}/" DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
install(DIRECTORY "${STRIDOR_MANUAL}/" DESTINATION ${CMAKE_INSTALL_MANDIR}/man5 FILES_MATCHING PATTERN "*.5")
install(FILES cmake/completions/stridor.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME stridor)
install(FILES cmake/completions/_stridor DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES cmake/completions/stridor.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
