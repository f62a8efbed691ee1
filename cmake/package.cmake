# `cpack -G DEB` makes two packages: shapelight, the tool with its manual and completions, and libshapelight-dev, the
# headers, the static library and the CMake package.
install(FILES LICENSE DESTINATION share/doc/shapelight RENAME copyright COMPONENT tool)
install(FILES LICENSE DESTINATION share/doc/libshapelight-dev RENAME copyright COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The shapelight developers <shapelight@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL tool development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_TOOL_PACKAGE_NAME shapelight)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_TOOL_DESCRIPTION
    "Samples, simplifies and registers meshes, range images and point\nclouds from the command line.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libshapelight-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libtbb-dev, libfmt-dev, libpng-dev, liblzf-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Headers, static library and CMake package of the C++ library.")
include(CPack)
