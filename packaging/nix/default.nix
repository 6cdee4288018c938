# nix-build packaging/nix: the program and the library, from this tree.
{ pkgs ? import <nixpkgs> { } }:

pkgs.stdenv.mkDerivation {
  pname = "conic";
  version = "0.6.0";
  src = pkgs.lib.cleanSource ../..;

  nativeBuildInputs = with pkgs; [ cmake ninja perl pkg-config ];
  buildInputs = with pkgs; [
    assimp
    brotli
    curl
    libdeflate
    libpng
    libwebp
    libxml2
    ocl-icd
    opencl-headers
    openexr
    openimageio
    zlib
    zstd
  ];

  cmakeFlags = [ "-DCONIC_BUILD_TESTS=OFF" ];

  doInstallCheck = true;
  installCheckPhase = ''
    $out/bin/conic make knot -n 10k -o knot.ply
    $out/bin/conic render knot.ply --plain -o knot.pfm
  '';

  meta = {
    description = "A software rasteriser for surface splatting";
    license = pkgs.lib.licenses.bsd3;
    mainProgram = "conic";
    platforms = pkgs.lib.platforms.linux;
  };
}
