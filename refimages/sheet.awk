# A rectangle of n x n discs as an ascii PLY, in two colours by squares. Only + - * / and integers, so that every awk
# writes the same numbers.
#   awk -f sheet.awk -v n=40 -v center="0 0 2" -v along="1 0 0" -v across="0 1 0" -v outline=1.5 \
#       -v squares=8 -v colors="230 220 200 40 50 90"
# along and across reach from the centre to the middles of two edges; outline is a disc's radius in spacings.
BEGIN {
  split(center, c, " ")
  split(along, a, " ")
  split(across, b, " ")
  split(colors, rgb, " ")
  print "ply\nformat ascii 1.0\nelement vertex " n * n
  print "property float x\nproperty float y\nproperty float z"
  print "property float tu_x\nproperty float tu_y\nproperty float tu_z"
  print "property float tv_x\nproperty float tv_y\nproperty float tv_z"
  print "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header"
  sigma = outline / 1.5 * 2 / n
  for (j = 0; j < n; j++)
    for (i = 0; i < n; i++) {
      s = (2 * i + 1) / n - 1
      t = (2 * j + 1) / n - 1
      odd = squares ? (int(i * squares / n) + int(j * squares / n)) % 2 : 0
      printf "%.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %d %d %d\n", c[1] + s * a[1] + t * b[1],
        c[2] + s * a[2] + t * b[2], c[3] + s * a[3] + t * b[3], sigma * a[1], sigma * a[2], sigma * a[3], sigma * b[1],
        sigma * b[2], sigma * b[3], rgb[1 + 3 * odd], rgb[2 + 3 * odd], rgb[3 + 3 * odd]
    }
}
