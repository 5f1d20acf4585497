#include "estimation/search/verdict.h"
