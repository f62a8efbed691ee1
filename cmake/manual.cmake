# Manual pages and shell completions, from the tool's own --help.
find_package(Python3 COMPONENTS Interpreter QUIET)
if(NOT SHAPELIGHT_BUILD_APPS OR NOT Python3_FOUND)
  return()
endif()
file(GLOB manual_sources CONFIGURE_DEPENDS tools/manual.py tools/completions.py tools/command_help.py docs/*.md)
add_custom_command(OUTPUT share/man/man1/shapelight.1.gz DEPENDS shapelight_cli ${manual_sources}
  COMMAND ${CMAKE_COMMAND} -E rm -rf share
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/manual.py $<TARGET_FILE:shapelight_cli> share)
add_custom_target(shapelight_manual ALL DEPENDS share/man/man1/shapelight.1.gz)
install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT tool)
