include(CMakePackageConfigHelpers)
install(TARGETS shapelight EXPORT shapelight_targets)
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT shapelight_targets NAMESPACE shapelight:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/shapelight)
configure_package_config_file(cmake/shapelightConfig.cmake.in shapelightConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/shapelight)
write_basic_package_version_file(shapelightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/shapelightConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/shapelightConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/shapelight)
