#!/usr/bin/env bash
# Installs into an empty folder, moves that, and builds the installed examples against it: by find_package (shared and
# static) and by pkg-config. Each program must draw a picture that is not black, and all the same one. What was installed
# is complete and can be taken away; another project takes conic in as a part of it.
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

# Packages are of this version.
version=$(sed -nE 's/^#define CONIC_VERSION_(MAJOR|MINOR|PATCH) //p' "$source_folder/include/conic/version.h" | paste -sd.)
grep -q "^conic ($version-" <(head -n 1 "$source_folder/debian/changelog") || { echo "debian/changelog is not of $version"; exit 1; }

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

# What is installed beside the libraries, and where whatever names folders of this machine is none of it.
examples=$(dirname "$(find "$work/prefix" -name minimal.c)")
for file in share/man/man1/conic.1 share/man/man1/conic-render.1 share/man/man3/conic_render.3 \
  share/bash-completion/completions/conic share/zsh/site-functions/_conic share/fish/vendor_completions.d/conic.fish; do
  [[ -s $work/prefix/$file ]] || { echo "$file is not installed"; exit 1; }
done
if grep -rE '(^|[^{}a-z])/(usr|tmp|home|work|lib)/' "$library_folder"/pkgconfig "$library_folder"/cmake; then
  echo "packages for CMake and pkg-config name folders of this machine"
  exit 1
fi

# What docs/guide/library.md says of versions that are asked for.
version_file=$(find "$work/prefix" -name conic-config-version.cmake)
takes() { # VERSION
  cat > "$work/asked.cmake" << END
string(REPLACE "." ";" parts "$1.0.0")
list(GET parts 0 PACKAGE_FIND_VERSION_MAJOR)
list(GET parts 1 PACKAGE_FIND_VERSION_MINOR)
set(PACKAGE_FIND_VERSION $1)
include("$version_file")
if(PACKAGE_VERSION_UNSUITABLE OR NOT PACKAGE_VERSION_COMPATIBLE)
  message(FATAL_ERROR "not taken")
endif()
END
  cmake -P "$work/asked.cmake" 2> /dev/null
}
for asked in "$interface_version" "$version"; do
  takes "$asked" || { echo "$asked is asked for, and $version is not taken"; exit 1; }
done
for asked in 0.2 0.2.0 "${version%.*}.99" "${interface_version%.*}.$((${interface_version#*.} + 1))" 9.0; do
  ! takes "$asked" || { echo "$asked is asked for, and $version is taken"; exit 1; }
done

mkdir "$work/static_project"
cat > "$work/static_project/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.25)
project(minimal LANGUAGES C)
find_package(conic $interface_version REQUIRED COMPONENTS static)
add_executable(static "$source_folder/examples/minimal.c")
target_link_libraries(static conic::static)
END

build_package() { # SOURCE_FOLDER, NAME, CMake settings …
  local source=$1 name=$2
  shift 2
  cmake -S "$source" -B "$work/$name" -G "$(setting CMAKE_GENERATOR)" -DCMAKE_PREFIX_PATH="$work/prefix" \
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

build_package "$examples" by_package
draw "$work/by_package/minimal"

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

# Shots are what the program draws: the mean of a fisheye's lit samples to the byte, and what goes into strips.
conic=$work/prefix/bin/conic
"$conic" make knot -n 4000 -o "$work/knot.ply"
"$work/by_package/lit_shot" "$work/knot.ply" "$work/lit.pfm" "$work/strips.exr" || { echo "lit_shot fails"; exit 1; }
"$conic" render "$work/knot.ply" --projection fisheye --size 256x256 --accumulate 16 --ao 16 --light head \
  --light lamp:0.5,0.5,2:2,1.5,1:0.25 -o "$work/lit_by_program.pfm"
cmp "$work/lit.pfm" "$work/lit_by_program.pfm"
"$conic" render "$work/knot.ply" --size 2048x2048 --samples 1 --light head -o "$work/whole.exr"
"$conic" diff "$work/strips.exr" "$work/whole.exr" > /dev/null || { echo "a picture in strips is another one"; exit 1; }

build_package "$work/static_project" by_package_static
draw "$work/by_package_static/static"
cmp "$work/by_package/minimal.pfm" "$work/by_package_static/static.pfm"

if command -v pkg-config > /dev/null; then
  export PKG_CONFIG_PATH=$library_folder/pkgconfig
  # shellcheck disable=SC2046 # its answer is several words
  "$(setting CMAKE_C_COMPILER)" -std=c11 "$source_folder/examples/minimal.c" -o "$work/by_pkg_config" $(pkg-config --cflags --libs conic) -lm
  draw "$work/by_pkg_config"
  cmp "$work/by_package/minimal.pfm" "$work/by_pkg_config.pfm"
  # The static library alone, without the shared one to fall back on.
  mkdir "$work/static_only"
  ln -s "$library_folder/libconic.a" "$work/static_only"
  read -ra words < <(pkg-config --static --cflags --libs conic)
  "$(setting CMAKE_C_COMPILER)" -std=c11 "$source_folder/examples/minimal.c" -o "$work/by_static_pkg_config" -L"$work/static_only" "${words[@]}"
  ! ldd "$work/by_static_pkg_config" | grep -q libconic || { echo "pkg-config --static links the shared library"; exit 1; }
  draw "$work/by_static_pkg_config"
  cmp "$work/by_package/minimal.pfm" "$work/by_static_pkg_config.pfm"
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

# Another project takes conic in: it gets the library, and neither an installation nor a build type that it did not ask for.
mkdir "$work/parent"
cat > "$work/parent/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.25)
project(parent LANGUAGES C)
include(FetchContent)
FetchContent_Declare(conic SOURCE_DIR "$source_folder")
FetchContent_MakeAvailable(conic)
add_executable(any_file "$source_folder/examples/any_file.c")
target_link_libraries(any_file conic::conic)
if(CMAKE_BUILD_TYPE OR TARGET uninstall OR NOT TARGET conic::static)
  message(FATAL_ERROR "conic does what is not its to do, or lacks its libraries")
endif()
END
cmake -S "$work/parent" -B "$work/parent/build" -G "$(setting CMAKE_GENERATOR)" -DCMAKE_C_COMPILER="$(setting CMAKE_C_COMPILER)" \
  -DCONIC_WITH_OPENIMAGEIO=OFF -DCONIC_WITH_ASSIMP=OFF > "$work/parent.log" 2>&1 || { cat "$work/parent.log"; exit 1; }
cmake --install "$work/parent/build" --prefix "$work/parent/prefix" > /dev/null
[[ -z $(find "$work/parent/prefix" -type f 2> /dev/null) ]] || { echo "a part of another project installs itself"; exit 1; }

# Uninstalling takes all of it away; the manifest is that of an installation without DESTDIR.
cmake -DMANIFEST="$work/manifest" -P "$source_folder/cmake/uninstall.cmake" 2> /dev/null && { echo "uninstalls without a manifest"; exit 1; }
mkdir "$work/prefix/share/doc/conic/mine"
touch "$work/prefix/share/doc/conic/mine/notes"
(cd "$work/prefix" && find "$work/prefix" ! -type d ! -name notes) > "$work/manifest"
cmake -DMANIFEST="$work/manifest" -P "$source_folder/cmake/uninstall.cmake"
[[ $(find "$work/prefix" ! -type d) == "$work/prefix/share/doc/conic/mine/notes" ]] || { echo "uninstalling leaves: $(find "$work/prefix" ! -type d | head)"; exit 1; }
[[ ! -e $work/prefix/include/conic ]] || { echo "uninstalling leaves include/conic"; exit 1; }
