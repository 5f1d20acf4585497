#include "simulation/petsc/multigrid.h"
