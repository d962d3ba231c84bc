# librisorius: all folders in one archive (and optionally one shared object), with its headers, CMake package and
# pkg-config file. Programs link `librisorius`; tests link the folders they test.
get_property(folders GLOBAL PROPERTY RIS_FOLDERS)
set(objects)
foreach(folder ${folders})
  list(APPEND objects $<TARGET_OBJECTS:${folder}>)
endforeach()

set(ris_libraries PkgConfig::JANSSON PkgConfig::STB m)
set(RISORIUS_PC_MODULES "jansson stb")
if(RISORIUS_VULKAN)
  list(APPEND ris_libraries Vulkan::Vulkan)
  string(APPEND RISORIUS_PC_MODULES " vulkan")
endif()
set(RIS_SANITIZE_FLAGS "")
if(RISORIUS_SANITIZE)
  set(RIS_SANITIZE_FLAGS "-fsanitize=address,undefined")
endif()

function(ris_library target type)
  add_library(${target} ${type} ${objects})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME risorius LINKER_LANGUAGE C
                        ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
  target_include_directories(${target} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/shaders/shared)
  target_link_libraries(${target} PUBLIC ${ris_libraries} ris_flags)
  install(TARGETS ${target} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

ris_library(librisorius STATIC)
if(RISORIUS_SHARED)
  ris_library(librisorius_shared SHARED)
  set_target_properties(librisorius_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
endif()

install(DIRECTORY include/risorius DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_SOURCE_DIR}/shaders/shared/sim_shared.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/risorius)

include(CMakePackageConfigHelpers)
configure_file(risorius.pc.in ${CMAKE_BINARY_DIR}/risorius.pc @ONLY)
configure_package_config_file(risorius-config.cmake.in ${CMAKE_BINARY_DIR}/risorius-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/risorius
                              PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/risorius-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/risorius-config.cmake ${CMAKE_BINARY_DIR}/risorius-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/risorius)
install(FILES ${CMAKE_BINARY_DIR}/risorius.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
