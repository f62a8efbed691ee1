include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/shapelight)
install(TARGETS shapelight EXPORT shapelight_targets COMPONENT development)
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT shapelight_targets NAMESPACE shapelight:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(cmake/shapelightConfig.cmake.in shapelightConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(shapelightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/shapelightConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/shapelightConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
