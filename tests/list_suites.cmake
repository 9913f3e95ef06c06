# Run when a program is linked: writes the ctest entries of it, LABEL.Suite; of suites with parameters one for every
# parameter, LABEL.Suite/parameter.
# cmake -D PROGRAM=FILE -D LABEL=accuracy -D TIMEOUT=600 -D OUTPUT=FILE -P list_suites.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE " *#[^\n]*" "" listing "${listing}")
string(REGEX MATCHALL "[^\n]+" lines "${listing}")
set(names "")
set(entries "")
foreach(line IN LISTS lines)
  set(parameter "")
  if(line MATCHES "^([^ ]+)\\.$")
    set(suite "${CMAKE_MATCH_1}")
    continue()
  elseif(line MATCHES "^  [^/]+(/.+)?$")
    set(parameter "${CMAKE_MATCH_1}")
  else()
    continue()
  endif()
  set(name "${LABEL}.${suite}${parameter}")
  if(NOT name IN_LIST names)
    list(APPEND names "${name}")
    string(APPEND entries
      "add_test([=[${name}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*${parameter}]=])\n"
      "set_tests_properties([=[${name}]=] PROPERTIES LABELS [=[${LABEL}]=] TIMEOUT ${TIMEOUT}"
      " FAIL_REGULAR_EXPRESSION [=[Running 0 tests;SKIPPED]=])\n")
  endif()
endforeach()
if(entries STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} has no tests")
endif()
file(WRITE "${OUTPUT}" "${entries}")
