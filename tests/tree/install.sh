#!/usr/bin/env bash
# Installs into an empty folder, moves that, and builds the examples against it: by find_package (shared and
# static) and by pkg-config. Each program must draw a picture that is not black, and all the same one.
set -euo pipefail

source_folder=$1
build_folder=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

setting() { # NAME: its value in the build
  sed -nE "s/^$1:[A-Z]+=(.*)$/\1/p" "$build_folder/CMakeCache.txt"
}

if [[ -n $(setting CONIC_SANITIZE) ]]; then
  echo "skipped: a sanitized library is not one to install"
  exit 77
fi

cmake --install "$build_folder" --prefix "$work/first" > /dev/null
mv "$work/first" "$work/prefix"
library_folder=$(dirname "$(find "$work/prefix" -name libconic.so)")
export LD_LIBRARY_PATH=$library_folder

# A program asks for a library that the package's version file takes for as good: of the same major and minor version.
interface_version=$(sed -nE 's/^#define CONIC_VERSION_(MAJOR|MINOR) //p' "$source_folder/include/conic/version.h" | paste -sd.)
readelf -d "$library_folder/libconic.so" | grep -q "SONAME.*\[libconic\.so\.$interface_version\]" ||
  { echo "the SONAME is not of version $interface_version"; exit 1; }
symbols=$(nm -D --defined-only --with-symbol-versions "$library_folder/libconic.so" | awk '$2 != "A" {print $3}')
[[ -n $symbols ]] && ! grep -vq "@@CONIC_$interface_version\$" <<< "$symbols" || { echo "symbols without a version"; exit 1; }

module=$library_folder/conic/conic-openimageio.so # where OpenImageIO was there to build it

not_black() { # PFM: some byte behind the header is not zero
  [[ -s $1 && $(tail -c +64 "$1" | tr -d '\000' | wc -c) -gt 0 ]]
}
# The check itself, on a black picture and a grey one.
{ printf 'PF\n8 8\n-1.0\n' && head -c 768 /dev/zero; } > "$work/black.pfm"
{ printf 'PF\n8 8\n-1.0\n' && head -c 768 /dev/zero | tr '\000' '?'; } > "$work/grey.pfm"
if not_black "$work/black.pfm" || ! not_black "$work/grey.pfm"; then
  echo "the check for black is wrong"
  exit 1
fi

mkdir "$work/project"
cat > "$work/project/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.25)
project(minimal LANGUAGES C)
find_package(conic 0.4 REQUIRED)
add_executable(shared "$source_folder/examples/minimal.c")
target_link_libraries(shared conic::conic m)
add_executable(any_file "$source_folder/examples/any_file.c")
target_link_libraries(any_file conic::conic)
option(STATIC "" OFF)
if(STATIC)
  find_package(conic 0.4 REQUIRED COMPONENTS static)
  add_executable(static "$source_folder/examples/minimal.c")
  target_link_libraries(static conic::static)
endif()
END

build_package() { # NAME, CMake settings …
  local name=$1
  shift
  cmake -S "$work/project" -B "$work/$name" -G "$(setting CMAKE_GENERATOR)" -DCMAKE_PREFIX_PATH="$work/prefix" \
    -DCMAKE_C_COMPILER="$(setting CMAKE_C_COMPILER)" "$@" > "$work/$name.log" 2>&1 &&
    cmake --build "$work/$name" >> "$work/$name.log" 2>&1 && return
  cat "$work/$name.log"
  exit 1
}
draw() { # PROGRAM
  "$1" "$1.pfm" || { echo "$1 failed"; exit 1; }
  not_black "$1.pfm" || { echo "$1 drew a black picture"; exit 1; }
  [[ ! -e $module ]] || "$1" "$1.tif" || { echo "$1 does not find $module"; exit 1; }
}

build_package by_package
draw "$work/by_package/shared"

# Whatever file there is, the other example draws.
"$work/prefix/bin/conic" make plane -n 100 -o "$work/plane.ply"
"$work/prefix/bin/conic" octree "$work/plane.ply" -o "$work/plane.cot"
files=("$work/plane.ply" "$work/plane.cot")
if [[ -e $library_folder/conic/conic-assimp.so ]]; then # the other module, which is found as the first
  printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' > "$work/plane.off"
  files+=("$work/plane.off")
fi
for file in "${files[@]}"; do
  "$work/by_package/any_file" "$file" "$file.pfm" || { echo "any_file does not draw $file"; exit 1; }
  not_black "$file.pfm" || { echo "any_file draws $file black"; exit 1; }
done

build_package by_package_static -DSTATIC=ON
draw "$work/by_package_static/static"
cmp "$work/by_package/shared.pfm" "$work/by_package_static/static.pfm"

if command -v pkg-config > /dev/null; then
  export PKG_CONFIG_PATH=$library_folder/pkgconfig
  # shellcheck disable=SC2046 # its answer is several words
  "$(setting CMAKE_C_COMPILER)" -std=c11 "$source_folder/examples/minimal.c" -o "$work/by_pkg_config" $(pkg-config --cflags --libs conic) -lm
  draw "$work/by_pkg_config"
  cmp "$work/by_package/shared.pfm" "$work/by_pkg_config.pfm"
else
  echo "no pkg-config here: that way was not tried"
fi

"$work/prefix/bin/conic" --version > "$work/version"
grep -q "^conic " "$work/version"

# The program finds the module where it stands now, through a link too, and says so where it is missing or not conic's.
if [[ -e $module ]]; then
  program=$work/linked
  ln -s "$work/prefix/bin/conic" "$program"
  has_module() { "$program" --version | grep -q '^In this build:.*OpenImageIO'; }
  draw_tiff() { "$program" render --plain "$work/plane.ply" --size 16x16 -o "$work/plane.tif"; }
  refuses_tiff() { # WHAT the message says
    local code=0
    draw_tiff 2> "$work/message" || code=$?
    [[ $code -eq 4 ]] && grep -q "plane.tif: cannot write: .*$1" "$work/message" && return
    echo "code $code: $(cat "$work/message")"
    exit 1
  }
  has_module
  draw_tiff
  echo "no library" > "$module"
  refuses_tiff conic-openimageio.so
  rm "$module"
  ! has_module
  refuses_tiff conic-openimageio.so
  "$program" render --plain "$work/plane.ply" --size 16x16 -o "$work/plane.pfm" # all else is as before
fi
