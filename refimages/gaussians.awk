# A Gaussian scene as an ascii PLY, made of one sequence of numbers: translucent, long and thin, of degree 1, before the
# eye at the origin. Only integers and + - * /, so that every awk writes the same numbers.
#   awk -f gaussians.awk -v n=400
function share() {
  state = (state * 16807) % 2147483647
  return state / 2147483647
}
BEGIN {
  state = 2023
  print "ply\nformat ascii 1.0\nelement vertex " n
  split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", names, " ")
  for (k = 1; k <= 14; k++)
    print "property float " names[k]
  for (k = 0; k < 9; k++)
    print "property float f_rest_" k
  print "end_header"
  for (i = 0; i < n; i++) {
    x = share() * 2 - 1
    y = share() * 2 - 1
    z = share() * 2.5 + 1
    line = sprintf("%.7g %.7g %.7g %.7g %.7g %.7g %.7g", x * z, y * z, z, 1.6 * x + 0.6 * share(), 1.2 - z * 0.6,
      1.6 * y + 0.6 * share(), share() * 8 - 3)
    for (k = 0; k < 3; k++) # logarithms
      line = line sprintf(" %.7g", -1.2 - 3.5 * share())
    for (k = 0; k < 4; k++)
      line = line sprintf(" %.7g", share() * 2 - 1)
    for (k = 0; k < 9; k++)
      line = line sprintf(" %.7g", share() * 0.8 - 0.4)
    print line
  }
}
