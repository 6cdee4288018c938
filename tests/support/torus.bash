# torus NU NV FILE.obj PICTURE.pfm [ALPHA]: a mesh with texture coordinates, its material beside it, and the picture.
torus() {
  local name=${3%.obj}
  awk -v nu="$1" -v nv="$2" -v name="$name" 'BEGIN {
    pi = 3.14159265358979
    print "mtllib " name ".mtl\nusemtl skin"
    for (i = 0; i <= nu; i++)
      for (j = 0; j <= nv; j++) {
        a = 2 * pi * i / nu; b = 2 * pi * j / nv
        printf "v %.6f %.6f %.6f\nvt %.6f %.6f\n", (1 + 0.4 * cos(b)) * cos(a), (1 + 0.4 * cos(b)) * sin(a), 0.4 * sin(b), i / nu, j / nv
      }
    for (i = 0; i < nu; i++)
      for (j = 1; j <= nv; j++) {
        k = i * (nv + 1) + j; m = k + nv + 1
        printf "f %d/%d %d/%d %d/%d %d/%d\n", k, k, m, m, m + 1, m + 1, k + 1, k + 1
      }
  }' > "$3"
  printf 'newmtl skin\nKd 0.9 0.8 0.7\nd %s\nmap_Kd %s\n' "${5:-1}" "$4" > "$name.mtl"
  local one='\0\0\200\077' half='\0\0\0\077' none='\0\0\0\0'
  printf "PF\n2 2\n-1\n$one$half$none$half$one$half$none$none$one$one$one$half" > "$4"
}
