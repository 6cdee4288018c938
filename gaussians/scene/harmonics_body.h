/* The real harmonics of 3DGS in finite directions, for a NUMBER that is a double or a vector of them. */

static inline void evaluate_harmonics(const NUMBER direction[3], int degree, NUMBER *y) {
  NUMBER x = direction[0], v = direction[1], z = direction[2], xx = x * x, yy = v * v, zz = z * z;
  y[0] = 0.28209479177387814 + 0.0 * x;
  if (degree < 1)
    return;
  y[1] = -0.48860251190291992 * v;
  y[2] = 0.48860251190291992 * z;
  y[3] = -0.48860251190291992 * x;
  if (degree < 2)
    return;
  y[4] = 1.0925484305920791 * x * v;
  y[5] = -1.0925484305920791 * v * z;
  y[6] = 0.31539156525252005 * (2.0 * zz - xx - yy);
  y[7] = -1.0925484305920791 * x * z;
  y[8] = 0.54627421529603959 * (xx - yy);
  if (degree < 3)
    return;
  y[9] = -0.59004358992664352 * v * (3.0 * xx - yy);
  y[10] = 2.8906114426405538 * x * v * z;
  y[11] = -0.45704579946446577 * v * (4.0 * zz - xx - yy);
  y[12] = 0.37317633259011546 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy);
  y[13] = -0.45704579946446577 * x * (4.0 * zz - xx - yy);
  y[14] = 1.4453057213202769 * z * (xx - yy);
  y[15] = -0.59004358992664352 * x * (xx - 3.0 * yy);
  if (degree < 4)
    return;
  y[16] = 2.5033429417967046 * x * v * (xx - yy);
  y[17] = -1.7701307697799304 * v * z * (3.0 * xx - yy);
  y[18] = 0.94617469575755997 * x * v * (7.0 * zz - 1.0);
  y[19] = -0.66904654355728917 * v * z * (7.0 * zz - 3.0);
  y[20] = 0.10578554691520431 * (zz * (35.0 * zz - 30.0) + 3.0);
  y[21] = -0.66904654355728917 * x * z * (7.0 * zz - 3.0);
  y[22] = 0.47308734787877998 * (xx - yy) * (7.0 * zz - 1.0);
  y[23] = -1.7701307697799304 * x * z * (xx - 3.0 * yy);
  y[24] = 0.62583573544917614 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy));
}
