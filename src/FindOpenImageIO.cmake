# OpenImageIO::OpenImageIO from OpenImageIO's own package files, without the include folders that do
# not exist (Debian 12's name OpenCV's, which OpenImageIO's headers need only for its OpenCV bridge).
find_package(OpenImageIO ${OpenImageIO_FIND_VERSION} CONFIG REQUIRED)
foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
  get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
  set(existing "")
  foreach(folder IN LISTS folders)
    if(EXISTS "${folder}")
      list(APPEND existing "${folder}")
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing}")
endforeach()
