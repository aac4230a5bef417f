# Finds Embree 3 by its header and library and defines the target embree: the config file of Embree 3.8, which Ubuntu
# 20.04 has, defines none.
find_path(EMBREE_INCLUDE_DIR embree3/rtcore.h)
find_library(EMBREE_LIBRARY embree3)
mark_as_advanced(EMBREE_INCLUDE_DIR EMBREE_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Embree DEFAULT_MSG EMBREE_LIBRARY EMBREE_INCLUDE_DIR)
if(Embree_FOUND AND NOT TARGET embree)
  add_library(embree UNKNOWN IMPORTED)
  set_target_properties(embree PROPERTIES
    IMPORTED_LOCATION ${EMBREE_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${EMBREE_INCLUDE_DIR})
endif()
