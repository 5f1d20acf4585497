#include "core/freed_memory.h"

#include <cstdlib>  // tells which C library it is
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace hookeye {

void FreedMemoryReturned::after_one() {
  constexpr int kEvery = 32;
  if (++done_ % kEvery != 0) return;
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace hookeye
