#include "estimation/fit/fit.h"
