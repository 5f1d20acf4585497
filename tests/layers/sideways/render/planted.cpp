#include <vector>

#include "simulation/equilibrium.h"
