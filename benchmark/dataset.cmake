# Reading nuScenes files. The benchmarks make their own data, so they need the test fixtures.
if(TARGET radar_dot_test_fixtures)
  radar_dot_benchmark(dataset_benchmark dataset_benchmark.cpp LINK radar_dot_test_fixtures radar_dot_dataset)
  target_compile_definitions(dataset_benchmark PRIVATE RADAR_DOT_SHARED_DATA="${RADAR_DOT_SHARED_DATA}")
endif()

# Not a google-benchmark: one load of tables as large as those of v1.0-trainval, and its memory.
if(RADAR_DOT_HAS_TOOLS)
  add_executable(large_tables_benchmark large_tables_benchmark.cpp)
  radar_dot_configure(large_tables_benchmark)
  target_link_libraries(large_tables_benchmark PRIVATE radar_dot_dataset radar_dot_command_line fmt::fmt)
  if(RADAR_DOT_HAS_TESTS)
    add_test(NAME large_tables_benchmark
      COMMAND large_tables_benchmark --rows 2000 --scenes 10 --folder ${CMAKE_CURRENT_BINARY_DIR}/small_tables)
  endif()
endif()
