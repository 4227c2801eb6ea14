# Types of one interface package, for Python and the middleware of the wheels: two thirds of what
# rosidl_default_generators would build. The libraries have names of their own (UNIT), so that one
# process can load types of one package that were built apart.
cmake_minimum_required(VERSION 3.21)
project(${PACKAGE})
set(PYTHON_INSTALL_DIR python)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../../lib")
foreach(needed ament_cmake_core ament_cmake_python rosidl_cmake rosidl_adapter
    rosidl_generator_type_description rosidl_generator_c rosidl_typesupport_fastrtps_c
    rosidl_typesupport_introspection_c rosidl_typesupport_c rosidl_generator_py ${DEPENDENCIES})
  find_package(${needed} REQUIRED)
endforeach()
# They name folders of the machine on which the wheels were built.
get_property(imported DIRECTORY PROPERTY IMPORTED_TARGETS)
list(FILTER imported INCLUDE REGEX "__rosidl_generator_py$")
set_target_properties(${imported} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "")
# Looks for the other two libraries by this name.
set(templates "${CMAKE_BINARY_DIR}/templates")
file(COPY "${rosidl_typesupport_c_TEMPLATE_DIR}/" DESTINATION "${templates}")
set(rosidl_typesupport_c_TEMPLATE_DIR "${templates}")
foreach(kind msg srv)
  file(READ "${templates}/${kind}__type_support.cpp.em" text)
  string(REPLACE "\"@(package_name)\"," "\"${UNIT}\"," text "${text}")
  file(WRITE "${templates}/${kind}__type_support.cpp.em" "${text}")
endforeach()
list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "cpp:")
rosidl_generate_interfaces(${UNIT} ${FILES} DEPENDENCIES ${DEPENDENCIES})
ament_package()
