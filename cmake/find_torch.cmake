# Looks for libtorch, for the backend "torch". Sets RADAR_DOT_HAS_TORCH.
set(RADAR_DOT_HAS_TORCH FALSE)
if(NOT RADAR_DOT_WITH_TORCH)
  message(STATUS "Backend torch (learned flow and depth): off (RADAR_DOT_WITH_TORCH)")
  return()
endif()
find_package(Torch QUIET)
if(NOT Torch_FOUND)
  message(STATUS "Backend torch (learned flow and depth): not built, libtorch is not found; install libtorch-dev "
    "and libopenblas0-pthread, or set Torch_DIR")
elseif(TORCH_CXX_FLAGS MATCHES "_GLIBCXX_USE_CXX11_ABI=0")
  message(WARNING "Backend torch (learned flow and depth): not built, the libtorch in ${Torch_DIR} has the old "
    "ABI of C++ strings, which ROS does not; take one with the \"cxx11 ABI\"")
else()
  message(STATUS "Backend torch (learned flow and depth): built with libtorch ${Torch_VERSION}")
  set(RADAR_DOT_HAS_TORCH TRUE)
endif()
