# Objects that were compiled before, here or in another build, are taken from ccache where it is installed.
if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(SHAPELIGHT_CCACHE ccache)
  if(SHAPELIGHT_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${SHAPELIGHT_CCACHE})
  endif()
endif()
