/* The reconstruction kernels: "The kernels are" of docs/reference/picture.md. */
#include "oracle/oracle_splat.h"

oracle_kernel_facts conic_oracle_kernel_facts(const conic_kernel *kernel) {
  oracle_kernel_facts facts = {.end = (double)kernel->cutoff};
  switch (kernel->type) {
  case CONIC_KERNEL_GAUSS:
    facts.is_gaussian = 1;
    break;
  case CONIC_KERNEL_CONFETTI:
    facts.end = (double)kernel->b;
    break;
  case CONIC_KERNEL_BOX:
    facts.is_flat = 1;
    break;
  case CONIC_KERNEL_HAT:
    break;
  }
  return facts;
}

double conic_oracle_kernel(const conic_kernel *kernel, double q) {
  double r = sqrt(q), power = 1.0;
  switch (kernel->type) {
  case CONIC_KERNEL_GAUSS:
    return conic_oracle_exp(-0.5 * q);
  case CONIC_KERNEL_CONFETTI:
    if (!(r < (double)kernel->b))
      return 0.0;
    for (int i = 0; i < kernel->n; i++)
      power *= r / (double)kernel->b;
    return conic_oracle_exp(-(double)kernel->a * power / (1.0 - power));
  case CONIC_KERNEL_HAT:
    return oracle_max(1.0 - r / (double)kernel->cutoff, 0.0);
  case CONIC_KERNEL_BOX:
    return r < (double)kernel->cutoff ? 1.0 : 0.0;
  }
  return 0.0;
}
