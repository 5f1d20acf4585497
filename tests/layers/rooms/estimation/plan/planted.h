#include "estimation/search/discover.h"
