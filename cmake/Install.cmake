# What `cmake --install` puts where: the program, its scenes, the Python package and the documents.
include(GNUInstallDirs)
set(STRIDOR_PYTHON_DIR "lib/python3/dist-packages" CACHE PATH "Where Python packages are installed, below the prefix")

install(TARGETS stridor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Not the meshes that gmsh makes beside its geometries.
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/stridor
  REGEX "-[0-9a-f]+\\.msh$" EXCLUDE)
install(FILES docs/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/stridor)
install(DIRECTORY python/stridor DESTINATION ${STRIDOR_PYTHON_DIR}
  PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
  FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.gif")
