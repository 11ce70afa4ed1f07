# Included at the end of every directory with tests. With sanitizers: reports go to files, because nobody sees what a node of a
# rostest writes when it ends (scripts/test fails if there are any); and programs take up to ten times as long.
if(TISSUE_CONTACT_SANITIZE)
  set(reports log_path=${PROJECT_BINARY_DIR}/sanitizer_reports/report)
  get_property(all_tests DIRECTORY PROPERTY TESTS)
  foreach(test ${all_tests})
    get_test_property(${test} TIMEOUT limit)
    if(limit)
      math(EXPR limit "10 * ${limit}")
      set_tests_properties(${test} PROPERTIES TIMEOUT ${limit})
    endif()
    set_property(TEST ${test} APPEND PROPERTY ENVIRONMENT
      TISSUE_CONTACT_SLOWNESS=10
      "ASAN_OPTIONS=${reports}:strict_string_checks=1"
      "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_LIST_DIR}/leak.supp:print_suppressions=0"
      "UBSAN_OPTIONS=${reports}:print_stacktrace=1"
      "TSAN_OPTIONS=${reports}:suppressions=${CMAKE_CURRENT_LIST_DIR}/thread.supp:history_size=4")
  endforeach()
endif()
