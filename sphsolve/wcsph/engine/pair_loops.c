/* The pair loops for one kernel and one instruction set: the Makefile compiles this for each file
 * of kernels/, which it includes first, and each instruction set (simd.h). */
#ifndef KERNEL_NAME
#include "sphsolve/wcsph/kernels/quintic.h"
#endif
#include "sphsolve/wcsph/engine/pairs_body.h"
