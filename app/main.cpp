// hookeye.
#include "app/interrupt.h"
#include "app/program.h"
#include "batch/child.h"
#include "estimation/evaluation/evaluation.h"

int main(int argc, char** argv) {
  hookeye::end_with_starter();
  hookeye::watch_interrupts();
  hookeye::keep_freed_memory();
  const int status = hookeye::program(argc, argv);
  if (status == hookeye::kNumericalFailure) hookeye::leave_at_once(status);
  return status;
}
