# VESALIUS_HAS_CUDA: whether kernels for cards can be compiled. They need nvcc 12 or newer, which CMAKE_CUDA_COMPILER, CUDACXX or
# PATH name. Without it all else is built, and the program says that it has none.
set(VESALIUS_CUDA AUTO CACHE STRING "Kernels for cards: ON, OFF, or AUTO where nvcc is found")
set_property(CACHE VESALIUS_CUDA PROPERTY STRINGS AUTO ON OFF)
set(VESALIUS_HAS_CUDA FALSE)
if(VESALIUS_CUDA AND NOT VESALIUS_SANITIZE)
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    # Kept as code for later cards; made for A100, RTX 30, Orin and H100.
    set(CMAKE_CUDA_ARCHITECTURES 75-virtual 80 86 87 90)
    enable_language(CUDA)
    # CMake before 3.25.2 does not know this of nvcc 12 and newer.
    if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
      set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
      set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
    endif()
    set(VESALIUS_HAS_CUDA TRUE)
  elseif(NOT VESALIUS_CUDA STREQUAL AUTO)
    message(FATAL_ERROR "VESALIUS_CUDA=${VESALIUS_CUDA}: no nvcc; say where it is by -DCMAKE_CUDA_COMPILER=PATH")
  endif()
endif()

# vesalius_kernels(LIBRARY SOURCE): kernels for cards in a library.
function(vesalius_kernels library source)
  target_sources(vesalius_${library} PRIVATE ${source})
  # No fused multiply-add, as everywhere: the same bits as on the processor.
  target_compile_options(vesalius_${library} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:-fmad=false;--expt-relaxed-constexpr>")
  set_target_properties(vesalius_${library} PROPERTIES CUDA_STANDARD 20 CUDA_RUNTIME_LIBRARY Static)
endfunction()
