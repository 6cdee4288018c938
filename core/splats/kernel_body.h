/* The kernels' values at q, 0 ≤ q < conic_kernel_support: the one text for floats, lanes of them and doubles. C and
 * OpenCL C share it. A kernel more is a case here. Who includes this has defined
 *
 *   KERNEL_VALUE, KERNEL_INLINE     the function's name, and what stands before it
 *   KERNEL_NUMBER                   what the parameters are taken as: float or double
 *   KERNEL_REAL, KERNEL_OF(x)       what q is, and one of a number
 *   KERNEL_SQRT(x), KERNEL_EXP(x)   its square root; eˣ for x ≤ 0
 *   KERNEL_ABOVE_0(x, y)            y where x > 0, 0 elsewhere
 *   KERNEL_GAUSS_OF(kernel, q)      e^(-q/2) */
KERNEL_INLINE KERNEL_REAL KERNEL_VALUE(const conic_kernel *kernel, KERNEL_REAL q) {
  const KERNEL_NUMBER cutoff = (KERNEL_NUMBER)kernel->cutoff;
  switch (kernel->type) {
  case CONIC_KERNEL_GAUSS:
    return KERNEL_GAUSS_OF(kernel, q);
  case CONIC_KERNEL_CONFETTI: {
    KERNEL_REAL r = KERNEL_SQRT(q) / (KERNEL_NUMBER)kernel->b, power = r;
    for (int i = 1; i < kernel->n; i++)
      power *= r;
    KERNEL_REAL rest = 1.0f - power;
    return KERNEL_ABOVE_0(rest, KERNEL_EXP(-(KERNEL_NUMBER)kernel->a * power / rest));
  }
  case CONIC_KERNEL_HAT:
    return 1.0f - KERNEL_SQRT(q) / cutoff;
  case CONIC_KERNEL_BOX:
    return KERNEL_OF(1.0f);
  }
  return KERNEL_OF(0.0f);
}

#undef KERNEL_VALUE
#undef KERNEL_INLINE
#undef KERNEL_NUMBER
#undef KERNEL_REAL
#undef KERNEL_OF
#undef KERNEL_SQRT
#undef KERNEL_EXP
#undef KERNEL_ABOVE_0
#undef KERNEL_GAUSS_OF
