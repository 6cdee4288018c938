/* What core/splats/kernel.h has for one pixel, a pixel a lane. */

/* conic_exp_negative */
static lanes lanes_exp_negative(lanes x) {
  x = x > -80.0f ? x : -80.0f;
  int16 k = convert_int16(x * 0x1.715476p+0f - 0.5f);
  lanes k_float = convert_float16(k);
  lanes r = (x - k_float * 0x1.63p-1f) + k_float * 0x1.bd0106p-13f;
  lanes p = 0x1.6a23cap-10f;
  p = p * r + 0x1.123a20p-7f;
  p = p * r + 0x1.5558f2p-5f;
  p = p * r + 0x1.555492p-3f;
  p = p * r + 0x1.fffffcp-2f;
  p = (p * (r * r) + r) + 1.0f;
  return as_float16(as_int16(p) + k * (1 << 23));
}
