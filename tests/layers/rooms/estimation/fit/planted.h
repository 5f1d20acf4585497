#include "estimation/effects/catalogue.h"
