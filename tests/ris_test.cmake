pkg_check_modules(CMOCKA REQUIRED IMPORTED_TARGET cmocka)

# ris_test_program(<name> <library>...): builds <name>.c of the current folder against cmocka.
function(ris_test_program name)
  add_executable(${name} ${name}.c)
  target_link_libraries(${name} PRIVATE ${ARGN} ris_flags PkgConfig::CMOCKA m)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/engine ${PROJECT_SOURCE_DIR}/tests ${CMAKE_BINARY_DIR}/shaders)
  target_compile_definitions(${name} PRIVATE RIS_SOURCE_DIR="${PROJECT_SOURCE_DIR}" RIS_BUILD_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
endfunction()

# ris_add_test(<label> <name> <library>...): the same, run by ctest as <label>/<name>.
function(ris_add_test label name)
  ris_test_program(${name} ${ARGN})
  add_test(NAME ${label}/${name} COMMAND ${name})
  set_tests_properties(${label}/${name} PROPERTIES LABELS ${label} TIMEOUT 300)
endfunction()
